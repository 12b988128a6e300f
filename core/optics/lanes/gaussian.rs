//! Gaussian widget: optical depth of a segment. Twin of `optics::gaussian`.
//!
//! Song et al. 2009, section 4.2; Kniss et al. 2003, Eq. 11, rewritten so that no branch cancels. With
//! q = K (v − v₀), d = |q_b − q_f|, a and b the distances of the ends along the line from the foot of the
//! perpendicular, h its distance from the centre, the mean profile is e^(−h²) m(a, b), m the mean of e^(−x²) over
//! [a, b]. Mirrored so that |a| ≤ b:
//! - 2 b d ≤ 1: e^(−x̄²) × the mean of e^(−y²) cosh(2 x̄ y) over y ∈ [0, d/2], by Gauss-Legendre with 5 points (its
//!   even part: 3 evaluations);
//! - else √π/2 ((a < 0: 2 − E_a; a ≥ 0: E_a) − E_b)/d with E_x = e^(−x²) erfcx |x|. For a ≥ 0 the difference loses
//!   less than one bit, since E_b/E_a ≤ e^(−d(a + b)) and d (a + b) > ½ there.

use super::elementary::{HALF_SQRT_PI, erfcx, exp, polynomial};
use crate::lanes::{Float, Lanes, Mask, array, inlined};

/// Mean over the segment of exp(−|q|²), q linear from `front` to `back` in N dimensions (q already multiplied by
/// K). Relative error some 4e-7 (1 + condition).
#[inline(always)]
pub fn mean_profile<L: Lanes, const N: usize>(front: [L::F; N], back: [L::F; N]) -> L::F {
    let splat = L::F::splat;
    let zero = splat(0.0);
    let dot = inlined(
        #[inline(always)]
        |a: &[L::F; N], b: &[L::F; N]| {
            let mut sum = a[0] * b[0];
            for i in 1..N {
                sum = a[i].mul_add(b[i], sum);
            }
            sum
        },
    );
    let step: [L::F; N] = array(
        #[inline(always)]
        |i| back[i] - front[i],
    );
    let d2 = dot(&step, &step);
    // 1/d, or 0 for a segment without extent: then a = b = 0 and h² = |q_f|².
    let flat = d2.le(splat(1e-30));
    let inverse = L::F::select(flat, zero, splat(1.0) / d2.max(splat(1e-30)).sqrt());
    let d = d2 * inverse;
    let direction: [L::F; N] = array(
        #[inline(always)]
        |i| step[i] * inverse,
    );
    let (a, b) = (dot(&front, &direction), dot(&back, &direction));
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
    // Mirror so that |a| ≤ b.
    let mirrored = (a + b).lt(zero);
    let (low, high) = (L::F::select(mirrored, -b, a), L::F::select(mirrored, -a, b));

    let short = (splat(2.0) * high * d).le(splat(1.0));
    let middle = (low + high) * splat(0.5);
    let half = d * splat(0.5);
    // e^(−y²) to y² ≤ ¼ and cosh(2 x̄ y), 2 x̄ y ≤ ½: truncation 1e-7 and 1e-8.
    let even_part = inlined(
        #[inline(always)]
        |node: f32| {
            let y = half * splat(node);
            let y2 = y * y;
            let gauss = polynomial::<L, 6>(-y2, [1.0, 1.0, 0.5, 1.0 / 6.0, 1.0 / 24.0, 1.0 / 120.0]);
            let w = splat(2.0) * middle * y;
            let cosh = polynomial::<L, 4>(w * w, [1.0, 0.5, 1.0 / 24.0, 1.0 / 720.0]);
            gauss * cosh
        },
    );
    let quadrature = even_part(0.906_179_85).mul_add(
        splat(0.236_926_89),
        even_part(0.538_469_3).mul_add(splat(0.478_628_67), splat(0.284_444_45)),
    );
    let near = exp::<L>(-(middle.mul_add(middle, h2))) * quadrature;
    if !short.not().any() {
        return near;
    }
    let tail = inlined(
        #[inline(always)]
        |x: L::F| exp::<L>(-(x.mul_add(x, h2))) * erfcx::<L>(x.abs()),
    );
    let (tail_low, tail_high) = (tail(low), tail(high));
    let both = splat(2.0) * exp::<L>(-h2) - tail_low;
    let across = L::F::select(low.lt(zero), both, tail_low);
    let long = splat(HALF_SQRT_PI) * (across - tail_high) * inverse;
    L::F::select(short, near, long.max(zero))
}
