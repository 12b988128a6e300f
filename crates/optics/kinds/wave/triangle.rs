//! The triangle wave: max(0, 1 − 2u/w) about each peak (Song et al. 2009, section 4.3).

use super::spot::FlankPosition;
use crate::linear::psi;

/// Mean between two places of one flank: linear, so the value at the middle.
#[inline]
pub fn mean(band_width: f64, low: FlankPosition, high: FlankPosition) -> f64 {
    if band_width == 1.0 {
        return low.foot + high.foot;
    }
    let reach = 0.5 * band_width;
    ((reach - low.peak) + (reach - high.peak)) / band_width
}

/// Mean of e^(−T) along a piece within one band from a place at signed distance `from` of the peak to one at
/// `to`, where the depth per piece at profile 1 is `peak`: at most two stretches of linear extinction.
///
/// Song section 4.3 gives the rising and the falling flank apart, with exponentials that overflow; both are
/// cases of linear extinction (module `linear`).
pub fn lit(value: impl Fn(f64) -> f64, from: f64, to: f64, peak: f64) -> f64 {
    let (a, b) = (value(from), value(to));
    if from * to >= 0.0 {
        return psi(peak * a, peak * b);
    }
    let length = from.abs() + to.abs();
    let (first, second) = (from.abs() / length, to.abs() / length);
    let before = peak * first * 0.5 * (a + 1.0);
    first * psi(peak * first * a, peak * first)
        + (-before).exp() * second * psi(peak * second, peak * second * b)
}
