//! On which side of an edge a ray passes.

use voltet_simd::{Float, Lanes, Mask, inlined};

/// Places on the screen relative to the rays, pixels to the right and down.
pub(super) type At<L> = [<L as Lanes>::F; 2];

/// Twice the area of the triangle of two places and the ray: positive where they turn clockwise about it on the screen. Exchanged
/// places give a number of the opposite sign, and 0 gives 0. Two products of which the rounding of one is made good (Kahan; Jeannerod,
/// Louvet and Muller 2013): where the edge passes close by the ray, all digits of the difference count.
#[inline(always)]
pub(super) fn turn<L: Lanes>(a: At<L>, b: At<L>) -> L::F {
    let product = a[1] * b[0];
    let rest = a[1].mul_add(b[0], -product);
    a[0].mul_add(b[1], -product) - rest
}

/// Whether the turns of three edges are clockwise about rays that are moved right by next to nothing and down by next to nothing of that,
/// so that none meets an edge.
#[inline(always)]
pub(super) fn clockwise<L: Lanes>(turns: [L::F; 3], edges: [[At<L>; 2]; 3]) -> (L::M, L::M, L::M) {
    let zero = L::F::splat(0.0);
    // Underflow does no harm.
    let product = turns[0] * turns[1] * turns[2];
    // No array of masks: they would go through memory.
    let sides = (zero.lt(turns[0]), zero.lt(turns[1]), zero.lt(turns[2]));
    if !zero.le(product).and(product.le(zero)).any() {
        return sides;
    }
    let moved = inlined(
        #[inline(always)]
        |side: L::M, turn: L::F, [a, b]: [At<L>; 2]| {
            let met = zero.le(turn).and(turn.le(zero));
            // How the turn changes to the right, and where it does not, down.
            let level = b[1].le(a[1]).and(a[1].le(b[1]));
            side.or(met.and(b[1].lt(a[1]).or(level.and(a[0].lt(b[0])))))
        },
    );
    let [e, f, g] = edges;
    (moved(sides.0, turns[0], e), moved(sides.1, turns[1], f), moved(sides.2, turns[2], g))
}
