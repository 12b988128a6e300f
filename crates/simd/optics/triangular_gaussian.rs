//! Triangular Gaussian: mean of exp(−(δ/γ)²) over a segment, δ = s − s₀ and γ = σ g linear along it, 0 where γ ≤ 0.
//! Twin of `optics::kinds::triangular_gaussian`.
//!
//! x = δ/γ is monotone, so |x| grows from its least value (the centre, if the segment crosses it, else the nearer end)
//! outwards on at most two parts. Each part is walked from there, with t counted from there, so that what matters
//! keeps its digits; a panel of 8 points ends where x has grown by 1 or x² by 3, or γ has doubled or halved. What is
//! e^(−24) times fainter than the brightest place is left out (4e-11).
//!
//! Over several fields, exp(−|q|²/m²) is e^(−h²) exp(−((q·e)/m)²): see there.

use super::clip::LaneStretch;
use super::elementary::{dot, exp};
use super::quadrature::PANEL;
use crate::{Float, Lanes, Mask};

/// x² by which a part grows before it counts as dark.
const REACH: f32 = 24.0;

/// Panels of a part: 5 by x up to 3, 6 by x², 24 halvings of γ until 32 bits reach the end.
const MAX_PANELS: usize = 40;

/// A path over fields: exp(−|q|²/m²) = e^(−h²) exp(−(δ/γ)²).
#[derive(Clone, Copy)]
pub struct LaneTriangularPath<L: Lanes> {
    /// δ at front and back.
    pub offset: [L::F; 2],
    /// γ at front and back.
    pub width: [L::F; 2],
    /// h².
    pub offset_squared: L::F,
}

impl<L: Lanes> LaneTriangularPath<L> {
    /// From q and m at front and back.
    #[inline(always)]
    pub fn over_fields<const N: usize>(front: [L::F; N], back: [L::F; N], width: [L::F; 2]) -> Self {
        let splat = L::F::splat;
        let (zero, tiny) = (splat(0.0), splat(f32::MIN_POSITIVE));
        let rise = width[1] - width[0];
        let turn: [L::F; N] = array!(|i| (back[i] - front[i]).mul_add(width[0], -(front[i] * rise)));
        let largest_of = inlined!(|v: &[L::F; N]| {
            let mut largest = v[0].abs();
            for x in &v[1..] {
                largest = largest.max(x.abs());
            }
            largest
        });
        // A point that stays where it is moves in any direction, so in that of its own.
        let stays = largest_of(&turn).le(zero);
        let front_longer = largest_of(&back).le(largest_of(&front));
        let direction: [L::F; N] =
            array!(|i| L::F::select(stays, L::F::select(front_longer, front[i], back[i]), turn[i]));
        let inverse = splat(1.0) / largest_of(&direction).max(tiny);
        let scaled: [L::F; N] = array!(|i| direction[i] * inverse);
        let inverse = splat(1.0) / dot::<L, N>(&scaled, &scaled).max(tiny).sqrt();
        let unit: [L::F; N] = array!(|i| scaled[i] * inverse);
        let offset = [dot::<L, N>(&front, &unit), dot::<L, N>(&back, &unit)];
        // h at the end with the smaller |x|, of those with a width.
        let nearer = (offset[0] * width[1]).abs().le((offset[1] * width[0]).abs()).or(width[1].le(zero));
        let at_front = nearer.and(zero.lt(width[0]));
        let (x, m) =
            (L::F::select(at_front, offset[0], offset[1]), L::F::select(at_front, width[0], width[1]));
        let inverse = splat(1.0) / m.max(tiny);
        let mut offset_squared = zero;
        for i in 0..N {
            let across = (L::F::select(at_front, front[i], back[i]) - x * unit[i]) * inverse;
            let across = across.abs().min(splat(1e9));
            offset_squared = across.mul_add(across, offset_squared);
        }
        LaneTriangularPath { offset, width, offset_squared }
    }

    /// Mean of the profile over the path.
    #[inline(always)]
    pub fn mean(&self) -> L::F {
        mean_profile::<L>(self.offset, self.width) * exp::<L>(-self.offset_squared)
    }
}

/// Mean of the profile over the segment, from δ and γ at its front and back. Relative error 1e-6 (1 + condition).
#[inline(always)]
pub fn mean_profile<L: Lanes>(offset: [L::F; 2], width: [L::F; 2]) -> L::F {
    let splat = L::F::splat;
    let (zero, one) = (splat(0.0), splat(1.0));
    // The part with γ ≥ 0; γ < 0 on all of it leaves nothing.
    let lit = LaneStretch::<L>::whole().cut(width[0], width[1]);
    let clipped = lit.length.lt(one);
    let (mut front, mut back) = (offset[0], offset[1]);
    let (mut near, mut far) = (width[0], width[1]);
    if clipped.any() {
        front = L::F::select(clipped, lit.at_start(offset[0], offset[1]), offset[0]);
        back = L::F::select(clipped, lit.at_end(offset[0], offset[1]), offset[1]);
        near = L::F::select(clipped, lit.at_start(width[0], width[1]), width[0]).max(zero);
        far = L::F::select(clipped, lit.at_end(width[0], width[1]), width[1]).max(zero);
    }
    let crosses = front.lt(zero).and(zero.lt(back)).or(back.lt(zero).and(zero.lt(front)));
    // From the end with the smaller |x| = |δ|/γ.
    let swapped = (back.abs() * near).lt(front.abs() * far);
    let (from, to) = (L::F::select(swapped, back, front), L::F::select(swapped, front, back));
    let (from_width, to_width) = (L::F::select(swapped, far, near), L::F::select(swapped, near, far));
    if !crosses.any() {
        return outward::<L>([from, to], [from_width, to_width]) * lit.length.max(zero);
    }
    // Through the centre: two parts, each from there.
    let share = L::F::select(crosses, to.abs() / (from.abs() + to.abs()), one);
    let rest = L::F::select(crosses, from.abs() / (from.abs() + to.abs()), zero);
    let centre = L::F::select(crosses, from_width.mul_add(share, to_width * rest), from_width);
    let start = L::F::select(crosses, zero, from);
    let first = outward::<L>([start, to], [centre, to_width]);
    let second = outward::<L>([zero, from], [centre, from_width]);
    share.mul_add(first, rest * second) * lit.length.max(zero)
}

/// The mean over a part on which |x| grows from front to back and δ keeps its sign.
#[inline(always)]
fn outward<L: Lanes>(offset: [L::F; 2], width: [L::F; 2]) -> L::F {
    let splat = L::F::splat;
    let (zero, one) = (splat(0.0), splat(1.0));
    let offset = [offset[0].abs(), offset[1].abs()];
    let (rise, slope) = (offset[1] - offset[0], width[1] - width[0]);
    let tiny = splat(f32::MIN_POSITIVE);
    // Where δ and γ are both 0 at the start, x is what it is at the end.
    let at_foot = width[0].le(zero);
    let least =
        L::F::select(at_foot, offset[1], offset[0]) / L::F::select(at_foot, width[1], width[0]).max(tiny);
    let dark = least.mul_add(least, splat(REACH));
    let (mut t, mut sum, mut x) = (zero, zero, least);
    for _ in 0..MAX_PANELS {
        let open = t.lt(one).and((x * x).lt(dark));
        if !open.any() {
            break;
        }
        let here = slope.mul_add(t, width[0]);
        // Where x has grown; never reached where the denominator is not positive.
        let next = (x + one).min(x.mul_add(x, splat(3.0)).sqrt());
        let below = rise - next * slope;
        let ahead = next.mul_add(width[0], -offset[0]);
        let level = L::F::select(zero.lt(below), ahead / below.max(tiny), one);
        // Where γ has doubled or halved.
        let change = L::F::select(zero.lt(slope), here, splat(0.5) * here) / slope.abs().max(tiny);
        let change = L::F::select(zero.lt(here), t + change, one);
        // A level within rounding of t counts as reached.
        let level = L::F::select(level.le(t * splat(1.0 + 1e-6)), one, level);
        let end = level.min(change).min(one);
        let end = L::F::select(end.le(t), one, end);
        let length = L::F::select(open, end - t, zero);
        let mut mean = zero;
        for (node, weight) in PANEL {
            let at = length.mul_add(splat(node), t);
            let gamma = slope.mul_add(at, width[0]);
            let ratio = rise.mul_add(at, offset[0]) / gamma.max(tiny);
            let value = exp::<L>(-(ratio * ratio));
            mean = L::F::select(zero.lt(gamma), value, zero).mul_add(splat(weight), mean);
        }
        sum = length.mul_add(mean, sum);
        t = L::F::select(open, end, t);
        x = rise.mul_add(t, offset[0]) / slope.mul_add(t, width[0]).max(tiny);
    }
    sum
}

/// exp(−(δ/γ)²), 0 where γ ≤ 0.
#[inline(always)]
pub fn profile<L: Lanes>(offset: L::F, width: L::F) -> L::F {
    let zero = L::F::splat(0.0);
    let x = offset / width.max(L::F::splat(f32::MIN_POSITIVE));
    L::F::select(zero.lt(width), exp::<L>(-(x * x)), zero)
}
