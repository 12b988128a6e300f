//! The other integrators, composed, against their own 64-bit truths.

use crate::device::Device;
use crate::scene::{Composed, Scenes};
use voltet_core::optics::integrators::{Extent, SegmentIntegrator, new};
use voltet_core::optics::{Contribution, Overlap, Prepared, Segment};
use voltet_core::shading::{Integrator, Shading};
use voltet_judge::{Kind, SegmentCase, parse};
use voltet_shaders::Axis;
use voltet_shaders::segment_list::{axes, holds, keeps_digits};

pub fn shading(integrator: Integrator) -> Shading {
    Shading { integrator, overlap: Overlap::Exact, silhouette: None, light: None }
}

/// T, C and A.
pub fn numbers(found: &Contribution) -> [f64; 5] {
    let [red, green, blue] = found.color;
    [found.optical_depth, red, green, blue, found.opacity]
}

/// The truth's change for a relative change by 1 of D and of each stored value at each end, added up; the larger of
/// those for a rise and a fall, so that a sample on the edge of a region counts on its other side.
fn change(truth: &dyn Fn(&Segment) -> Contribution, segment: &Segment, axes: &[Axis]) -> [f64; 5] {
    const STEP: f64 = 1e-6;
    let value = numbers(&truth(segment));
    let mut sum = [0.0; 5];
    let mut add = |moved: [Segment; 2]| {
        let found = moved.map(|segment| numbers(&truth(&segment)));
        for (i, sum) in sum.iter_mut().enumerate() {
            *sum += (found[0][i] - value[i]).abs().max((found[1][i] - value[i]).abs()) / STEP;
        }
    };
    add([1.0 + STEP, 1.0 - STEP].map(|factor| Segment { length: segment.length * factor, ..*segment }));
    for (a, axis) in axes.iter().enumerate() {
        for end in 0..2 {
            let mut moved = [segment.fields_front.to_vec(), segment.fields_front.to_vec()];
            if end == 1 {
                moved = [segment.fields_back.to_vec(), segment.fields_back.to_vec()];
            }
            let at = |v: f64, factor: f64| axis.offset + (v - axis.offset) * factor;
            let [up, down] = [1.0 + STEP, 1.0 - STEP];
            if a >= 2 {
                moved[0][a - 2] = at(moved[0][a - 2], up);
                moved[1][a - 2] = at(moved[1][a - 2], down);
            }
            let change = |fields, factor| {
                let mut new = *segment;
                if end == 0 {
                    new.fields_front = fields;
                } else {
                    new.fields_back = fields;
                }
                if a < 2 {
                    let plane = if end == 0 { &mut new.front } else { &mut new.back };
                    plane[a] = at(plane[a], factor);
                }
                new
            };
            add([change(&moved[0], up), change(&moved[1], down)]);
        }
    }
    sum
}

/// What a shift of each sample by itself, by the whole segment, changes at most, added up: shifts of all together may
/// cancel.
pub fn change_of_places(prepared: &Prepared, segment: &Segment, places: &[f64], exact: [f64; 5]) -> [f64; 5] {
    const STEP: f64 = 1e-6;
    if places.is_empty() {
        return [0.0; 5];
    }
    let mut sum = [0.0; 4];
    prepared.sampled(segment, |samples| {
        for &t in places {
            let parts = |t: f64| {
                let sample = samples.at(t);
                [sample.rate, sample.glow[0], sample.glow[1], sample.glow[2]]
            };
            let [here, up, down] = [t, (t + STEP).min(1.0), (t - STEP).max(0.0)].map(parts);
            for (i, sum) in sum.iter_mut().enumerate() {
                let change = (up[i] - here[i]).abs().max((down[i] - here[i]).abs());
                *sum += change / (STEP * places.len() as f64);
            }
        }
    });
    let [depth, ref glow @ ..] = sum;
    let color = |i: usize| glow[i] + exact[1 + i] * depth;
    [depth, color(0), color(1), color(2), (1.0 - exact[4]) * depth]
}

/// A truth on one segment, and how it changes.
pub struct Measure {
    pub exact: Contribution,
    change: [f64; 5],
}

impl Measure {
    pub fn new(truth: &dyn SegmentIntegrator, segment: &Segment, axes: &[Axis]) -> Measure {
        let truth = |segment: &Segment| truth.integrate(segment);
        Measure { exact: truth(segment), change: change(&truth, segment, axes) }
    }

    /// |found − truth| as a share of what is allowed: `tolerance` ε (4 |truth| + change + `further`), and what the floors
    /// of 32 bits hide.
    pub fn ratio(&self, found: &Contribution, further: [f64; 5], tolerance: f64, brightest: f64) -> f64 {
        let (exact, found) = (numbers(&self.exact), numbers(found));
        let ratio = |i: usize| {
            // What lies behind a depth of 25 is not looked for.
            let hidden = if (1..4).contains(&i) { 1e-11 * brightest } else { 0.0 };
            let parts = 4.0 * exact[i].abs() + self.change[i] + further[i];
            let allowed = tolerance * f64::from(f32::EPSILON) * parts + hidden + 1e-30;
            let ratio = (found[i] - exact[i]).abs() / allowed;
            if ratio.is_nan() { f64::INFINITY } else { ratio }
        };
        (0..5).map(ratio).fold(0.0, f64::max)
    }
}

/// The segments of the case file.
pub fn cases() -> Vec<(String, String, SegmentCase)> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../judge/fixtures/segments.jsonl");
    let text = std::fs::read_to_string(path).expect("the case file is part of the source");
    let cases = text.lines().map(|line| parse(line).expect("well formed"));
    cases
        .filter_map(|case| match case.kind {
            Kind::Segment(segment) => Some((case.id, case.category, *segment)),
            _ => None,
        })
        .collect()
}

#[test]
fn sampling_integrators_are_twins_of_their_truths() {
    let Some(device) = Device::open() else { return };
    let scenes = Scenes::new(device);
    // 13 samples: groups of four, and one over.
    let all = [Integrator::Riemann { count: 13 }, Integrator::Segments { count: 6, table_size: 33 }];
    let places = [
        (0..13).map(|i| (f64::from(i) + 0.5) / 13.0).collect::<Vec<f64>>(),
        (0..7).map(|i| f64::from(i) / 6.0).collect(),
    ];
    let mut broken = Vec::new();
    let mut worst = [(0.0, String::new()), (0.0, String::new())];
    let (mut judged, mut categories) = (0, std::collections::BTreeMap::<String, usize>::new());
    for (n, (id, category, case)) in cases().into_iter().enumerate() {
        let which = n % all.len();
        let integrator = all[which];
        let (transfer_function, segment) = (&case.transfer_function, case.segment());
        let extent = Extent { scalar: [0.0, 1.0], longest: segment.length };
        let truth = new(&integrator, Overlap::Exact, transfer_function, &extent).expect("serves");
        let axes = axes(transfer_function, &segment);
        let scene = Composed::new(transfer_function, &shading(integrator), &axes, segment.length, None);
        let Ok(scene) = scene.expect("has pieces") else { continue };
        if holds(&scene.choices, transfer_function, &segment).is_err() {
            continue;
        }
        let found = scenes.integrate(&scene, &[segment])[0];
        let scale = if case.density() { 1.0 } else { segment.length / transfer_function.unit_distance };
        let brightest = case.brightest() * scale;
        if !keeps_digits(&case.transfer_function, &case.conditions()) {
            // Values near 1e8, raw: no digit of the samples is left.
            assert!((0.0..=1.0).contains(&found.opacity), "{id}: {found:?}");
            continue;
        }
        let prepared = Prepared::new(transfer_function).expect("valid");
        let measure = Measure::new(truth.as_ref(), &segment, &axes);
        let further = change_of_places(&prepared, &segment, &places[which], numbers(&measure.exact));
        let ratio = measure.ratio(&found, further, TOLERANCE, brightest);
        if ratio > worst[which].0 {
            worst[which] = (ratio, id.clone());
        }
        if ratio > 1.0 {
            broken.push(format!("{} {id}: {ratio:.2}: {found:?} for {:?}", integrator.name(), measure.exact));
        }
        judged += 1;
        *categories.entry(category).or_default() += 1;
    }
    println!("{judged} cases, {} shaders, worst {worst:?}, {categories:?}", scenes.count());
    assert!(broken.is_empty(), "\n{}", broken.join("\n"));
    assert!(judged > 900 && categories.len() > 7, "{judged} cases: {categories:?}");
}

const TOLERANCE: f64 = 16.0;
