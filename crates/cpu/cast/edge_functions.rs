//! Edge functions: the side of an edge on which a ray passes.

use super::points::SPREAD_BITS;
use voltet_simd::{Float, Lanes, Mask, Unsigned, inlined};

/// Screen positions relative to the rays (pixels to the right and down).
pub(super) type Offset<L> = [<L as Lanes>::F; 2];

/// Steps that a ray has moved at a depth, by `spread` in 2^[`SPREAD_BITS`] steps of depth.
#[inline(always)]
pub(super) fn moved_by_depth<L: Lanes>(depth: L::U, spread: L::U) -> L::U {
    let low = L::U::splat((1 << SPREAD_BITS) - 1);
    depth.shr::<SPREAD_BITS>() * spread + (depth.and(low) * spread).shr::<SPREAD_BITS>()
}

/// Edge function: twice the area of the triangle of two positions and the ray, positive where they turn clockwise about it on the
/// screen. Exchanged positions give a number of the opposite sign, and 0 gives 0. Two products of which the rounding of one is made good (Kahan; Jeannerod,
/// Louvet and Muller 2013): where the edge passes close by the ray, all digits of the difference count.
#[inline(always)]
pub(super) fn edge_function<L: Lanes>(a: Offset<L>, b: Offset<L>) -> L::F {
    let product = a[1] * b[0];
    let rest = a[1].mul_add(b[0], -product);
    a[0].mul_add(b[1], -product) - rest
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
