//! The partial pre-integration table in lanes. Twin of `optics::integrators::PartialTable`, which fills it: over √r with
//! r = a/(a + b), and u = √T/(1 + √T) with T = (a + b)/2; bilinear.

use crate::{Float, Lanes, Unsigned, inlined};
use voltet_core::optics::integrators::PartialTable;

/// The table, each entry with its neighbours in the next column, the next row and both: one load finds what a place lies
/// between.
#[derive(Debug, Clone)]
pub struct LanePartialTable {
    last: f32,
    size: u32,
    /// The front colour's share of the light, or F (1 + √T).
    front: Vec<[f32; 4]>,
    /// Empty, or B (1 + √T).
    back: Vec<[f32; 4]>,
}

impl LanePartialTable {
    /// Of a table.
    pub fn new(table: &PartialTable) -> LanePartialTable {
        let size = table.size();
        let around = |entries: &[f32]| -> Vec<[f32; 4]> {
            let place = |k: usize| {
                let (row, column) = (k / size, k % size);
                let at = |j: usize, i: usize| entries[j.min(size - 1) * size + i.min(size - 1)];
                [at(row, column), at(row, column + 1), at(row + 1, column), at(row + 1, column + 1)]
            };
            (0..entries.len()).map(place).collect()
        };
        LanePartialTable {
            last: (size - 1) as f32,
            size: size as u32,
            front: around(table.front()),
            back: around(table.back()),
        }
    }

    /// φ, the front colour's share of a piece's light (density-emitter).
    #[inline(always)]
    pub fn front_share<L: Lanes>(&self, a: L::F, b: L::F) -> L::F {
        self.place::<L>(a, b).read(&self.front)
    }

    /// F and B (constant-emitter).
    #[inline(always)]
    pub fn front_back<L: Lanes>(&self, a: L::F, b: L::F) -> (L::F, L::F) {
        let place = self.place::<L>(a, b);
        let scale = L::F::splat(1.0) / (L::F::splat(1.0) + place.root);
        (place.read(&self.front) * scale, place.read(&self.back) * scale)
    }

    #[inline(always)]
    fn place<L: Lanes>(&self, a: L::F, b: L::F) -> Place<L> {
        let splat = L::F::splat;
        let (zero, one) = (splat(0.0), splat(1.0));
        // Also where the depth of a piece leaves the range of numbers.
        let whole = (a + b).min(splat(f32::MAX));
        let least = splat(f32::MIN_POSITIVE);
        let ratio = L::F::select(whole.lt(least), splat(0.5), a / whole.max(least)).min(one);
        let root = (splat(0.5) * whole).sqrt();
        let (last, before) = (splat(self.last), splat(self.last - 1.0));
        let split = inlined(
            #[inline(always)]
            |x: L::F| {
                let x = (x * last).max(zero).min(last);
                let low = x.floor().min(before);
                (low, x - low)
            },
        );
        let ((column, x), (row, y)) = (split(ratio.sqrt()), split(root / (one + root)));
        Place { first: row.to_unsigned() * L::U::splat(self.size) + column.to_unsigned(), x, y, root }
    }
}

/// A place between four entries.
struct Place<L: Lanes> {
    first: L::U,
    x: L::F,
    y: L::F,
    /// √T.
    root: L::F,
}

impl<L: Lanes> Place<L> {
    #[inline(always)]
    fn read(&self, entries: &[[f32; 4]]) -> L::F {
        let around = L::F::gather_parts(entries, self.first);
        let low = self.x.mul_add(around[1] - around[0], around[0]);
        let high = self.x.mul_add(around[3] - around[2], around[2]);
        self.y.mul_add(high - low, low)
    }
}
