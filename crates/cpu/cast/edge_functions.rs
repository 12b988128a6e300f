//! Edge functions, the side of an edge on which a ray passes, and the point at which it passes a face.

use super::points::{Points, SPREAD_BITS};
use crate::tolerances::MIN_CORNER_WEIGHT;
use voltet_simd::{Float, Lanes, Mask, Unsigned, array, inlined};

/// Screen positions relative to the rays (pixels to the right and down).
pub(super) type Offset<L> = [<L as Lanes>::F; 2];

/// Steps that a ray has moved at a depth, by `spread` in 2^[`SPREAD_BITS`] steps of depth.
#[inline(always)]
pub(super) fn moved_by_depth<L: Lanes>(depth: L::U, spread: L::U) -> L::U {
    let low = L::U::splat((1 << SPREAD_BITS) - 1);
    depth.shr::<SPREAD_BITS>() * spread + (depth.and(low) * spread).shr::<SPREAD_BITS>()
}

/// Edge function: twice the area of the triangle of two positions and the ray, positive where they turn clockwise about it on the
/// screen. Exchanged positions give the same number with the opposite sign, and 0 gives 0. Where the edge passes close by the ray, all digits of the
/// difference count.
#[inline(always)]
pub(super) fn edge_function<L: Lanes>(a: Offset<L>, b: Offset<L>) -> L::F {
    a[0].difference_of_products(b[1], a[1], b[0])
}

/// Inside test of three edges with a tie rule: true for each edge that is clockwise about rays that are moved right by next to nothing and
/// down by next to nothing of that, so that none meets an edge. `wanted`: the rays that count.
#[inline(always)]
pub(super) fn edges_inside<L: Lanes>(
    functions: [L::F; 3],
    edges: [[Offset<L>; 2]; 3],
    wanted: L::M,
) -> (L::M, L::M, L::M) {
    let zero = L::F::splat(0.0);
    // Underflow does no harm.
    let product = functions[0] * functions[1] * functions[2];
    // No array of masks: they would go through memory.
    let sides = (zero.lt(functions[0]), zero.lt(functions[1]), zero.lt(functions[2]));
    if !zero.le(product).and(product.le(zero)).and(wanted).any() {
        return sides;
    }
    let moved = inlined!(|side: L::M, function: L::F, [a, b]: [Offset<L>; 2]| {
        let met = zero.le(function).and(function.le(zero));
        // How the function changes to the right, and where it does not, down.
        let level = b[1].le(a[1]).and(a[1].le(b[1]));
        side.or(met.and(b[1].lt(a[1]).or(level.and(a[0].lt(b[0])))))
    });
    let [e, f, g] = edges;
    (moved(sides.0, functions[0], e), moved(sides.1, functions[1], f), moved(sides.2, functions[2], g))
}

/// Point at which a ray passes a face: barycentric weights of the corners (each one's is the edge function of the other two), and its depth.
///
/// It has the same bits whatever the order of the corners, and whichever of the face's two cells the ray is in: sums have two terms that are
/// not 0, since depths and values are counted from those of a corner, or begin with the smaller ones. So a segment does not depend on
/// what else is drawn. Depths are counted from the corner of the largest weight: a ray through a corner passes all its faces at its depth.
pub(super) struct FacePoint<L: Lanes> {
    /// Perspective-correct weights.
    weights: [L::F; 3],
    /// Reciprocal of their sum.
    by_sum: L::F,
    /// Depth (steps).
    pub depth: L::U,
    /// Depth, scene lengths (perspective).
    pub distance: L::F,
}

/// Depth of the corner of the largest weight; of equal ones the least.
#[inline(always)]
fn heaviest<L: Lanes>(weights: [L::F; 3], depths: [L::U; 3]) -> L::U {
    let heavier = inlined!(|(a, depth_a): (L::F, L::U), (b, depth_b): (L::F, L::U)| {
        let of_equal = depth_a.min(depth_b);
        let depth = L::U::select(b.lt(a), depth_a, L::U::select(a.lt(b), depth_b, of_equal));
        (a.max(b), depth)
    });
    let of_two = heavier((weights[0], depths[0]), (weights[1], depths[1]));
    heavier(of_two, (weights[2], depths[2])).1
}

impl<L: Lanes> FacePoint<L> {
    /// The point for the edge functions of corners 0 and 1, 1 and 2, 2 and 0, none negative, and the depths of the corners.
    #[inline(always)]
    pub fn new(points: &Points, functions: [L::F; 3], depth: [L::U; 3]) -> Self {
        let (one, half) = (L::F::splat(1.0), L::F::splat(0.5));
        let weights = [functions[1], functions[2], functions[0]];
        let [smaller, larger] = [weights[0].min(weights[1]), weights[0].max(weights[1])];
        let sum_of_smaller = smaller + larger.min(weights[2]);
        let total = sum_of_smaller + larger.max(weights[2]) + L::F::splat(MIN_CORNER_WEIGHT);
        let from = heaviest::<L>(weights, depth);
        let higher: [L::F; 3] = array!(|k| (depth[k] - from).to_float());
        let above = weights[0] * higher[0] + weights[1] * higher[1] + weights[2] * higher[2];
        let is_before = above.lt(L::F::splat(0.0));
        let at = inlined!(|by_total: L::F| {
            let steps = above.abs().mul_add(by_total, half).to_unsigned();
            L::U::select(is_before, from - steps, from + steps)
        });
        if !points.perspective {
            let by_total = one / total;
            return FacePoint { weights, by_sum: by_total, depth: at(by_total), distance: one };
        }
        let (first, fall) = (L::F::splat(points.nearest), L::F::splat(-points.step));
        let inverse = from.to_float().mul_add(fall, first);
        let perspective: [L::F; 3] = array!(|k| weights[k] * higher[k].mul_add(fall, inverse));
        let sum = above.mul_add(fall, total * inverse);
        let by_both = one / (total * sum);
        let by_sum = by_both * total;
        FacePoint { weights: perspective, by_sum, depth: at(by_both * sum), distance: total * by_sum }
    }

    /// Interpolates values, counted from the least: a constant stays what it is.
    #[inline(always)]
    pub fn interpolate(&self, values: [L::F; 3]) -> L::F {
        let least = values[0].min(values[1]).min(values[2]);
        let [a, b, c]: [L::F; 3] = array!(|k| self.weights[k] * (values[k] - least));
        (a + b + c).mul_add(self.by_sum, least)
    }
}
