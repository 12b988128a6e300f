//! The integrators that sample or look up, in lanes, against their own 64-bit truths, on every lane set.

use std::collections::BTreeMap;
use voltet_core::optics::integrators::{self, Extent};
use voltet_core::optics::{Overlap, Prepared, Segment};
use voltet_core::shading::{Integrator, Shading};
use voltet_core::transfer::{OpticalModel, TransferFunction, Widget};
use voltet_engine::{Integrated, Segments, segments};
use voltet_judge::segment_cases;
use voltet_judge::segment_twin::{Measure, change_of_places, numbers};

/// Of ε (4 |truth| + change + what a shift of each sample changes). Exponentials and quotients leave some steps of 32 bits; so does
/// the table that is filled in them.
const TOLERANCE: f64 = 16.0;

fn shading(integrator: Integrator) -> Shading {
    Shading { integrator, overlap: Overlap::Exact, silhouette: None, light: None }
}

/// Places of the samples.
fn places(integrator: &Integrator) -> Vec<f64> {
    match *integrator {
        Integrator::Riemann { count } => (0..count).map(|i| (i as f64 + 0.5) / count as f64).collect(),
        Integrator::Segments { count, .. } => (0..=count).map(|i| i as f64 / count as f64).collect(),
        _ => Vec::new(),
    }
}

/// Stored values lie within twice the power of two above their span, and are rounded there.
fn spans(list: &[Segment]) -> Vec<f64> {
    let values = |a: usize| {
        list.iter().flat_map(move |segment| match a {
            0 | 1 => [segment.front[a], segment.back[a]],
            _ => [segment.fields_front[a - 2], segment.fields_back[a - 2]],
        })
    };
    let span = |a: usize| {
        let [low, high] =
            values(a).fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| [low.min(v), high.max(v)]);
        if high > low { (high - low).log2().ceil().exp2() } else { 0.0 }
    };
    (0..2 + list[0].fields_front.len()).map(span).collect()
}

/// What the judged segments of one integrator came to.
#[derive(Default)]
struct Found {
    judged: usize,
    left: BTreeMap<&'static str, usize>,
    worst: f64,
    broken: Vec<String>,
}

impl Found {
    /// Judges each segment of a scene on each lane set.
    fn judge(&mut self, name: &str, look: &TransferFunction, integrator: Integrator, list: &[Segment]) {
        let longest = list.iter().map(|segment| segment.length).fold(0.0, f64::max);
        let scalars = || list.iter().flat_map(|segment| [segment.front[0], segment.back[0]]);
        let scalar = [scalars().fold(f64::INFINITY, f64::min), scalars().fold(f64::NEG_INFINITY, f64::max)];
        let extent = Extent { scalar, longest };
        let truth = integrators::new(&integrator, Overlap::Exact, look, &extent).expect("serves");
        let prepared = Prepared::new(look).expect("valid");
        let spans = spans(list);
        let brightest = look.widgets.iter().map(Widget::brightest).sum::<f64>();
        let measures: Vec<(Measure, [f64; 5])> = list
            .iter()
            .map(|segment| {
                let measure = Measure::new(truth.as_ref(), segment, &|a, _| spans[a]);
                let exact = numbers(&measure.exact);
                let further = change_of_places(&prepared, segment, &places(&integrator), exact);
                (measure, further)
            })
            .collect();
        for Segments { lanes, .. } in Segments::each() {
            let drawn = segments(lanes, look, &shading(integrator), false, list).expect("draws");
            for ((segment, (measure, further)), Integrated { contribution, left }) in
                list.iter().zip(&measures).zip(drawn)
            {
                if let Some(why) = left {
                    *self.left.entry(why).or_default() += 1;
                }
                let scale = match look.model {
                    OpticalModel::DensityEmitter => 1.0,
                    OpticalModel::ConstantEmitter { .. } => segment.length / look.unit_distance,
                };
                let ratio = measure.ratio(&contribution, *further, TOLERANCE, brightest * scale);
                self.judged += 1;
                self.worst = self.worst.max(ratio);
                if ratio > 1.0 {
                    self.broken.push(format!(
                        "{name} by {} on {}: {ratio:.2}: {contribution:?} for {:?}, {segment:?} {left:?}",
                        integrator.name(),
                        lanes.name(),
                        measure.exact
                    ));
                }
            }
        }
    }

    fn passed(&self) {
        println!("{} judged, worst {:.3}, left {:?}", self.judged, self.worst, self.left);
        let shown = self.broken.len().min(10);
        assert!(self.broken.is_empty(), "{}\n{}", self.broken.len(), self.broken[..shown].join("\n"));
    }
}

/// Samples alone, in twos, in groups of four with one over, and so many that Gaussians follow from step to step.
const SAMPLING: [Integrator; 6] = [
    Integrator::Riemann { count: 1 },
    Integrator::Riemann { count: 2 },
    Integrator::Riemann { count: 13 },
    Integrator::Segments { count: 1, table_size: 33 },
    Integrator::Segments { count: 6, table_size: 33 },
    Integrator::Riemann { count: 64 },
];

#[test]
fn samples_are_those_of_64_bits_on_the_exact_cases() {
    let mut all: [Found; SAMPLING.len()] = Default::default();
    for (n, (id, _, case)) in segment_cases().expect("well formed").into_iter().enumerate() {
        let which = n % SAMPLING.len();
        all[which].judge(&id, &case.transfer_function, SAMPLING[which], &[case.segment()]);
    }
    for found in &all {
        found.passed();
        assert!(found.judged > 100, "only {} values were judged", found.judged);
        // What is left to 64 bits: the widest segments, and depths beyond 32 bits.
        let left: usize = found.left.values().sum();
        assert!(20 * left < found.judged, "{left} of {} were left to 64 bits", found.judged);
    }
}
