//! Whole composed shaders against the exact values of single segments, rays, chains and tables.

use crate::device::{Bound, Device};
use crate::scene::{Scene, Scenes, axes, origin, spans};
use voltet_core::optics::judge::{
    Answer, Chain, Forms, PartialIntegrals, Precision, Report, SegmentCase, judge,
};
use voltet_core::optics::{Contribution, Overlap, Segment};
use voltet_core::shading::{Integrator, Shading};
use voltet_core::transfer::TransferFunction;
use voltet_core::{Error, Result};
use voltet_shaders::{Spans, compose_pieces, held};

/// The composed shaders of a device as a set of forms.
struct Composed(Scenes);

const CHAIN: &str = "
@group(0) @binding(0) var<storage, read> rows: array<vec4f>;
@group(0) @binding(1) var<storage, read_write> values: array<f32>;
@compute @workgroup_size(64)
fn evaluate(@builtin(global_invocation_id) id: vec3u) {
    if id.x > 0u { return; }
    var sum = composite_start();
    for (var i = 0u; i < arrayLength(&rows); i++) {
        sum = composite_add(sum, rows[i].rgb, rows[i].a);
    }
    values[0] = sum.color.r;
    values[1] = sum.color.g;
    values[2] = sum.color.b;
    values[3] = composite_opacity(sum);
    values[4] = sum.transparency;
}";

const PARTIAL: &str = "
@group(0) @binding(0) var<storage, read> rows: array<vec4f>;
@group(0) @binding(1) var<storage, read_write> values: array<f32>;
@compute @workgroup_size(64)
fn evaluate(@builtin(global_invocation_id) id: vec3u) {
    if id.x > 0u { return; }
    let x = rows[0];
    let sides = front_back(x.x, x.y);
    values[0] = psi(x.x, x.y);
    values[1] = sides.x;
    values[2] = sides.y;
    values[3] = exponential(-x.z);
}";

impl Composed {
    fn small(&self, text: &str, pieces: &[&str], rows: &[[f32; 4]], length: usize) -> Vec<f32> {
        let Composed(scenes) = self;
        let pass = scenes.pass(&compose_pieces(text, pieces), "evaluate", &[]);
        let buffer = scenes.device.storage(bytemuck::cast_slice(rows));
        scenes.device.run(&pass, vec![Bound { group: 0, binding: 0, buffer }], (0, 1), length, 1)
    }
}

impl Forms for Composed {
    fn name(&self) -> &str {
        "WGSL"
    }

    fn precision(&self) -> Precision {
        Precision::Wgsl
    }

    /// Values are stored about one origin, or else as 32-bit numbers that all widgets share. Where rounding those leaves
    /// no digit of T (values near 1e8), no linear condition number says what is left of C and A.
    fn condition(&self, case: &SegmentCase) -> [Option<f64>; 3] {
        if origin(&case.transfer_function.widgets).is_some() {
            return case.condition;
        }
        let lost = |k: f64| 16.0 * f64::from(f32::EPSILON) * (4.0 + k) > 0.1;
        if case.raw_condition[0].is_some_and(lost) { [None; 3] } else { case.raw_condition }
    }

    fn segment(
        &self,
        transfer_function: &TransferFunction,
        segment: &Segment,
        overlap: Overlap,
    ) -> Result<Answer> {
        let shading = Shading { integrator: Integrator::Analytic, overlap, silhouette: None, light: None };
        let axes = axes(transfer_function, segment);
        let scene = match Scene::new(transfer_function, &shading, &axes, segment.length, None)? {
            Ok(scene) => scene,
            Err(why) => return Ok(Answer::Skipped(why)),
        };
        if held(
            &scene.choices,
            transfer_function,
            &Spans { values: &spans(segment), longest: segment.length },
        )
        .is_err()
        {
            return Ok(Answer::Skipped("not held by 32 bits"));
        }
        Ok(Answer::Served(self.0.integrate(&scene, &[*segment])[0]))
    }

    fn chain(&self, segments: &[Contribution]) -> Chain {
        let row = |c: &Contribution| [c.color[0], c.color[1], c.color[2], c.opacity].map(|x| x as f32);
        let rows: Vec<[f32; 4]> = segments.iter().map(row).collect();
        let found = self.small(CHAIN, &["compositing"], &rows, 5);
        let [red, green, blue, opacity, transparency] = std::array::from_fn(|i| f64::from(found[i]));
        Chain { color: [red, green, blue], opacity, transparency }
    }

    fn partial(&self, a: f64, b: f64) -> PartialIntegrals {
        let rows = [[a as f32, b as f32, (0.5 * (a + b)) as f32, 0.0]];
        let found = self.small(PARTIAL, &["linear/psi", "linear/front_back"], &rows, 4);
        let [psi, front, back, zeta] = std::array::from_fn(|i| f64::from(found[i]));
        PartialIntegrals { psi, front, back, zeta }
    }
}

fn table(report: &Report) -> String {
    let mut text: String = report.rows.iter().map(|row| format!("{row}\n")).collect();
    for broken in &report.broken {
        text += &format!(
            "{} {}: {:e} for {:e}, {:.2} of the bound\n",
            broken.id, broken.quantity, broken.found, broken.exact, broken.ratio
        );
    }
    text + &format!("{:?}\n", report.excuses)
}

#[test]
fn composed_shaders_keep_every_bound_of_the_exact_values() {
    let Some(device) = Device::open() else { return };
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../core/tests/fixtures/segments.jsonl");
    let text = std::fs::read_to_string(path).expect("the case file is part of the source");
    let forms = Composed(Scenes::new(device));
    let report =
        judge(&text, &forms).map_err(|e: Error| e.to_string()).expect("the case file is well formed");
    println!("{}{} shaders", table(&report), forms.0.count());
    assert!(report.passed(), "\n{}", table(&report));
    let judged = report.total(|row| row.judged);
    assert!(judged > 5500, "only {judged} values were judged");
    // Not held are 48 cases that span over 100,000 widths of a Gaussian and 3 with over a million bands.
    let skipped: usize = report.excuses.iter().map(|excuse| excuse.count).sum();
    assert!(skipped <= 51, "{:?}", report.excuses);
}
