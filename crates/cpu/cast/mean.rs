//! Where rays pass faces.

use super::points::Points;
use voltet_simd::{Float, Lanes, Unsigned, array};

/// Added to the weight of a corner, so that three of no weight have a mean: less than any that is not 0.
const LEAST: f32 = 1e-15;

/// The mean of the corners of faces where rays pass them: each one's weight is the turn of the other two.
pub(super) struct Mean<L: Lanes> {
    /// Weights as they count along the ray.
    seen: [L::F; 3],
    /// By the sums of weights on the screen and of these.
    pub by_total: L::F,
    by_seen: L::F,
    /// Σ weight × (depth − a depth), in steps.
    pub above: L::F,
    /// Depth, scene lengths (perspective).
    pub distance: L::F,
}

impl<L: Lanes> Mean<L> {
    /// Of corners at these depths; `near`: one of them, that depths are taken from.
    #[inline(always)]
    pub fn new<const PERSPECTIVE: bool>(
        points: &Points,
        turns: [L::F; 3],
        depth: [L::U; 3],
        near: L::U,
    ) -> Self {
        let one = L::F::splat(1.0);
        let weights = [turns[1], turns[2], turns[0]];
        let total = weights[0] + weights[1] + (weights[2] + L::F::splat(LEAST));
        let higher: [L::F; 3] = array(
            #[inline(always)]
            |k| (depth[k] - near).to_float(),
        );
        let above = weights[0].mul_add(higher[0], weights[1].mul_add(higher[1], weights[2] * higher[2]));
        if !PERSPECTIVE {
            let by_total = one / total;
            return Mean { seen: weights, by_total, by_seen: by_total, above, distance: one };
        }
        let (nearest, fall) = (L::F::splat(points.nearest), L::F::splat(-points.step));
        let inverse = near.to_float().mul_add(fall, nearest);
        let seen: [L::F; 3] = array(
            #[inline(always)]
            |k| weights[k] * higher[k].mul_add(fall, inverse),
        );
        let seen_total = above.mul_add(fall, total * inverse);
        let by_both = one / (total * seen_total);
        let by_seen = by_both * total;
        Mean { seen, by_total: by_both * seen_total, by_seen, above, distance: total * by_seen }
    }

    /// Of values, taken from one of them: a constant stays what it is.
    #[inline(always)]
    pub fn of(&self, values: [L::F; 3], from: L::F) -> L::F {
        let [a, b, c] = array(
            #[inline(always)]
            |k| values[k] - from,
        );
        let sum = self.seen[0].mul_add(a, self.seen[1].mul_add(b, self.seen[2] * c));
        sum.mul_add(self.by_seen, from)
    }
}
