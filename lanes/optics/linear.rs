//! Linear extinction and colour over one piece. Twin of `optics::linear`.
//!
//! With a = ρ_f D, b = ρ_b D, w(x) = a x + (b − a) x²/2: ψ = ∫₀¹ e^(−w), ζ = e^(−w(1)); the density-emitter colour of
//! a piece whose colour is linear too is c_f (1 − ψ) + c_b (ψ − ζ) (Moreland & Angel 2004).

use super::elementary::one_minus_exp;
use super::quadrature::nodes;
use crate::{Float, Lanes};
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
