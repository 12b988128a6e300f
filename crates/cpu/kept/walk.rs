//! Kept segments, slices of a row at a time.

use crate::fragments::batch::{BATCH, Batch};
use crate::kept::KeptTile;
use crate::project::record::TILE;

/// Slices of a batch.
const AT_ONCE: usize = BATCH / TILE;

/// The slices of a row of a tile, as many at a time as a batch takes.
pub(crate) struct KeptSlices<'a> {
    numbers: &'a [f32],
    columns: usize,
    /// Segments that were taken.
    pub segments: u64,
}

impl KeptTile {
    /// Those of a row.
    pub fn slices(&self, row: usize, scalar_count: usize) -> KeptSlices<'_> {
        let columns = 1 + 2 * scalar_count;
        let [from, to] = [row, row + 1].map(|row| self.begins[row] as usize * columns * TILE);
        KeptSlices { numbers: &self.numbers[from..to], columns, segments: 0 }
    }
}

impl KeptSlices<'_> {
    /// Fills a batch; its fragments, none at the end.
    pub fn next(&mut self, batch: &mut Batch) -> usize {
        let of_slice = self.columns * TILE;
        let some = self.numbers.len().min(AT_ONCE * of_slice);
        let (now, later) = self.numbers.split_at(some);
        self.numbers = later;
        let scalar_count = batch.scalar_count;
        let columns = std::iter::once(&mut *batch.length)
            .chain(&mut batch.front[..scalar_count])
            .chain(&mut batch.back[..scalar_count]);
        for (number, column) in columns.enumerate() {
            for (to, slice) in column.chunks_exact_mut(TILE).zip(now.chunks_exact(of_slice)) {
                to.copy_from_slice(&slice[number * TILE..][..TILE]);
            }
        }
        let count = some / self.columns;
        self.segments += batch.length[..count].iter().filter(|length| **length > 0.0).count() as u64;
        count
    }
}
