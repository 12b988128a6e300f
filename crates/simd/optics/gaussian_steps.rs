//! A Gaussian along a path in equal steps: each value from the one before, by two products.

use super::elementary::{dot, exp, polynomial};
use crate::{Float, Lanes};

/// A Gaussian at `N` places of one step after the other of a path: a value and its ratio to the next, which changes by the same
/// factor at each step. After four steps its errors are some 1e-6.
#[derive(Clone, Copy)]
pub struct LaneGaussianSteps<L: Lanes, const N: usize> {
    /// In the step in hand.
    pub values: [L::F; N],
    /// Each to that in the next step.
    pub ratios: [L::F; N],
    /// Ratio of every ratio to the next.
    pub change: L::F,
}

impl<L: Lanes, const N: usize> LaneGaussianSteps<L, N> {
    /// From q at the start of the first step, and over a step: at most 0.51 widths. `places`: shares of a step; `peak`: the value
    /// at the centre.
    #[inline(always)]
    pub fn new(start: [L::F; 2], step: [L::F; 2], places: [f32; N], peak: L::F) -> Self {
        let splat = L::F::splat;
        let d2 = dot::<L, 2>(&step, &step);
        // q + d is as far from the centre as (q + d)² = q² + 2 q d + d²; with q = q₀ + u d the ratio is that at u = 0 times
        // e^(−2 u d²).
        let first = exp::<L>(-(dot::<L, 2>(&start, &step).mul_add(splat(2.0), d2)));
        let less = inlined!(|u: f32| {
            let series = [1.0, 1.0, 0.5, 1.0 / 6.0, 1.0 / 24.0, 1.0 / 120.0, 1.0 / 720.0, 1.0 / 5040.0];
            polynomial::<L, 8>(d2 * splat(-2.0 * u), series)
        });
        LaneGaussianSteps {
            values: array!(|j| {
                let q: [L::F; 2] = array!(|i| step[i].mul_add(splat(places[j]), start[i]));
                peak * exp::<L>(-dot::<L, 2>(&q, &q))
            }),
            ratios: array!(|j| first * less(places[j])),
            change: less(1.0),
        }
    }

    /// Values at the next step.
    #[inline(always)]
    pub fn next(&self) -> Self {
        let &LaneGaussianSteps { values, ratios, change } = self;
        let times = inlined!(|x: [L::F; N], y: [L::F; N]| -> [L::F; N] { array!(|j| x[j] * y[j]) });
        LaneGaussianSteps { values: times(values, ratios), ratios: times(ratios, [change; N]), change }
    }
}
