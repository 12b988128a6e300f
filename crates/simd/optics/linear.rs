//! Linear extinction and colour over one piece. Twin of `optics::linear`.
//!
//! With a = ρ_f D, b = ρ_b D, w(x) = a x + (b − a) x²/2: ψ = ∫₀¹ e^(−w), ζ = e^(−w(1)); the density-emitter colour of
//! a piece whose colour is linear too is c_f (1 − ψ) + c_b (ψ − ζ) (Moreland & Angel 2004).

use super::elementary::{HALF_SQRT_PI, dawson, erfcx, exp, polynomial};
use super::quadrature::{PANEL, nodes};
use crate::{Float, Lanes, Mask};
use voltet_optics::quadrature::{GAUSS_4, GAUSS_5};

/// Weights (1 − ψ, ψ − ζ) of the front and back colours and the opacity 1 − ζ, for max(a, b) ≤ 1; relative error 5e-7.
///
/// 1 − ψ from 1 − e^(−w), never from ψ: where both ends are under [`SMALL`] by its series in both, else by
/// Gauss-Legendre with 5 points. ψ − ζ = (1 − ζ) − (1 − ψ), of which neither is much larger.
#[inline(always)]
pub fn piece_weights<L: Lanes>(a: L::F, b: L::F) -> (L::F, L::F, L::F) {
    let splat = L::F::splat;
    let half_slope = (b - a) * splat(0.5);
    let opacity = one_minus_exp_up_to_1::<L>((a + b) * splat(0.5));
    let mut front = small_front::<L>(a, b);
    let small = a.max(b).lt(splat(SMALL));
    if small.not().any() {
        const NODES: [(f32, f32); 5] = nodes(GAUSS_5);
        let mut sum = splat(0.0);
        for (x, weight) in NODES {
            let w = splat(x) * half_slope.mul_add(splat(x), a);
            sum = one_minus_exp_up_to_1::<L>(w).mul_add(splat(weight), sum);
        }
        front = L::F::select(small, front, sum);
    }
    (front, opacity - front, opacity)
}

/// Depths for which [`small_front`] serves.
const SMALL: f32 = 0.125;

/// 1 − ψ for max(a, b) ≤ [`SMALL`]: Σ −(−1)^k/k! ∫₀¹ (a (x − x²/2) + b x²/2)^k up to k = 5, by powers of a. What is left out is
/// under 5e-8 of it; terms of a degree have one sign, so that none cancel.
#[inline(always)]
fn small_front<L: Lanes>(a: L::F, b: L::F) -> L::F {
    let splat = L::F::splat;
    let alone = polynomial::<L, 5>(b, [1.0 / 6.0, -1.0 / 40.0, 1.0 / 336.0, -1.0 / 3456.0, 1.0 / 42240.0]);
    let by_powers = [
        polynomial::<L, 5>(b, [1.0 / 3.0, -3.0 / 40.0, 1.0 / 84.0, -5.0 / 3456.0, 1.0 / 7040.0]),
        polynomial::<L, 4>(b, [-1.0 / 15.0, 29.0 / 1680.0, -23.0 / 8064.0, 67.0 / 190_080.0]),
        polynomial::<L, 3>(b, [1.0 / 105.0, -65.0 / 24192.0, 29.0 / 63360.0]),
        polynomial::<L, 2>(b, [-1.0 / 945.0, 281.0 / 887_040.0]),
    ];
    let mut sum = splat(1.0 / 10395.0);
    for term in by_powers.iter().rev() {
        sum = sum.mul_add(a, *term);
    }
    b.mul_add(alone, a * sum)
}

/// Depth of a front or back up to which [`middling_piece_weights`] serves.
pub const MIDDLING: f32 = 4.0;

/// Weights of a piece for 1 ≤ max(a, b) ≤ [`MIDDLING`], ψ within 3e-7.
///
/// With m = (a + b)/2 and h = (b − a)/2, w(x) = m x − h x (1 − x), and x (1 − x) is even about the middle:
/// ψ = (1 − ζ)/m + e^(−m/2) Σ h^k/k! ∫ cosh(m (x − ½)) (x (1 − x))^k dx from k = 1 on, seven terms, since |h| x (1 − x) ≤ ½. Each
/// integral is the best polynomial in m² up to 16 (a linear program); in all they leave 4e-8.
#[inline(always)]
pub fn middling_piece_weights<L: Lanes>(a: L::F, b: L::F) -> (L::F, L::F, L::F) {
    let splat = L::F::splat;
    let half = splat(0.5);
    let (m, h) = ((a + b) * half, (b - a) * half);
    // The other way round, e^(−m/2) squared, errors would count twice, and ψ − ζ is a fifth of either.
    let transparency = exp::<L>(-m);
    let root = transparency.sqrt();
    let opacity = splat(1.0) - transparency;
    let square = m * m;
    let terms = [
        polynomial::<L, 5>(square, FIRST_COEFFICIENTS),
        polynomial::<L, 4>(square, SECOND),
        polynomial::<L, 4>(square, THIRD),
        polynomial::<L, 3>(square, FOURTH),
        polynomial::<L, 2>(square, FIFTH),
        polynomial::<L, 2>(square, SIXTH),
    ];
    let mut sum = splat(SEVENTH);
    for term in terms.iter().rev() {
        sum = sum.mul_add(h, *term);
    }
    let psi = (root * h).mul_add(sum, opacity / m.max(half));
    (splat(1.0) - psi, psi - transparency, opacity)
}

/// ∫ cosh(m (x − ½)) (x (1 − x))^k dx/k! in powers of m², for k = 1 to 7.
const FIRST_COEFFICIENTS: [f32; 5] =
    [0.166_666_67, 0.004_166_662, 3.720_451e-5, 1.718_231_3e-7, 5.226_815_6e-10];
const SECOND: [f32; 4] = [0.016_666_657, 0.000_297_630_07, 2.063_117e-6, 8.291_826e-9];
const THIRD: [f32; 4] = [0.001_190_475_9, 1.653_470_7e-5, 9.383_851e-8, 3.153_131_3e-10];
const FOURTH: [f32; 3] = [6.613_848e-5, 7.508_905e-7, 3.763_240_2e-9];
const FIFTH: [f32; 2] = [3.004_016_4e-6, 2.997_816_7e-8];
const SIXTH: [f32; 2] = [1.155_611_8e-7, 9.943_909e-10];
const SEVENTH: f32 = 3.970_723e-9;

/// Depth of a front or back up to which [`deep_piece_weights`] serves.
pub const DEEPEST: f32 = 1e12;

/// Weights of a piece for 1 ≤ max(a, b) ≤ [`DEEPEST`], within 1e-6.
///
/// With k² = |b − a|/2, ψ k is ½ √π (erfcx(a/2k) − ζ erfcx(b/2k)) where the extinction rises, and F(a/2k) − ζ F(b/2k), F
/// Dawson's function, where it falls (Moreland & Angel 2004, Eq. 12 to 20, without their differences of large exponentials).
/// Nothing cancels: ψ is of the size of the first term. A slope under a millionth of the depth is taken for that:
/// ψ changes by less than a millionth of ψ³.
#[inline(always)]
pub fn deep_piece_weights<L: Lanes>(a: L::F, b: L::F) -> (L::F, L::F, L::F) {
    let splat = L::F::splat;
    let half = splat(0.5);
    let transparency = exp::<L>(-(a + b) * half);
    let slope = (b - a).abs().max(a.max(b) * splat(1e-6));
    let inverse = splat(1.0) / (slope * half).sqrt();
    let (u, v) = (a * half * inverse, b * half * inverse);
    let rises = a.lt(b);
    let mut psi = splat(0.0);
    if rises.any() {
        psi = (erfcx::<L>(u) - transparency * erfcx::<L>(v)) * splat(HALF_SQRT_PI);
    }
    if rises.not().any() {
        psi = L::F::select(rises, psi, dawson::<L>(u) - transparency * dawson::<L>(v));
    }
    let psi = (psi * inverse).max(transparency).min(splat(1.0));
    (splat(1.0) - psi, psi - transparency, splat(1.0) - transparency)
}

/// (F, B) = (∫₀¹ (1 − x) e^(−w), ∫₀¹ x e^(−w)), the weights of the emission at the front and at the back, for a and b from 0 to
/// [`DEEPEST`]; within 1e-6.
///
/// Up to ½ by Gauss-Legendre with 4 points, deeper by panels of 8, as many as the deepest lane wants, over the part before a depth
/// of [`SEEN`].
#[inline(always)]
pub fn front_back<L: Lanes>(a: L::F, b: L::F) -> (L::F, L::F) {
    let splat = L::F::splat;
    let (zero, one, half) = (splat(0.0), splat(1.0), splat(0.5));
    const FEW: [(f32, f32); 4] = nodes(GAUSS_4);
    let half_slope = (b - a) * half;
    let (mut front, mut back) = (zero, zero);
    if !half.lt(a.max(b)).any() {
        for (x, weight) in FEW {
            let x = splat(x);
            let seen = splat(weight) * exp::<L>(-(x * half_slope.mul_add(x, a)));
            front = (one - x).mul_add(seen, front);
            back = x.mul_add(seen, back);
        }
        return (front, back);
    }
    // w(reach) = SEEN, in the form without cancellation.
    let root = a.mul_add(a, splat(4.0 * SEEN) * half_slope).max(zero).sqrt();
    let reach = (splat(2.0 * SEEN) / (a + root).max(splat(f32::MIN_POSITIVE))).min(one);
    let (first, bend) = (a * reach, half_slope * reach * reach);
    // Panels up to where the deepest lane has none left.
    let wish = first.max(first + bend + bend) * splat(1.0 / PANEL_DEPTH);
    let mut count = 1;
    while count < MAX_PANELS && splat(count as f32).lt(wish).any() {
        count += 1;
    }
    let step = 1.0 / count as f32;
    for panel in 0..count {
        for (x, weight) in PANEL {
            let y = splat((panel as f32 + x) * step);
            let seen = splat(weight * step) * exp::<L>(-(y * bend.mul_add(y, first)));
            let x = reach * y;
            front = (one - x).mul_add(seen, front);
            back = x.mul_add(seen, back);
        }
    }
    (front * reach, back * reach)
}

/// Depth behind which nothing is seen by [`front_back`]: e^(−25) = 1e-11.
const SEEN: f32 = 25.0;

/// Depth of a panel of it: 8 points leave 1e-8 of e^(−4).
const PANEL_DEPTH: f32 = 4.0;

/// No rate over the part that is seen exceeds twice its depth.
const MAX_PANELS: usize = 13;

/// 1 − e^(−w) for 0 ≤ w ≤ 1, within 2e-7.
///
/// The polynomial of degree 6 for (1 − e^(−w))/w of least relative error there, 2.5e-9 (Remez).
#[inline(always)]
fn one_minus_exp_up_to_1<L: Lanes>(w: L::F) -> L::F {
    w * polynomial::<L, 7>(
        w,
        [1.0, -0.499_999_77, 0.166_663_1, -0.041_645_577, 0.008_273_096, -0.001_298_663_8, 0.000_128_380_72],
    )
}
