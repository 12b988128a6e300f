//! Whole composed shaders against the exact values of single segments, rays, chains and tables.

use crate::device::{Device, Input, Pass};
use std::cell::RefCell;
use std::collections::HashMap;
use std::rc::Rc;
use voltet_core::optics::judge::{
    Answer, Chain, Forms, PartialIntegrals, Precision, Report, SegmentCase, judge,
};
use voltet_core::optics::{Contribution, Overlap, Segment};
use voltet_core::shading::{Integrator, Shading};
use voltet_core::transfer::{Profile, TransferFunction, Widget};
use voltet_core::{Error, Result};
use voltet_shaders::{
    Axis, Choices, Combine, Compositor, Parameters, Shader, Spans, compose, compose_pieces, held,
};

/// The composed shaders of a device as a set of forms.
struct Composed {
    device: Device,
    passes: RefCell<HashMap<String, Rc<Pass>>>,
}

/// Numbers of a contribution on the device: r, g, b, A, T, and what its alignment adds.
const CONTRIBUTION: usize = 8;

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
    fn pass(&self, shader: &Shader, entry_point: &str, constants: &[(&str, f64)]) -> Rc<Pass> {
        let mut passes = self.passes.borrow_mut();
        let made = || Rc::new(self.device.compile(shader, entry_point, constants));
        passes.entry(shader.text.clone()).or_insert_with(made).clone()
    }

    fn small(&self, text: &str, pieces: &[&str], rows: &[[f32; 4]], length: usize) -> Vec<f32> {
        let pass = self.pass(&compose_pieces(text, pieces), "evaluate", &[]);
        let input = Input { group: 0, binding: 0, uniform: false, bytes: bytemuck::cast_slice(rows) };
        self.device.run(&pass, &[input], (0, 1), length, 1)
    }
}

/// The one place that all differences of a scene are taken from, if there is one: [s, g], then the fields.
fn origin(widgets: &[Widget]) -> Option<Vec<f64>> {
    let [widget] = widgets else { return None };
    if widget.region.is_some() {
        return None;
    }
    match &widget.profile {
        Profile::Gaussian { centre, .. } => Some(centre.to_vec()),
        Profile::GaussianNd { centre, .. } => Some([&[0.0, 0.0], centre.as_slice()].concat()),
        Profile::TriangularGaussian { centre, .. } => Some(vec![*centre, 0.0]),
        Profile::TriangleWave(wave) | Profile::SineWave(wave) => Some(wave.origin.to_vec()),
        _ => None,
    }
}

/// Values stored about `origin`, at most 1 and with all their digits: the scale is a power of two.
fn axis(front: f64, back: f64, origin: f64) -> Axis {
    let size = (front - origin).abs().max((back - origin).abs());
    let scale = if size > 0.0 { size.log2().ceil().exp2() } else { 1.0 };
    Axis { offset: origin, scale }
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
        let choices = Choices::new(transfer_function, &shading, Compositor::Segments)?;
        let front = [&segment.front, segment.fields_front].concat();
        let back = [&segment.back, segment.fields_back].concat();
        let values: Vec<f64> = front.iter().zip(&back).map(|(a, b)| (b - a).abs()).collect();
        let spans = Spans { values: &values, longest: segment.length };
        if held(&choices, transfer_function, &spans).is_err() {
            return Ok(Answer::Skipped("not held by 32 bits"));
        }
        let origin = origin(&transfer_function.widgets).unwrap_or_default();
        let axes: Vec<Axis> = (0..2 + transfer_function.fields().len())
            .map(|a| axis(front[a], back[a], origin.get(a).copied().unwrap_or(0.0)))
            .collect();
        let parameters = match Parameters::new(transfer_function, &shading, &axes, segment.length) {
            Ok(parameters) => parameters,
            Err(_) => return Ok(Answer::Skipped("numbers leave the range of 32 bits")),
        };
        let mut row = vec![1f32];
        for values in [&front, &back] {
            for (a, axis) in axes.iter().enumerate() {
                if a != 1 || choices.reads_gradient_magnitude {
                    row.push(((values[a] - axis.offset) / axis.scale) as f32);
                }
            }
        }
        // No product of depths is too small for the order of widgets: channels are judged by themselves.
        let constants: &[(&str, f64)] =
            if choices.combine == Combine::Ordered { &[("order_threshold", 0.0)] } else { &[] };
        let pass = self.pass(&compose(&choices), "integrate_segments", constants);
        let scene = parameters.scene_bytes();
        let mut inputs = vec![
            Input { group: 0, binding: 0, uniform: true, bytes: &scene },
            Input { group: 1, binding: 0, uniform: false, bytes: bytemuck::cast_slice(&row) },
        ];
        if choices.reads_numbers() {
            let bytes = bytemuck::cast_slice(&parameters.numbers);
            inputs.push(Input { group: 0, binding: 1, uniform: false, bytes });
        }
        let found = self.device.run(&pass, &inputs, (1, 1), CONTRIBUTION, 1);
        let [red, green, blue, opacity, optical_depth] = std::array::from_fn(|i| f64::from(found[i]));
        Ok(Answer::Served(Contribution { optical_depth, color: [red, green, blue], opacity }))
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
    let forms = Composed { device, passes: RefCell::default() };
    let report =
        judge(&text, &forms).map_err(|e: Error| e.to_string()).expect("the case file is well formed");
    println!("{}{} shaders", table(&report), forms.passes.borrow().len());
    assert!(report.passed(), "\n{}", table(&report));
    let judged = report.total(|row| row.judged);
    assert!(judged > 5500, "only {judged} values were judged");
    // Not held are 48 cases that span over 100,000 widths of a Gaussian and 3 with over a million bands.
    let skipped: usize = report.excuses.iter().map(|excuse| excuse.count).sum();
    assert!(skipped <= 51, "{:?}", report.excuses);
}
