//! Comparison of segments in lanes with their own 64-bit truths, on every lane set.

use std::collections::BTreeMap;
use voltet_core::transfer::{OpticalModel, Profile, TransferFunction, Widget};
use voltet_cpu::introspect::{IntegratedSegment, integrate_segments, lane_sets};
use voltet_integrators::{LIT_REACH, REACH};
use voltet_optics::integrators::{self, Extent};
use voltet_optics::shading::{Integrator, Shading};
use voltet_optics::{CompiledTransferFunction, Segment, WidgetBlend};
use voltet_testing::segment_twin::{Measure, change_of_places, numbers};

/// Tolerance (of ε (4 |truth| + change + effect of a shift of each sample)). Exponentials and quotients leave some steps of 32 bits; so does
/// the table that is filled in them.
const TOLERANCE: f64 = 16.0;

pub fn shading(integrator: Integrator) -> Shading {
    Shading { integrator, overlap: WidgetBlend::Exact, silhouette: None, light: None }
}

/// Places of the samples.
fn places(integrator: &Integrator) -> Vec<f64> {
    let count = integrator.count("segments").unwrap_or(0);
    match integrator.name() {
        "riemann" => (0..count).map(|i| (i as f64 + 0.5) / count as f64).collect(),
        "segments" => (0..=count).map(|i| i as f64 / count as f64).collect(),
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

/// Errors of the judged segments of one integrator.
#[derive(Default)]
pub struct Found {
    pub judged: usize,
    pub left: BTreeMap<&'static str, usize>,
    worst: f64,
    broken: Vec<String>,
}

impl Found {
    /// Judges each segment of a scene on each lane set.
    pub fn judge(&mut self, name: &str, look: &TransferFunction, integrator: Integrator, list: &[Segment]) {
        let longest = list.iter().map(|segment| segment.length).fold(0.0, f64::max);
        let scalars = || list.iter().flat_map(|segment| [segment.front[0], segment.back[0]]);
        let scalar = [scalars().fold(f64::INFINITY, f64::min), scalars().fold(f64::NEG_INFINITY, f64::max)];
        let extent = Extent { scalar, longest };
        // What is subdivided to a tolerance is held to the closed forms themselves.
        let (truth, tolerance) = match integrator.tolerance() {
            Some(tolerance) => (Integrator::ANALYTIC, tolerance),
            None => (integrator, 0.0),
        };
        let truth = integrators::new(&truth, WidgetBlend::Exact, look, &extent).expect("serves");
        let prepared = CompiledTransferFunction::new(look).expect("valid");
        let spans = spans(list);
        let brightest = look.widgets.iter().map(Widget::max_emission).sum::<f64>();
        let measures: Vec<(Measure, [f64; 5])> = list
            .iter()
            .map(|segment| {
                let measure = Measure::new(truth.as_ref(), segment, &|a, _| spans[a]);
                let exact = numbers(&measure.exact);
                let mut further = change_of_places(&prepared, segment, &places(&integrator), exact);
                let light = match look.model {
                    OpticalModel::DensityEmitter => exact[4],
                    OpticalModel::ConstantEmitter { .. } => segment.length / look.unit_distance,
                };
                if integrator.has_table_of_lengths() {
                    // A place errs by an ε of the table's side, and the entries about it may differ by all that glows.
                    let side = integrator.setting("table_size").unwrap_or(0.0);
                    further[1..4].fill(side * light * brightest / TOLERANCE);
                }
                if integrator.name() == "tabulated" {
                    further = of_gaussian_tables(look, segment, light * brightest);
                }
                further[1..4]
                    .iter_mut()
                    .for_each(|x| *x += tolerance / (TOLERANCE * f64::from(f32::EPSILON)));
                (measure, further)
            })
            .collect();
        for lanes in lane_sets() {
            let drawn = integrate_segments(lanes, look, &shading(integrator), false, list).expect("draws");
            for ((segment, (measure, further)), IntegratedSegment { contribution, fallback: left }) in
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

    pub fn passed(&self) {
        println!("{} judged, worst {:.3}, left {:?}", self.judged, self.worst, self.left);
        let shown = self.broken.len().min(10);
        assert!(self.broken.is_empty(), "{}\n{}", self.broken.len(), self.broken[..shown].join("\n"));
    }
}

/// Error by the positions in the tables of Gaussians' integrals: T, C and A, by ε. Means change by no more than a position does,
/// which errs by an ε of the table's reach. Light is the difference of two entries over the widths that the segment spans.
fn of_gaussian_tables(look: &TransferFunction, segment: &Segment, light: f64) -> [f64; 5] {
    let peaks: f64 = look.widgets.iter().map(Widget::peak).sum();
    let depth = peaks * segment.length / look.unit_distance * 0.5 * REACH / TOLERANCE;
    let mut color = depth * light;
    if look.model.cutoff().is_some() {
        let spans =
            look.widgets.iter().filter_map(|widget| widths(widget, segment)).filter(|span| *span > 0.0);
        let least = spans.fold(f64::INFINITY, f64::min);
        color += 2.0 * LIT_REACH / TOLERANCE * light / least;
    }
    [depth, color, color, color, depth]
}

/// Widths of a Gaussian that a segment spans.
fn widths(widget: &Widget, segment: &Segment) -> Option<f64> {
    let span = |a: usize| segment.back[a] - segment.front[a];
    let between = |k: usize| segment.fields_back[k] - segment.fields_front[k];
    match &widget.profile {
        Profile::Gaussian { matrix, .. } => {
            let [x, y] = matrix.map(|row| row[0] * span(0) + row[1] * span(1));
            Some(x.hypot(y))
        }
        Profile::TriangularGaussian { sigma, .. } => {
            Some(span(0).abs() / (0.5 * sigma * (segment.front[1] + segment.back[1])))
        }
        // Of the test's own: over the first two fields in their order, with the third as magnitude.
        Profile::GaussianNd { matrix, .. } => {
            Some(matrix.iter().map(|row| row[0] * between(0) + row[1] * between(1)).fold(0.0, f64::hypot))
        }
        Profile::TriangularGaussianNd { matrix, .. } => {
            let width = 0.5 * (segment.fields_front[2] + segment.fields_back[2]);
            let moved = matrix.iter().map(|row| row[0] * between(0) + row[1] * between(1));
            Some(moved.fold(0.0, f64::hypot) / width)
        }
        _ => None,
    }
}
