//! Segments in lanes: their lengths and the values at both ends, loaded side by side or gathered from a batch.

use crate::fragments::batch::{Batch, Column, MAX_LANES};
use voltet_simd::{Float, Lanes, array, inlined};

/// One vector of segments of a batch. Lengths in scene lengths, attributes scaled.
pub struct SegmentLanes<L: Lanes> {
    /// D.
    pub length: L::F,
    /// Lanes that cross their cell over a positive length, or a selection of them.
    pub crossing: L::M,
    /// (s, g) at the entry; g is 0 where there is none.
    pub front: [L::F; 2],
    /// (s, g) at the exit.
    pub back: [L::F; 2],
}

impl<L: Lanes> SegmentLanes<L> {
    #[inline(always)]
    pub(crate) fn load(batch: &Batch, at: usize) -> Self {
        let column = inlined!(|columns: &[Column], a: usize| match columns[..batch.scalar_count].get(a) {
            Some(column) => L::F::load(&column[at..]),
            None => L::F::splat(0.0),
        });
        let length = L::F::load(&batch.length[at..]);
        SegmentLanes {
            length,
            crossing: L::F::splat(0.0).lt(length),
            front: [column(&batch.front, 0), column(&batch.front, 1)],
            back: [column(&batch.back, 0), column(&batch.back, 1)],
        }
    }

    /// The segments with other lanes counted as those that cross.
    #[inline(always)]
    pub fn only(&self, crossing: L::M) -> Self {
        SegmentLanes { crossing, ..*self }
    }

    /// Values at one fraction of every segment, from its nearer end.
    #[inline(always)]
    pub(crate) fn at_share(&self, t: f32) -> [L::F; 2] {
        between::<L, 2>(&self.front, &self.back, t)
    }

    #[inline(always)]
    pub(crate) fn at(&self, t: L::F) -> [L::F; 2] {
        array!(|i| (self.back[i] - self.front[i]).mul_add(t, self.front[i]))
    }
}

/// Linear between the ends, from the nearer one.
#[inline(always)]
fn between<L: Lanes, const N: usize>(front: &[L::F; N], back: &[L::F; N], t: f32) -> [L::F; N] {
    let (from, step) = if t > 0.5 { (back, t - 1.0) } else { (front, t) };
    array!(|i| (back[i] - front[i]).mul_add(L::F::splat(step), from[i]))
}

/// Further fields of one vector of segments, at the entry and at the exit.
pub struct FieldLanes<L: Lanes> {
    pub(crate) front: [L::F; MAX_FIELD_LANES],
    pub(crate) back: [L::F; MAX_FIELD_LANES],
}

impl<L: Lanes> FieldLanes<L> {
    /// No fields.
    #[inline(always)]
    pub fn none() -> Self {
        let zeros = [L::F::splat(0.0); MAX_FIELD_LANES];
        FieldLanes { front: zeros, back: zeros }
    }

    /// Fields of a batch; 0 for missing ones.
    #[inline(always)]
    pub(crate) fn load(batch: &Batch, at: usize) -> Self {
        let rows = inlined!(|columns: &[Column]| -> [L::F; MAX_FIELD_LANES] {
            array!(|i| match columns[..batch.scalar_count].get(2 + i) {
                Some(column) => L::F::load(&column[at..]),
                None => L::F::splat(0.0),
            })
        });
        FieldLanes { front: rows(&batch.front), back: rows(&batch.back) }
    }

    /// Values at one fraction of every segment.
    #[inline(always)]
    pub(crate) fn at(&self, t: f32) -> [L::F; MAX_FIELD_LANES] {
        between::<L, MAX_FIELD_LANES>(&self.front, &self.back, t)
    }
}

/// Further fields that lanes read at most.
pub(crate) const MAX_FIELD_LANES: usize = 8;

/// Lengths, then the attributes at the entry and at the exit.
pub(crate) struct SegmentGather {
    length: [f32; MAX_LANES],
    front: [[f32; MAX_LANES]; 2 + MAX_FIELD_LANES],
    back: [[f32; MAX_LANES]; 2 + MAX_FIELD_LANES],
    columns: usize,
}

impl SegmentGather {
    pub fn new(columns: usize) -> SegmentGather {
        let rows = [[0.0; MAX_LANES]; 2 + MAX_FIELD_LANES];
        SegmentGather { length: [0.0; MAX_LANES], front: rows, back: rows, columns: columns.min(rows.len()) }
    }

    /// Takes the segments `group` of a batch, one a lane.
    #[inline(always)]
    pub fn take(&mut self, batch: &Batch, group: &[usize]) {
        // Lanes without a segment have no length.
        self.length = [0.0; MAX_LANES];
        for (lane, &k) in group.iter().enumerate() {
            self.length[lane] = batch.length[k];
            for a in 0..self.columns {
                self.front[a][lane] = batch.front[a][k];
                self.back[a][lane] = batch.back[a][k];
            }
        }
    }

    #[inline(always)]
    pub fn segments<L: Lanes>(&self) -> SegmentLanes<L> {
        let row = |rows: &[[f32; MAX_LANES]; 2 + MAX_FIELD_LANES], a: usize| L::F::load(&rows[a]);
        let length = L::F::load(&self.length);
        SegmentLanes {
            length,
            crossing: L::F::splat(0.0).lt(length),
            front: [row(&self.front, 0), row(&self.front, 1)],
            back: [row(&self.back, 0), row(&self.back, 1)],
        }
    }

    #[inline(always)]
    pub fn fields<L: Lanes>(&self) -> FieldLanes<L> {
        FieldLanes {
            front: array!(|i| L::F::load(&self.front[2 + i])),
            back: array!(|i| L::F::load(&self.back[2 + i])),
        }
    }
}
