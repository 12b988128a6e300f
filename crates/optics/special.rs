//! Special functions of one variable, stable over their whole range.
//!
//! Symbols: x, a, b dimensionless; T an optical depth. Every function is within a few units of rounding of
//! its exact value relative to the condition of its arguments; the tests compare with values of 40 digits.

use super::quadrature::{self, GAUSS_4, GAUSS_8};
use std::f64::consts::PI;

/// √π/2.
pub const HALF_SQRT_PI: f64 = 0.886_226_925_452_758;
/// 1/√π.
const INV_SQRT_PI: f64 = 0.564_189_583_547_756_3;

/// Optical depth behind which nothing is visible (e^(−42) = 6e-19).
pub const OPAQUE_DEPTH: f64 = 42.0;

/// A = 1 − e^(−T) without cancellation.
#[inline]
pub fn opacity(optical_depth: f64) -> f64 {
    -(-optical_depth).exp_m1()
}

/// E₁(x) = (1 − e^(−x))/x, the mean transmittance of a homogeneous stretch of optical depth x ≥ 0.
/// Song et al. 2009, Eq. 5 divided by its colour and length, without its 0/0.
#[inline]
pub fn mean_transmittance(x: f64) -> f64 {
    if x > 1e-8 { -(-x).exp_m1() / x } else { 1.0 - 0.5 * x }
}

/// erfcx(x) = e^(x²) erfc(x) for x ≥ 0 (Abramowitz & Stegun 7.1.23 beyond 10, where 14 terms reach 1e-17).
pub fn erfcx(x: f64) -> f64 {
    if x < 10.0 {
        // e^(x²) with x² split so that its rounding does not enter: x = h + r, x² = h² + r (x + h).
        let high = f64::from_bits(x.to_bits() & 0xffff_ffff_0000_0000);
        (high * high).exp() * ((x - high) * (x + high)).exp() * libm::erfc(x)
    } else {
        let y = 0.5 / (x * x);
        let mut sum = 1.0;
        for k in (1..=14).rev() {
            sum = 1.0 - f64::from(2 * k - 1) * y * sum;
        }
        INV_SQRT_PI / x * sum
    }
}

/// Dawson's function F(x) = e^(−x²) ∫₀ˣ e^(t²) dt.
///
/// Rybicki's sampling theorem (Computers in Physics 3, 85, 1989) with step ¼, whose own error is
/// e^(−(π/2h)²) = 7e-18; the power series below 0.3 and the asymptotic series (DLMF 7.12.1) beyond 10.
pub fn dawson(x: f64) -> f64 {
    const STEP: f64 = 0.25;
    let z = x.abs();
    let value = if z < 0.3 {
        // F = x Σ (−2x²)ᵏ/(2k + 1)!!; the 12th term is under 1e-17 of the first at 0.3.
        let y = -2.0 * z * z;
        let mut sum = 1.0;
        for k in (1..=12).rev() {
            sum = 1.0 + y / f64::from(2 * k + 1) * sum;
        }
        z * sum
    } else if z > 10.0 {
        let y = 0.5 / (z * z);
        let mut sum = 1.0;
        for k in (1..=14).rev() {
            sum = 1.0 + f64::from(2 * k - 1) * y * sum;
        }
        0.5 / z * sum
    } else {
        // Σ over odd n of e^(−(x − n h)²)/n, centred on the even n₀ nearest to x/h.
        let centre = 2.0 * (0.5 * z / STEP).round();
        let offset = z - centre * STEP;
        let up = (2.0 * offset * STEP).exp();
        let (up2, mut rise) = (up * up, up);
        let mut fall = 1.0 / up;
        let mut sum = 0.0;
        for i in 0..14 {
            let n = f64::from(2 * i + 1);
            let weight = ODD_GAUSSIAN[i as usize];
            sum += weight * (rise / (centre + n) + fall / (centre - n));
            rise *= up2;
            fall /= up2;
        }
        INV_SQRT_PI * (-offset * offset).exp() * sum
    };
    value.copysign(x)
}

/// e^(−((2i + 1)/4)²).
#[rustfmt::skip]
const ODD_GAUSSIAN: [f64; 14] = [
    0.9394130628134758,
    0.569782824730923,
    0.2096113871510978,
    0.04677062238395898,
    0.006329715427485747,
    0.0005195746821548384,
    2.586810022265412e-05,
    7.811489408304491e-07,
    1.4307241918567688e-08,
    1.5893910094516368e-10,
    1.0709232382508077e-12,
    4.37661850287085e-15,
    1.0848552640429378e-17,
    1.6310139226701858e-20,
];

/// Mean of e^(−x²) over [a, b], where a ≤ b and `d` = b − a is given apart, since it may be known better
/// than the difference of the ends.
///
/// Kniss et al. 2003, Eq. 11 and 16, in three branches that do not cancel: quadrature of the bounded
/// remainder where the interval is short (4 points leave 1e-17 at d = 0.04, 8 points 8e-15 at 1), a sum of
/// two erf where the peak is inside, a difference of two erfc that loses under one bit where it is not.
///
/// Returned as (m, y) for m e^(−y), so that a caller can multiply by what is large before the exponential
/// leaves the range of numbers.
#[inline]
pub fn gaussian_mean(a: f64, b: f64, d: f64) -> (f64, f64) {
    let (a, b) = if a + b < 0.0 { (-b, -a) } else { (a, b) };
    let sum = a + b;
    let spread = d * (sum + d);
    if spread <= 1.0 {
        let remainder = |u: f64| {
            let y = d * (u - 0.5);
            (-y * (sum + y)).exp()
        };
        let share = if spread < 0.125 && d < 0.04 {
            quadrature::mean(&GAUSS_4, remainder)
        } else {
            quadrature::mean(&GAUSS_8, remainder)
        };
        (share, 0.25 * sum * sum)
    } else if a < 0.0 {
        (HALF_SQRT_PI * (libm::erf(b) + libm::erf(-a)) / d, 0.0)
    } else if a < 20.0 {
        (HALF_SQRT_PI * (libm::erfc(a) - libm::erfc(b)) / d, 0.0)
    } else {
        // erfc leaves the normal range at 26.5.
        let tail = if d * sum < 745.0 { (-d * sum).exp() * erfcx(b) } else { 0.0 };
        (HALF_SQRT_PI * (erfcx(a) - tail) / d, a * a)
    }
}

/// sin(πx)/(πx).
#[inline]
pub fn sinc(x: f64) -> f64 {
    let y = PI * x;
    if y.abs() < 1e-4 { 1.0 - y * y / 6.0 } else { y.sin() / y }
}

/// 1 − sin(y)/y without cancellation; y in radians.
#[inline]
pub fn one_minus_sinc(y: f64) -> f64 {
    let y2 = y * y;
    if y2 < 1.0 {
        // Alternating series; the term left out is under 1e-17 of the first at 1.
        let mut sum = 1.0;
        for k in [272.0, 210.0, 156.0, 110.0, 72.0, 42.0, 20.0] {
            sum = 1.0 - y2 / k * sum;
        }
        y2 / 6.0 * sum
    } else {
        1.0 - y.sin() / y
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Beyond the range in which e^(−a²) is a number what is left is e^(−a²) × √π/2 erfcx(a)/d: erfcx(30) has 18 digits from a
    /// table, and what the far end takes away is e^(−61) of it.
    #[test]
    fn a_mean_far_from_the_peak_keeps_its_digits() {
        let exact = HALF_SQRT_PI * 0.018_795_888_861_416_75;
        for (a, b) in [(30.0, 31.0), (-31.0, -30.0)] {
            let (mean, exponent) = gaussian_mean(a, b, 1.0);
            assert_eq!(exponent, 900.0);
            assert!((mean / exact - 1.0).abs() < 4.0 * f64::EPSILON, "{mean} for {exact}");
        }
    }
}
