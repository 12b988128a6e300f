//! The partial pre-integration table in lanes. Twin of `PartialTable`, which fills it: over √r with
//! r = a/(a + b), and u = √T/(1 + √T) with T = (a + b)/2; bilinear.

use super::square::{LaneSquare, Place};
use crate::PartialTable;
use voltet_simd::{Float, Lanes, inlined};

/// The table.
#[derive(Debug, Clone)]
pub struct LanePartialTable {
    /// The front colour's share of the light, or F (1 + √T).
    front: LaneSquare,
    /// B (1 + √T), where it is kept.
    back: Option<LaneSquare>,
}

impl LanePartialTable {
    /// Converts a table in 64 bits.
    pub fn new(table: &PartialTable) -> LanePartialTable {
        let square = |entries: &[f32]| LaneSquare::new(entries, table.size());
        LanePartialTable {
            front: square(table.front()),
            back: (!table.back().is_empty()).then(|| square(table.back())),
        }
    }

    /// φ, the front colour's share of a piece's light (density-emitter).
    #[inline(always)]
    pub fn front_share<L: Lanes>(&self, a: L::F, b: L::F) -> L::F {
        self.front.read(&self.place::<L>(a, b).0)
    }

    /// F and B (constant-emitter).
    #[inline(always)]
    pub fn front_back<L: Lanes>(&self, a: L::F, b: L::F) -> (L::F, L::F) {
        let (place, root) = self.place::<L>(a, b);
        let scale = L::F::splat(1.0) / (L::F::splat(1.0) + root);
        let back = match &self.back {
            Some(back) => back.read(&place),
            None => L::F::splat(0.0),
        };
        (self.front.read(&place) * scale, back * scale)
    }

    /// The place, and √T.
    #[inline(always)]
    fn place<L: Lanes>(&self, a: L::F, b: L::F) -> (Place<L>, L::F) {
        let splat = L::F::splat;
        let (zero, one) = (splat(0.0), splat(1.0));
        // Also where the depth of a piece leaves the range of numbers.
        let whole = (a + b).min(splat(f32::MAX));
        let least = splat(f32::MIN_POSITIVE);
        let ratio = L::F::select(whole.lt(least), splat(0.5), a / whole.max(least)).min(one);
        let root = (splat(0.5) * whole).sqrt();
        let last = splat(self.front.last());
        let within = inlined(
            #[inline(always)]
            |x: L::F| (x * last).max(zero).min(last),
        );
        (self.front.place(within(root / (one + root)), within(ratio.sqrt())), root)
    }
}
