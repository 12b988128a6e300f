//! Perspective-correct barycentric interpolation where rays pass faces.

use super::points::{PERSPECTIVE, Points};
use crate::tolerances::MIN_CORNER_WEIGHT;
use voltet_simd::{Float, Lanes, Unsigned, array};

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
    pub fn new<const DEPTHS: u8>(
        points: &Points,
        functions: [L::F; 3],
        depth: [L::U; 3],
        near: L::U,
    ) -> Self {
        let one = L::F::splat(1.0);
        let weights = [functions[1], functions[2], functions[0]];
        let total = weights[0] + weights[1] + (weights[2] + L::F::splat(MIN_CORNER_WEIGHT));
        let higher: [L::F; 3] = array!(|k| (depth[k] - near).to_float());
        let above = weights[0].mul_add(higher[0], weights[1].mul_add(higher[1], weights[2] * higher[2]));
        if DEPTHS != PERSPECTIVE {
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
