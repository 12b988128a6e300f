//! A table widget in lanes: an image over the (s, g) plane, bilinear between the centres of its texels (Song et al. 2009,
//! section 3.3.2). Twin of `optics::table`.

use crate::attribute::Attribute;
use voltet_core::transfer::Table;
use voltet_lanes::{Float, Lanes, Unsigned, array, inlined};

/// Most texels a side: places of texels are then known to a thousandth of one.
const SIDE_MOST: usize = 1 << 14;

/// The texels, and where they lie in scaled attributes.
pub(crate) struct LaneTable {
    texels: Vec<[f32; 4]>,
    /// Columns and rows, less 1.
    last: [f32; 2],
    /// Column and row of a value: factor × stored + first. Texel centres lie at the integers; row 0 has the largest g.
    factor: [f32; 2],
    first: [f32; 2],
}

impl LaneTable {
    /// `None` where 32 bits do not hold the places of texels.
    pub fn new(table: &Table, attributes: &[Attribute<'_>]) -> Option<LaneTable> {
        if table.width.max(table.height) > SIDE_MOST {
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
            texels: table.texels.clone(),
            last: [(table.width - 1) as f32, (table.height - 1) as f32],
            factor: [columns[0], rows[0]],
            first: [columns[1], rows[1]],
        })
    }

    /// Column and row of a point of the plane.
    #[inline(always)]
    fn place<L: Lanes>(&self, v: &[L::F; 2]) -> [L::F; 2] {
        let splat = L::F::splat;
        array(
            #[inline(always)]
            |a| splat(self.factor[a]).mul_add(v[a], splat(self.first[a])),
        )
    }

    /// Red, green, blue and alpha at a point of the plane within the table's ranges; beyond them those of the edge.
    #[inline(always)]
    pub fn texel<L: Lanes>(&self, v: &[L::F; 2]) -> [L::F; 4] {
        let splat = L::F::splat;
        let (zero, one) = (splat(0.0), splat(1.0));
        let place = self.place::<L>(v);
        let at: [L::F; 2] = array(
            #[inline(always)]
            |a| place[a].max(zero).min(splat(self.last[a])),
        );
        let low: [L::F; 2] = array(
            #[inline(always)]
            |a| at[a].floor().min(splat((self.last[a] - 1.0).max(0.0))),
        );
        let high: [L::F; 2] = array(
            #[inline(always)]
            |a| (low[a] + one).min(splat(self.last[a])),
        );
        let columns = L::U::splat(self.last[0] as u32 + 1);
        let mix = inlined(
            #[inline(always)]
            |a: [L::F; 4], b: [L::F; 4], share: L::F| -> [L::F; 4] {
                array(
                    #[inline(always)]
                    |c| share.mul_add(b[c] - a[c], a[c]),
                )
            },
        );
        let texel = inlined(
            #[inline(always)]
            |j: L::F, i: L::F| L::F::gather_parts(&self.texels, j.to_unsigned() * columns + i.to_unsigned()),
        );
        let [x, y] = [at[0] - low[0], at[1] - low[1]];
        let above = mix(texel(low[1], low[0]), texel(low[1], high[0]), x);
        let below = mix(texel(high[1], low[0]), texel(high[1], high[0]), x);
        mix(above, below, y)
    }
}
