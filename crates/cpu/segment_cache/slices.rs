//! Cached segments, slices of a row at a time.

use super::tile::CachedTile;
use crate::fragments::batch::{BATCH, Batch};
use crate::tile::TILE;

/// Slices of a batch.
const SLICES_PER_BATCH: usize = BATCH / TILE;

/// Slices of a row of a tile, as many at a time as a batch takes.
pub(crate) struct CachedSlices<'a> {
    numbers: &'a [f32],
    columns: usize,
    /// Segments that were taken so far.
    pub segments: u64,
}

impl CachedTile {
    /// Slices of a row.
    pub fn slices(&self, row: usize, scalar_count: usize) -> CachedSlices<'_> {
        let columns = 1 + 2 * scalar_count;
        let [from, to] = [row, row + 1].map(|row| self.begins[row] as usize * columns * TILE);
        CachedSlices { numbers: &self.numbers[from..to], columns, segments: 0 }
    }
}

impl CachedSlices<'_> {
    /// Fills a batch; returns its fragments, none at the end.
    pub fn next(&mut self, batch: &mut Batch) -> usize {
        let of_slice = self.columns * TILE;
        let some = self.numbers.len().min(SLICES_PER_BATCH * of_slice);
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
