//! Deferred fragments: colours and opacities of the segments of some rows, front to back, some of which are not shaded yet.

use crate::composite::accumulators::TileAccumulator;
use crate::fragments::batch::Batch;
use crate::shade::shaded_batch::ShadedBatch;
use crate::tile::TILE;
use voltet_simd::LaneSet;

/// Row by row, slice by slice, the pixels of the row side by side.
#[derive(Default)]
pub(crate) struct DeferredFragments {
    columns: [Vec<f32>; 4],
    /// Deferred rows, each with the index of its first segment; a row may come again.
    rows: Vec<(usize, usize)>,
}

/// Deferred segments from which on they are blended before a further row begins: more leave the second-level cache.
const FLUSH_THRESHOLD: usize = 1 << 13;

impl DeferredFragments {
    /// True if a row is deferred.
    pub fn holds(&self, row: usize) -> bool {
        self.rows.iter().any(|(deferred, _)| *deferred == row)
    }

    /// True if so many segments are deferred that they are best blended.
    pub fn is_large(&self) -> bool {
        self.columns[0].len() >= FLUSH_THRESHOLD
    }

    /// Row of the segment with an index.
    pub fn row_of(&self, index: usize) -> usize {
        let behind = self.rows.partition_point(|(_, first)| *first <= index);
        self.rows[behind - 1].0
    }

    /// Takes the first `count` segments of a batch, slices of a row; those of no length are clear. Returns the index of the first.
    pub fn take(&mut self, row: usize, batch: &Batch, shaded: &ShadedBatch, count: usize) -> usize {
        let first = self.columns[0].len();
        if self.rows.last().is_none_or(|(last, _)| *last != row) {
            self.rows.push((row, first));
        }
        for (column, values) in self.columns.iter_mut().zip(&shaded.rgba) {
            let of_segment = |(value, length): (&f32, &f32)| if *length > 0.0 { *value } else { 0.0 };
            column.extend(values[..count].iter().zip(&batch.length[..count]).map(of_segment));
        }
        first
    }

    /// Sets colour and opacity of the segment with an index.
    pub fn set(&mut self, index: usize, rgba: [f32; 4]) {
        self.columns.iter_mut().zip(rgba).for_each(|(column, value)| column[index] = value);
    }

    /// Blends all segments into their rows; none remains.
    pub fn end(&mut self, lanes: LaneSet, pixels: &mut TileAccumulator) {
        debug_assert!(self.columns[0].len().is_multiple_of(TILE), "whole slices");
        let last = self.columns[0].len();
        for (k, &(row, first)) in self.rows.iter().enumerate() {
            let end = self.rows.get(k + 1).map_or(last, |(_, next)| *next);
            pixels.blend(lanes, row, self.columns.each_ref().map(|column| &column[first..end]));
        }
        self.rows.clear();
        self.columns.iter_mut().for_each(Vec::clear);
    }
}
