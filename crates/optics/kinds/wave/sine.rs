//! The sine wave: max(0, 1 − (1 − cos πu)/w) about each peak (Song et al. 2009, section 4.4).

use super::spot::FlankPosition;
use crate::special::{one_minus_sinc, sinc};
use std::f64::consts::{FRAC_PI_2, PI};

/// u_e = 2 asin √(w/2)/π; the form acos(1 − w)/π loses half of the digits of a narrow band.
pub fn half_width(band_width: f64) -> f64 {
    if band_width == 1.0 { 0.5 } else { 2.0 * (0.5 * band_width).sqrt().asin() / PI }
}

/// ∫₀^u_e: u − (u − sin(πu)/π)/w.
pub fn half_area(band_width: f64, reach: f64) -> f64 {
    if band_width == 1.0 { 1.0 / PI } else { reach - reach * one_minus_sinc(PI * reach) / band_width }
}

/// Mean between two places of one flank.
///
/// Of sin πz over [z₁, z₂]: sin(π z̄) sinc(Δ/2) (docs/src/explanation/optics.md, section 9). With a band width,
/// 1 − (1 − cos(π ū) sinc(Δ/2))/w with the inner difference written as 2 sin²(π ū/2) sinc + (1 − sinc).
#[inline]
pub fn mean(band_width: f64, low: FlankPosition, high: FlankPosition) -> f64 {
    if band_width == 1.0 {
        return (FRAC_PI_2 * (low.foot + high.foot)).sin() * sinc(0.5 * (high.foot - low.foot));
    }
    let sine = (0.5 * FRAC_PI_2 * (low.peak + high.peak)).sin();
    let missing = one_minus_sinc(FRAC_PI_2 * (low.peak - high.peak));
    1.0 - (2.0 * sine * sine * (1.0 - missing) + missing) / band_width
}
