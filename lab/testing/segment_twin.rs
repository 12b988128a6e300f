//! An integrator in 32 bits against its own 64-bit truth on one segment: what the rounding of its numbers may change.
//!
//! Used by the tests of the native engine and of the shaders, so that both are held to one measure.

use voltet_optics::integrators::SegmentIntegrator;
use voltet_optics::{CompiledTransferFunction, Contribution, Segment};

/// T, C and A.
pub fn numbers(found: &Contribution) -> [f64; 5] {
    let [red, green, blue] = found.color;
    [found.optical_depth, red, green, blue, found.opacity]
}

/// By how much a value of an axis (s, g, then the fields) is changed where the truth's change is measured, by a relative change of
/// 1: what is rounded when it is stored.
pub type Amount<'a> = &'a dyn Fn(usize, f64) -> f64;

/// The truth's change for a relative change by 1 of D and of each stored value at each end, added up; the larger of
/// those for a rise and a fall, so that a sample on the edge of a region counts on its other side.
fn change(truth: &dyn Fn(&Segment) -> Contribution, segment: &Segment, amount: Amount) -> [f64; 5] {
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
    for a in 0..2 + segment.fields_front.len() {
        for end in 0..2 {
            let mut moved = [segment.fields_front.to_vec(), segment.fields_front.to_vec()];
            if end == 1 {
                moved = [segment.fields_back.to_vec(), segment.fields_back.to_vec()];
            }
            let at = |v: f64, step: f64| v + amount(a, v) * step;
            let [up, down] = [STEP, -STEP];
            if a >= 2 {
                moved[0][a - 2] = at(moved[0][a - 2], up);
                moved[1][a - 2] = at(moved[1][a - 2], down);
            }
            let change = |fields, step| {
                let mut new = *segment;
                if end == 0 {
                    new.fields_front = fields;
                } else {
                    new.fields_back = fields;
                }
                if a < 2 {
                    let plane = if end == 0 { &mut new.front } else { &mut new.back };
                    plane[a] = at(plane[a], step);
                }
                new
            };
            add([change(&moved[0], up), change(&moved[1], down)]);
        }
    }
    sum
}

/// Largest changes by a shift of each sample by itself, over the whole segment, added up: shifts of all together may
/// cancel.
pub fn change_of_places(
    prepared: &CompiledTransferFunction,
    segment: &Segment,
    places: &[f64],
    exact: [f64; 5],
) -> [f64; 5] {
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
    /// The truth.
    pub exact: Contribution,
    change: [f64; 5],
}

impl Measure {
    /// Measures `truth`; `amount`: see [`Amount`].
    pub fn new(truth: &dyn SegmentIntegrator, segment: &Segment, amount: Amount) -> Measure {
        let truth = |segment: &Segment| truth.integrate(segment);
        Measure { exact: truth(segment), change: change(&truth, segment, amount) }
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
