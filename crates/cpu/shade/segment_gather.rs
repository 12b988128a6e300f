//! Segments of a batch, gathered side by side.

use crate::fragments::batch::{Batch, MAX_LANES};
use crate::shade::segment_lanes::{FieldLanes, MAX_FIELD_LANES, SegmentLanes};
use voltet_simd::{Float, Lanes, array};

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
