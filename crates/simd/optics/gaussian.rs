//! Gaussian widget: optical depth of a segment, and its light under the constant-emitter. Twin of `optics::kinds::gaussian`.
//!
//! Song et al. 2009, section 4.2; Kniss et al. 2003, Eq. 11, rewritten so that no branch cancels. With
//! q = K (v − v₀), d = |q_b − q_f|, a and b the distances of the ends along the line from the foot of the
//! perpendicular, h its distance from the centre, the mean profile is e^(−h²) m(a, b), m the mean of e^(−x²) over
//! [a, b]. Mirrored so that |a| ≤ b:
//! - b d ≤ 1: e^(−x̄²) × the mean of e^(−y²) cosh(2 x̄ y) over y ∈ [0, d/2], by its series in d² and x̄ d;
//! - else √π/2 ((a < 0: 2 − E_a; a ≥ 0: E_a) − E_b)/d with E_x = e^(−x²) erfcx |x|. For a ≥ 0 the difference loses
//!   less than one bit, since E_b/E_a ≤ e^(−d(a + b)) and d (a + b) > 1 there.

use super::elementary::{HALF_SQRT_PI, dot, erfcx, exp, exp_down, polynomial};
use super::quadrature::POINTS;
use super::smooth::{self, DensityShape};
use super::track::{LaneTrack, PASSED, at_nodes};
use crate::{Float, Lanes, Mask};

/// A path relative to the centre, in widths.
#[derive(Clone, Copy)]
pub struct LaneGaussianPath<L: Lanes> {
    /// a, ≤ b.
    pub front: L::F,
    /// b.
    pub back: L::F,
    /// d; 0 for a segment without extent.
    pub length: L::F,
    /// 1/d; 0 for a segment without extent.
    inverse: L::F,
    /// h².
    pub offset_squared: L::F,
}

impl<L: Lanes> LaneGaussianPath<L> {
    /// From q at both ends (already multiplied by K).
    #[inline(always)]
    pub fn new<const N: usize>(front: [L::F; N], back: [L::F; N]) -> Self {
        let splat = L::F::splat;
        let zero = splat(0.0);
        let step: [L::F; N] = array!(|i| back[i] - front[i]);
        let d2 = dot::<L, N>(&step, &step);
        // 1/d, or 0 for a segment without extent: then a = b = 0 and h² = |q_f|².
        let flat = d2.le(splat(1e-30));
        let inverse = L::F::select(flat, zero, splat(1.0) / d2.max(splat(1e-30)).sqrt());
        let d = d2 * inverse;
        let direction: [L::F; N] = array!(|i| step[i] * inverse);
        let (a, b) = (dot::<L, N>(&front, &direction), dot::<L, N>(&back, &direction));
        // h from the end nearer to the foot, as a vector: never |q|² − a².
        let front_nearer = a.abs().lt(b.abs());
        let along = L::F::select(front_nearer, a, b);
        let mut h2 = zero;
        if N > 1 {
            for i in 0..N {
                let end = L::F::select(front_nearer, front[i], back[i]);
                let across = end - along * direction[i];
                h2 = across.mul_add(across, h2);
            }
        } else {
            h2 = L::F::select(flat, front[0] * front[0], zero);
        }
        LaneGaussianPath { front: a, back: b, length: d, inverse, offset_squared: h2 }
    }

    /// The t between which the profile exceeds e^(−`level`), not clamped to the path; the first above the second where
    /// it nowhere does.
    #[inline(always)]
    pub fn window_ends(&self, level: f32) -> [L::F; 2] {
        let splat = L::F::splat;
        let zero = splat(0.0);
        let room = splat(level) - self.offset_squared;
        let half = room.max(zero).sqrt().min(splat(1e18));
        let flat = self.length.le(zero);
        let start = L::F::select(flat, splat(-1.0), (-half - self.front) * self.inverse);
        let end = L::F::select(flat, splat(2.0), (half - self.front) * self.inverse);
        [start, L::F::select(zero.lt(room), end, start - splat(1.0))]
    }

    /// The mean where the path is long.
    #[inline(always)]
    fn far_mean(&self) -> L::F {
        let splat = L::F::splat;
        let zero = splat(0.0);
        let (a, b, h2) = (self.front, self.back, self.offset_squared);
        // Mirror so that |a| ≤ b.
        let mirrored = (a + b).lt(zero);
        let (low, high) = (L::F::select(mirrored, -b, a), L::F::select(mirrored, -a, b));
        let tail = inlined!(|x: L::F| exp::<L>(-(x.mul_add(x, h2))) * erfcx::<L>(x.abs()));
        let (tail_low, tail_high) = (tail(low), tail(high));
        let both = splat(2.0) * exp::<L>(-h2) - tail_low;
        let across = L::F::select(low.lt(zero), both, tail_low);
        (splat(HALF_SQRT_PI) * (across - tail_high) * self.inverse).max(zero)
    }
}

/// Inputs of the mean over a short path: no root and no quotient.
#[derive(Clone, Copy)]
pub struct Near<L: Lanes> {
    /// |q̄|² = x̄² + h², q̄ the middle.
    middle_squared: L::F,
    /// p = x̄ d = q̄ · (q_b − q_f).
    product: L::F,
    /// d².
    length_squared: L::F,
}

/// The most of |p| + ½ d² for which the terms of [`Near::five_terms`] do, those of [`Near::nine_terms`], and those of
/// [`Near::all_terms`].
const MAX_DEPTH_FIVE_TERMS: f32 = 1.0 / 32.0;
const MAX_DEPTH_NINE_TERMS: f32 = 0.25;
const MAX_DEPTH_NEAR: f32 = 1.0;

impl<L: Lanes> Near<L> {
    /// A path that is a point, the centre.
    #[inline(always)]
    pub fn none() -> Self {
        let zero = L::F::splat(0.0);
        Near { middle_squared: zero, product: zero, length_squared: zero }
    }

    /// From q at both ends (already multiplied by K).
    #[inline(always)]
    pub fn new<const N: usize>(front: &[L::F; N], back: &[L::F; N]) -> Self {
        let half = L::F::splat(0.5);
        let (step, middle) = (back[0] - front[0], (front[0] + back[0]) * half);
        let mut near =
            Near { middle_squared: middle * middle, product: middle * step, length_squared: step * step };
        for i in 1..N {
            let (step, middle) = (back[i] - front[i], (front[i] + back[i]) * half);
            near.middle_squared = middle.mul_add(middle, near.middle_squared);
            near.product = middle.mul_add(step, near.product);
            near.length_squared = step.mul_add(step, near.length_squared);
        }
        near
    }

    /// The mean on the lanes that are `wanted`; `path` makes the whole path where one of them needs it.
    #[inline(always)]
    fn mean(&self, wanted: L::M, path: impl Fn() -> LaneGaussianPath<L>) -> L::F {
        let splat = L::F::splat;
        let middle = exp_down::<L>(self.middle_squared);
        let twice = self.product.abs().mul_add(splat(2.0), self.length_squared);
        let within = inlined!(|most: f32| twice.le(splat(2.0 * most)));
        // Each lane by the terms that its own path wants, whatever the others are.
        let mut terms = self.five_terms();
        if !within(MAX_DEPTH_FIVE_TERMS).not().and(wanted).any() {
            return middle * terms;
        }
        terms = L::F::select(within(MAX_DEPTH_FIVE_TERMS), terms, self.nine_terms());
        if !within(MAX_DEPTH_NINE_TERMS).not().and(wanted).any() {
            return middle * terms;
        }
        let near = middle * L::F::select(within(MAX_DEPTH_NINE_TERMS), terms, self.all_terms());
        if !within(MAX_DEPTH_NEAR).not().and(wanted).any() {
            return near;
        }
        L::F::select(within(MAX_DEPTH_NEAR), near, path().far_mean())
    }

    /// The mean of e^(r u²) cosh(p u) over u ∈ [0, 1], r = −¼ d², as Σ r^i p^(2j)/(i! (2j)! (2 (i + j) + 1)): with |p| − 2 r ≤ 1
    /// what is left out is under 4e-8 of it. The sums over i for j = 0 and 1 are the best polynomials that are a term shorter
    /// or two (Remez; of the second (1 + 2 r)² counts, which is all that p² can be): in 32 bits they leave 1e-8.
    #[inline(always)]
    fn all_terms(&self) -> L::F {
        let (r, squared) = (self.length_squared * L::F::splat(-0.25), self.product * self.product);
        let of_gauss = polynomial::<L, 6>(
            r,
            [1.0, 0.333_333_23, 0.099_997_66, 0.023_789_505, 0.004_551_490_4, 6.139_601_6e-4],
        );
        let second = polynomial::<L, 5>(
            r,
            [0.166_666_67, 0.099_999_67, 0.035_705_751, 0.009_184_534, 0.001_634_864_8],
        );
        let fourth = polynomial::<L, 4>(r, [1.0 / 120.0, 1.0 / 168.0, 1.0 / 432.0, 1.0 / 1_584.0]);
        let sixth = polynomial::<L, 3>(r, [1.0 / 5_040.0, 1.0 / 6_480.0, 1.0 / 15_840.0]);
        let of_cosh = squared.mul_add(L::F::splat(1.0 / 362_880.0), sixth).mul_add(squared, fourth);
        let of_cosh = of_cosh.mul_add(squared, second);
        squared.mul_add(of_cosh, of_gauss)
    }

    /// [`Near::all_terms`] where |p| − 2 r ≤ ¼: the best nine there, a linear program over a grid of r and p, leave 1.2e-8.
    #[inline(always)]
    fn nine_terms(&self) -> L::F {
        let (r, squared) = (self.length_squared * L::F::splat(-0.25), self.product * self.product);
        let of_gauss = polynomial::<L, 4>(r, [1.0, 0.333_331_58, 0.099_918_01, 0.022_703_89]);
        let second = polynomial::<L, 3>(r, [0.166_665_74, 0.099_939_11, 0.034_537_85]);
        let fourth = polynomial::<L, 2>(r, [0.008_357_734, 0.006_611_653]);
        squared.mul_add(squared.mul_add(fourth, second), of_gauss)
    }

    /// [`Near::all_terms`] where |p| − 2 r ≤ 1/32, as of nine in ten segments of a grid that resolves its widgets: the best five
    /// there leave 4e-9.
    #[inline(always)]
    fn five_terms(&self) -> L::F {
        let (r, squared) = (self.length_squared * L::F::splat(-0.25), self.product * self.product);
        let of_gauss = polynomial::<L, 3>(r, [1.0, 0.333_330_92, 0.099_489_56]);
        let second = polynomial::<L, 2>(r, [0.166_671, 0.100_086_94]);
        squared.mul_add(second, of_gauss)
    }

    /// Depth and shape for a rate of `peak` = ρ₀ D at the centre on the lanes that are `wanted`; `path` makes the whole path
    /// where one of them needs it. With x = x̄ + ½ d u, p = x̄ d and r = ¼ d²: a = −p (1 − (p² + 4 r)/15) and b = (p² − 2 r)/3 to
    /// fourth order.
    #[inline(always)]
    pub fn shape(&self, peak: L::F, wanted: L::M, path: impl Fn() -> LaneGaussianPath<L>) -> DensityShape<L> {
        let splat = L::F::splat;
        let (p, d2) = (self.product, self.length_squared);
        let p2 = p * p;
        DensityShape {
            depth: self.mean(wanted, path) * peak,
            tilt: p * (p2 + d2).mul_add(splat(1.0 / 15.0), splat(-1.0)),
            bend: d2.mul_add(splat(-0.5), p2) * splat(1.0 / 3.0),
            change_squared: d2.max(p2),
            extent_squared: d2,
        }
    }
}

/// Mean over the segment of exp(−|q|²), q linear from `front` to `back` in N dimensions (q already multiplied by
/// K). Relative error some 4e-7 (1 + condition).
#[inline(always)]
pub fn mean_profile<L: Lanes, const N: usize>(front: [L::F; N], back: [L::F; N]) -> L::F {
    let all = L::F::splat(0.0).le(L::F::splat(0.0));
    Near::<L>::new(&front, &back).mean(all, inlined!(|| LaneGaussianPath::new(front, back)))
}

/// [`Near::shape`] of the path between two points, q as for [`mean_profile`].
#[inline(always)]
pub fn shape<L: Lanes, const N: usize>(
    front: [L::F; N],
    back: [L::F; N],
    peak: L::F,
    wanted: L::M,
) -> DensityShape<L> {
    Near::<L>::new(&front, &back).shape(peak, wanted, inlined!(|| LaneGaussianPath::new(front, back)))
}

/// The roughness of [`shape`].
#[inline(always)]
pub fn roughness<L: Lanes, const N: usize>(front: [L::F; N], back: [L::F; N]) -> L::F {
    let Near { product: p, length_squared: d2, .. } = Near::<L>::new(&front, &back);
    smooth::roughness::<L>(d2.max(p * p), d2)
}

/// A Gaussian as a [`LaneTrack`].
#[derive(Clone, Copy)]
pub struct LaneGaussianTrack<L: Lanes> {
    /// x at the front.
    pub front: L::F,
    /// x at the back, ≥ front.
    pub back: L::F,
    /// Their difference.
    pub length: L::F,
    /// ρ₀ D e^(−h²).
    pub peak: L::F,
}

impl<L: Lanes> LaneGaussianTrack<L> {
    /// The track of a path with the peak rate `peak` = ρ₀ D.
    #[inline(always)]
    pub fn new(path: &LaneGaussianPath<L>, peak: L::F) -> Self {
        let peak = peak * exp::<L>(-path.offset_squared);
        LaneGaussianTrack { front: path.front, back: path.back, length: path.length, peak }
    }
}

/// Widest panel on which 8 points resolve e^(−x²) from x on: 1.2 about the centre, and a change of x² by 3 further out.
const STEP: f32 = 1.2;
/// e^(−49) = 5e-22: beyond it nothing is resolved.
const FAR: f32 = 7.0;

impl<L: Lanes> LaneTrack<L> for LaneGaussianTrack<L> {
    #[inline(always)]
    fn rates(&self, t: L::F, dt: L::F) -> [L::F; POINTS] {
        let x = at_nodes::<L>(self.front, self.back, t, dt);
        array!(|i| self.peak * exp::<L>(-(x[i] * x[i])))
    }

    #[inline(always)]
    fn next_break(&self, t: L::F) -> L::F {
        let splat = L::F::splat;
        let x = (self.back - self.front).mul_add(t, self.front);
        let step = (splat(1.5) / x.abs().max(splat(0.1))).min(splat(STEP));
        let step = L::F::select(x.lt(splat(-FAR)), splat(-FAR) - x, step);
        let next = t + (step / self.length.max(splat(1e-30))).max(splat(2.0 * PASSED));
        L::F::select(x.lt(splat(FAR)), next, splat(2.0))
    }
}

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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::smooth::tests::{lane, uniform};
    use crate::portable::Portable as P;

    type F = <P as Lanes>::F;

    /// The mean of e^(r u²) cosh(p u) over u ∈ [0, 1] by its series.
    fn even_part(r: f64, p: f64) -> f64 {
        let mut sum = 0.0;
        let mut of_p = 1.0;
        for j in 0..12 {
            let mut term = of_p;
            for i in 0..20 {
                sum += term / f64::from(2 * (i + j) + 1);
                term *= r / f64::from(i + 1);
            }
            of_p *= p * p / f64::from((2 * j + 1) * (2 * j + 2));
        }
        sum
    }

    #[test]
    fn terms_of_short_paths_are_enough_to_their_ends() {
        let all = F::splat(0.0).le(F::splat(1.0));
        for most in [MAX_DEPTH_FIVE_TERMS, MAX_DEPTH_NINE_TERMS, MAX_DEPTH_NEAR] {
            let mut worst = 0.0;
            for i in 0..20_000 {
                // One in four at the end.
                let reach = f64::from(most) * if i % 4 == 0 { 0.999_999 } else { uniform(i, 1) };
                let share = uniform(i, 2);
                let (d2, p) = ((2.0 * reach * share) as f32, (reach * (1.0 - share)) as f32);
                let near = Near::<P> {
                    middle_squared: F::splat(0.0),
                    product: F::splat(p),
                    length_squared: F::splat(d2),
                };
                let found = near.mean(all, || unreachable!("the path is short: {p}, {d2}"));
                let exact = even_part(f64::from(d2) * -0.25, f64::from(p));
                worst = f64::max(worst, (lane(found) / exact - 1.0).abs());
            }
            println!("up to {most}: {worst:.1e}");
            // Two roundings of numbers near 1, and what the terms leave.
            assert!(worst < 1.8e-7, "up to {most}: {worst:e}");
        }
    }
}
