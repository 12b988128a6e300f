//! A table widget in lanes: an image over the (s, g) plane ([`voltet_simd::optics::table`]).

use crate::attribute::Attribute;
use voltet_core::transfer::Table;
use voltet_simd::optics::table::{LaneTableTrack, LaneTexels};
use voltet_simd::{Float, Lanes, array};

/// Most texels a side: places of texels are then known to a thousandth of one.
const MAX_SIDE: usize = 1 << 14;

/// The texels, and where they lie in scaled attributes.
pub(crate) struct LaneTable {
    texels: LaneTexels,
    /// Column and row of a value: factor × stored + first. Row 0 has the largest g.
    factor: [f32; 2],
    first: [f32; 2],
}

impl LaneTable {
    /// `None` where 32 bits do not hold the places of texels.
    pub fn new(table: &Table, attributes: &[Attribute<'_>]) -> Option<LaneTable> {
        if table.width.max(table.height) > MAX_SIDE {
            return None;
        }
        // What is not at hand is 0 everywhere.
        let axis = |a: usize| attributes.get(a).map_or([0.0, 1.0], |x| [x.offset, x.scale]);
        let place = |a: usize, [from, to]: [f64; 2], count: usize| {
            let per_value = count as f64 / (to - from);
            let [offset, scale] = axis(a);
            [(per_value * scale) as f32, ((offset - from) * per_value - 0.5) as f32]
        };
        let columns = place(0, table.s, table.width);
        let rows = place(1, [table.g[1], table.g[0]], table.height);
        let held = columns.iter().chain(&rows).all(|x| x.is_finite());
        held.then(|| LaneTable {
            texels: LaneTexels::new(table),
            factor: [columns[0], rows[0]],
            first: [columns[1], rows[1]],
        })
    }

    /// Column and row of a point of the plane.
    #[inline(always)]
    fn place<L: Lanes>(&self, v: &[L::F; 2]) -> [L::F; 2] {
        let splat = L::F::splat;
        array!(|a| splat(self.factor[a]).mul_add(v[a], splat(self.first[a])))
    }

    /// Red, green, blue and alpha at a point of the plane within the table's ranges; beyond them those of the edge.
    #[inline(always)]
    pub fn texel<L: Lanes>(&self, v: &[L::F; 2]) -> [L::F; 4] {
        self.texels.at::<L>(&self.place::<L>(v))
    }

    /// Between two points, for a rate of `peak` where alpha is 1; `cutoff`: alpha above which it glows.
    #[inline(always)]
    pub fn track<L: Lanes>(
        &self,
        front: &[L::F; 2],
        back: &[L::F; 2],
        peak: L::F,
        cutoff: Option<f64>,
    ) -> LaneTableTrack<'_, L> {
        let (front, back) = (self.place::<L>(front), self.place::<L>(back));
        LaneTableTrack { texels: &self.texels, front, back, peak, cutoff: cutoff.map(|share| share as f32) }
    }
}
