//! A segment with linear extinction: the partial pre-integration of Moreland & Angel 2004, in closed form.
//!
//! Symbols: a = α_f D, b = α_b D the rates of optical depth at front and back; w(x) = a x + (b − a) x²/2 the
//! depth after the share x; ζ = e^(−w(1)); ψ = ∫₀¹ e^(−w); F = ∫ (1 − x) e^(−w); B = ∫ x e^(−w).
//! Sources: Moreland & Angel 2004, Eq. 12 to 20; Song et al. 2009, Eq. 3. The branches avoid the difference
//! of large exponentials (erfcx, Dawson's function) and the 0/0 at a = b.

use super::quadrature::{GAUSS_8, GAUSS_12, mean};
use super::special::{HALF_SQRT_PI, OPAQUE_DEPTH, dawson, erfcx, mean_transmittance};

/// ζ = e^(−(a + b)/2), the transmittance of the stretch.
#[inline]
pub fn zeta(a: f64, b: f64) -> f64 {
    (-0.5 * (a + b)).exp()
}

/// ψ = ∫₀¹ e^(−w(x)) dx, the mean transmittance of the stretch.
pub fn psi(a: f64, b: f64) -> f64 {
    if a.max(b) <= 1.0 {
        // |w| ≤ 1 and smooth: 8 points are within one rounding.
        return mean(&GAUSS_8, |x| (-x * (a + 0.5 * (b - a) * x)).exp());
    }
    if a == b {
        return mean_transmittance(a);
    }
    let k = (0.5 * (b - a).abs()).sqrt();
    let (u, v) = (0.5 * a / k, 0.5 * b / k);
    if b > a {
        HALF_SQRT_PI * (erfcx(u) - zeta(a, b) * erfcx(v)) / k
    } else {
        (dawson(u) - zeta(a, b) * dawson(v)) / k
    }
}

/// (F, B), by panels of optical depth about 2 (12 points leave 1e-17 of e^(−2x²) there): at most 22 of them,
/// stopped where nothing more is seen.
pub fn front_back(a: f64, b: f64) -> (f64, f64) {
    let mut sums = (0.0, 0.0);
    panels(a, b, |x, weight| {
        sums.0 += weight * (1.0 - x);
        sums.1 += weight * x;
    });
    sums
}

/// (1 − ψ, ψ − ζ): the weights of the front and the back colour of a density-emitter whose colour is linear,
/// C = c_f (1 − ψ) + c_b (ψ − ζ), since ∫ c ρ e^(−T) = c_f + (c_b − c_f) ψ − c_b ζ by parts.
pub fn emission_weights(a: f64, b: f64) -> (f64, f64) {
    if a.max(b) <= 3.0 {
        // Both differences cancel for thin stretches; their integrands, ρ e^(−w) times the colour's share,
        // do not. 12 points leave under 1e-17 at depth 3.
        let (mut front, mut back) = (0.0, 0.0);
        for &(x, weight) in &GAUSS_12 {
            let rate = a * (1.0 - x) + b * x;
            let glow = weight * rate * (-x * (a + 0.5 * (b - a) * x)).exp();
            front += glow * (1.0 - x);
            back += glow * x;
        }
        (front, back)
    } else {
        let psi = psi(a, b);
        (1.0 - psi, psi - zeta(a, b))
    }
}

/// Calls `f(x, weight × e^(−w(x)))` at 12 points of each panel of [0, 1].
fn panels(a: f64, b: f64, mut f: impl FnMut(f64, f64)) {
    let slope = b - a;
    let (mut start, mut depth) = (0.0_f64, 0.0_f64);
    // The rate at a panel's start is taken from both ends, so that it stays exact near the back.
    while start < 1.0 && depth < OPAQUE_DEPTH {
        let rate = a * (1.0 - start) + b * start;
        // h solves rate h + slope h²/2 = 2, in the form without cancellation; no root: the depth stays below.
        let root = (rate * rate + 4.0 * slope).max(0.0).sqrt();
        let length = (4.0 / (rate + root)).min(1.0 - start);
        for &(y, weight) in &GAUSS_12 {
            let step = length * y;
            let w = depth + step * (rate + 0.5 * slope * step);
            f(start + step, length * weight * (-w).exp());
        }
        depth += length * (rate + 0.5 * slope * length);
        start += length;
        if length <= 0.0 {
            break;
        }
    }
}
