//! Edge functions, the side of an edge on which a ray passes, and perspective-correct barycentric interpolation with them.

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
/// screen. Exchanged positions give a number of the opposite sign, and 0 gives 0. Where the edge passes close by the ray, all digits of the
/// difference count.
#[inline(always)]
pub(super) fn edge_function<L: Lanes>(a: Offset<L>, b: Offset<L>) -> L::F {
    a[0].difference_of_products(b[1], a[1], b[0])
}

/// Inside test of three edges with a tie rule: true for each edge that is clockwise about rays that are moved right by next to nothing and
/// down by next to nothing of that, so that none meets an edge.
#[inline(always)]
pub(super) fn edges_inside<L: Lanes>(functions: [L::F; 3], edges: [[Offset<L>; 2]; 3]) -> (L::M, L::M, L::M) {
    let zero = L::F::splat(0.0);
    // Underflow does no harm.
    let product = functions[0] * functions[1] * functions[2];
    // No array of masks: they would go through memory.
    let sides = (zero.lt(functions[0]), zero.lt(functions[1]), zero.lt(functions[2]));
    if !zero.le(product).and(product.le(zero)).any() {
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

/// Barycentric weights of the corners of faces where rays pass them: each one's is the edge function of the other two.
pub(super) struct Barycentric<L: Lanes> {
    /// Perspective-correct weights.
    weights: [L::F; 3],
    /// Reciprocals of the sums of weights on the screen and of the perspective-correct ones.
    pub by_total: L::F,
    by_sum: L::F,
    /// Σ weight × (depth − a depth), in steps.
    pub above: L::F,
    /// Depth, scene lengths (perspective).
    pub distance: L::F,
}

impl<L: Lanes> Barycentric<L> {
    /// Weights for corners at some depths; `near`: the corner depth that depths are counted from.
    #[inline(always)]
    pub fn new(points: &Points, functions: [L::F; 3], depth: [L::U; 3], near: L::U) -> Self {
        let one = L::F::splat(1.0);
        let weights = [functions[1], functions[2], functions[0]];
        let total = weights[0] + weights[1] + (weights[2] + L::F::splat(MIN_CORNER_WEIGHT));
        let higher: [L::F; 3] = array!(|k| (depth[k] - near).to_float());
        let above = weights[0].mul_add(higher[0], weights[1].mul_add(higher[1], weights[2] * higher[2]));
        if !points.perspective {
            let by_total = one / total;
            return Barycentric { weights, by_total, by_sum: by_total, above, distance: one };
        }
        let (nearest, fall) = (L::F::splat(points.nearest), L::F::splat(-points.step));
        let inverse = near.to_float().mul_add(fall, nearest);
        let perspective: [L::F; 3] = array!(|k| weights[k] * higher[k].mul_add(fall, inverse));
        let sum = above.mul_add(fall, total * inverse);
        let by_both = one / (total * sum);
        let by_sum = by_both * total;
        Barycentric { weights: perspective, by_total: by_both * sum, by_sum, above, distance: total * by_sum }
    }

    /// Interpolates values, counted from one of them: a constant stays what it is.
    #[inline(always)]
    pub fn interpolate(&self, values: [L::F; 3], from: L::F) -> L::F {
        let [a, b, c] = array!(|k| values[k] - from);
        let sum = self.weights[0].mul_add(a, self.weights[1].mul_add(b, self.weights[2] * c));
        sum.mul_add(self.by_sum, from)
    }
}
