//! Linear extinction and colour over one piece. Twin of `optics::linear`.
//!
//! With a = ρ_f D, b = ρ_b D, w(x) = a x + (b − a) x²/2: ψ = ∫₀¹ e^(−w), ζ = e^(−w(1)); the density-emitter colour of
//! a piece whose colour is linear too is c_f (1 − ψ) + c_b (ψ − ζ) (Moreland & Angel 2004).

use super::elementary::{exp, one_minus_exp};
use super::quadrature::{PANEL, nodes};
use crate::{Float, Lanes, Mask};
use voltet_core::optics::quadrature::GAUSS_5;

/// Weights (1 − ψ, ψ − ζ) of the front and back colours and the opacity 1 − ζ, for max(a, b) ≤ 1.
///
/// Both weights by Gauss-Legendre with 5 points, from 1 − e^(−w) (never 1 − ψ): relative error 5e-7. ψ − ζ =
/// ∫ (e^(−w) − ζ) = ζ ∫ (e^(w(1) − w) − 1), of one sign.
#[inline(always)]
pub fn piece_weights<L: Lanes>(a: L::F, b: L::F) -> (L::F, L::F, L::F) {
    let splat = L::F::splat;
    const NODES: [(f32, f32); 5] = nodes(GAUSS_5);
    let half_slope = (b - a) * splat(0.5);
    let opacity = one_minus_exp::<L>((a + b) * splat(0.5));
    let mut front = splat(0.0);
    for (x, weight) in NODES {
        let w = splat(x) * half_slope.mul_add(splat(x), a);
        front = one_minus_exp_small::<L>(w).mul_add(splat(weight), front);
    }
    // ψ − ζ = (1 − ζ) − (1 − ψ).
    (front, opacity - front, opacity)
}

/// 1 − e^(−w) for 0 ≤ w ≤ 1, within 2e-7.
#[inline(always)]
fn one_minus_exp_small<L: Lanes>(w: L::F) -> L::F {
    w * super::elementary::polynomial::<L, 10>(
        -w,
        [
            1.0,
            1.0 / 2.0,
            1.0 / 6.0,
            1.0 / 24.0,
            1.0 / 120.0,
            1.0 / 720.0,
            1.0 / 5040.0,
            1.0 / 40320.0,
            1.0 / 362_880.0,
            1.0 / 3_628_800.0,
        ],
    )
}

/// e^(−w), re-exported for the panels of longer pieces.
#[inline(always)]
pub fn transparency<L: Lanes>(w: L::F) -> L::F {
    exp::<L>(-w)
}

/// Calls `f(x, ρ, weight × e^(−w(x)))` on panels of optical depth about 2 until every lane is through or opaque
/// (depth 24); a and b are held under 1e15, where the first panel is all that is seen.
#[inline(always)]
fn panels<L: Lanes>(a: L::F, b: L::F, mut f: impl FnMut(L::F, L::F, L::F)) {
    let splat = L::F::splat;
    let (zero, one) = (splat(0.0), splat(1.0));
    let (a, b) = (a.min(splat(1e15)), b.min(splat(1e15)));
    let slope = b - a;
    let (mut start, mut depth) = (zero, zero);
    // At most 21 panels at constant or rising rate; a falling rate has fewer.
    for _ in 0..48 {
        let rest = one - start;
        let rate = a.mul_add(rest, b * start);
        let root = rate.mul_add(rate, splat(4.0) * slope).max(zero).sqrt();
        let open = start.lt(one).and(depth.lt(splat(24.0)));
        if !open.any() {
            return;
        }
        let length = (splat(4.0) / (rate + root).max(splat(1e-30))).min(rest);
        let length = L::F::select(open, length, zero);
        let half_slope = slope * splat(0.5);
        for (y, weight) in PANEL {
            let step = length * splat(y);
            let w = step.mul_add(half_slope.mul_add(step, rate), depth);
            f(start + step, slope.mul_add(step, rate), length * splat(weight) * exp::<L>(-w));
        }
        depth = length.mul_add(half_slope.mul_add(length, rate), depth);
        start = L::F::select(rest.le(length), one, start + length);
    }
}

/// ψ = ∫ e^(−w), for any a, b ≥ 0. Relative error 1e-6.
#[inline(always)]
pub fn psi<L: Lanes>(a: L::F, b: L::F) -> L::F {
    let mut sum = L::F::splat(0.0);
    panels::<L>(a, b, |_, _, seen| sum = sum + seen);
    sum
}

/// (F, B) = (∫ (1 − x) e^(−w), ∫ x e^(−w)). Relative error 1e-6.
#[inline(always)]
pub fn front_back<L: Lanes>(a: L::F, b: L::F) -> (L::F, L::F) {
    let (mut front, mut back) = (L::F::splat(0.0), L::F::splat(0.0));
    panels::<L>(a, b, |x, _, seen| {
        front = seen.mul_add(L::F::splat(1.0) - x, front);
        back = seen.mul_add(x, back);
    });
    (front, back)
}

/// (1 − ψ, ψ − ζ) for any a, b ≥ 0, as integrals of ρ e^(−w) without cancellation. Relative error 1e-6.
#[inline(always)]
pub fn emission_weights<L: Lanes>(a: L::F, b: L::F) -> (L::F, L::F) {
    let (mut front, mut back) = (L::F::splat(0.0), L::F::splat(0.0));
    panels::<L>(a, b, |x, rate, seen| {
        let glow = rate * seen;
        front = glow.mul_add(L::F::splat(1.0) - x, front);
        back = glow.mul_add(x, back);
    });
    (front, back)
}
