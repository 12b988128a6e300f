//! New widgets: where most of the volume is, and on the values of a probe.

use super::edited_function::EditedFunction;
use super::geometry::{Change, list, rounded};
use super::kinds::{gaussian, gaussian_over};
use super::plane::middle;
use crate::worker::PixelProbe;
use std::f64::consts::FRAC_1_SQRT_2;
use voltet_core::probing::{ProbeResult, kernel};
use voltet_graph::{ArrayRef, Field, ParameterValue};

/// Deviations of a new Gaussian, as shares of the axes.
const NEW: [f64; 2] = [0.02, 0.05];

/// Least deviation in any direction of one on probed values, as a share of the axes: what a hand can take hold of.
const MIN_DEVIATION: f64 = 0.01;

/// Correlations that are so small are none.
const UPRIGHT: f64 = 0.05;

/// Extinction of a new widget, per unit distance, where no other shows what is usual.
const EXTINCTION: f64 = 10.0;

/// A Gaussian at the bin with the most volume that no widget holds; `None` on axes that no kind of widget is over.
pub(super) fn at_peak(look: &EditedFunction) -> Option<ParameterValue> {
    let (mut centre, mut sigma) = ([0.5, 0.0], [0.1, 0.1]);
    if let Some(histogram) = look.histogram() {
        let [s, g] = histogram.axes;
        let mut most = -1.0;
        for (k, volume) in histogram.volumes.iter().enumerate() {
            let at = [middle(s, k % s.bins), middle(g, k / s.bins)];
            if *volume > most && look.widgets.iter().all(|widget| widget.strength(at) < 0.1) {
                (most, centre) = (*volume, at);
            }
        }
        sigma = [NEW[0] * (s.high - s.low), NEW[1] * (g.high - g.low)];
    }
    if look.is_of_s_and_g() {
        let k =
            [[1.0 / sigma[0], 0.0], [0.0, 1.0 / sigma[1]]].map(|row| row.map(|x| x * FRAC_1_SQRT_2).to_vec());
        return Some(widget(look, gaussian(centre, &k, [1.0; 2])));
    }
    Some(widget(look, gaussian_over(&look.axes, centre, sigma)?))
}

/// A Gaussian by the mean and the covariance of probed values (Kniss et al. 2003, section 6), turned to the covariance's principal
/// axes. In a direction in which the values hardly vary it is as wide as a hand can take hold of; a quantity that is the same in
/// all of the data is not looked at. `None` without values.
pub(super) fn at_probe(look: &EditedFunction, probed: &PixelProbe) -> Option<ParameterValue> {
    let (mean, covariance) = probed.moments()?;
    let known = look.known();
    let extent: Vec<f64> = ["s", "g"]
        .into_iter()
        .enumerate()
        .map(|(k, name)| {
            let range = known.and_then(|known| known.ranges.get(&ArrayRef::Named(name)));
            let is_constant = range.is_some_and(|[low, high]| low == high);
            if is_constant || !look.is_of_s_and_g() {
                range.map_or(1.0, |[a, b]| b - a)
            } else {
                look.extent[k]
            }
        })
        .collect();
    let share = |i: usize, j: usize| {
        let by = extent[i] * extent[j];
        if by > 0.0 { covariance[i][j] / by } else { 0.0 }
    };
    let found = ProbeResult {
        mean: mean.to_vec(),
        covariance: (0..2).map(|i| (0..2).map(|j| share(i, j)).collect()).collect(),
        cell_count: 0,
        volume: 0.0,
        point_count: probed.values.len() as u64,
        extent,
    };
    let spread = (covariance[0][0] * covariance[1][1]).sqrt();
    let is_correlated = spread > 0.0 && (covariance[0][1] / spread).abs() > UPRIGHT;
    let k = kernel(&found, MIN_DEVIATION, 1.0, is_correlated);
    let extent = [0, 1].map(|k: usize| if found.extent[k] > 0.0 { found.extent[k] } else { 1.0 });
    Some(widget(look, gaussian(mean, &k, extent)))
}

/// A new widget in a colour of its own.
fn widget(look: &EditedFunction, (kind, numbers): (&str, Vec<Change>)) -> ParameterValue {
    let extinction = look.widgets.iter().map(|widget| widget.extinction).fold(0.0, f64::max);
    let extinction = if extinction > 0.0 { extinction } else { EXTINCTION };
    // Hues far apart, one after the other.
    const COLORS: [[f64; 3]; 6] = [
        [1.0, 0.5, 0.1],
        [0.1, 0.45, 1.0],
        [0.2, 0.8, 0.25],
        [0.9, 0.15, 0.5],
        [0.95, 0.85, 0.2],
        [0.3, 0.8, 0.85],
    ];
    let color = COLORS[look.widgets.len() % COLORS.len()];
    let first = [
        Field::new("kind", kind),
        Field::new("color", list(&color)),
        Field::new("extinction", rounded(extinction)),
    ];
    let numbers = numbers.into_iter().filter_map(|(key, value)| Some(Field::new(key, value?)));
    ParameterValue::Table(first.into_iter().chain(numbers).collect())
}
