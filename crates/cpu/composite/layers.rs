//! Colours and opacities of the segments of some rows, front to back, where some of them wait for their colour.

use crate::composite::rows::Rows;
use crate::fragments::batch::Batch;
use crate::project::record::TILE;
use crate::shade::shaded::Shaded;
use voltet_simd::LaneSet;

/// Row by row, slice by slice, the pixels of the row side by side.
#[derive(Default)]
pub(crate) struct Layers {
    columns: [Vec<f32>; 4],
    /// Rows that wait, each with the place of its first segment; a row may come again.
    rows: Vec<(usize, usize)>,
}

/// Segments that wait at most before a further row may begin: what is more leaves the second-level cache.
const MANY: usize = 1 << 13;

impl Layers {
    /// Whether a row waits.
    pub fn holds(&self, row: usize) -> bool {
        self.rows.iter().any(|(waiting, _)| *waiting == row)
    }

    /// Whether so many segments wait that they are best blended.
    pub fn are_many(&self) -> bool {
        self.columns[0].len() >= MANY
    }

    /// The row of a place.
    pub fn row_of(&self, place: usize) -> usize {
        let behind = self.rows.partition_point(|(_, first)| *first <= place);
        self.rows[behind - 1].0
    }

    /// Takes the first `count` segments of a batch, slices of a row; those of no length are clear. Returns the place of the first.
    pub fn take(&mut self, row: usize, batch: &Batch, shaded: &Shaded, count: usize) -> usize {
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

    /// Gives the segment at a place its colour and opacity.
    pub fn set(&mut self, place: usize, rgba: [f32; 4]) {
        self.columns.iter_mut().zip(rgba).for_each(|(column, value)| column[place] = value);
    }

    /// Blends all into their rows; none is left.
    pub fn end(&mut self, lanes: LaneSet, rows: &mut Rows) {
        debug_assert!(self.columns[0].len().is_multiple_of(TILE), "whole slices");
        let last = self.columns[0].len();
        for (k, &(row, first)) in self.rows.iter().enumerate() {
            let end = self.rows.get(k + 1).map_or(last, |(_, next)| *next);
            rows.blend(lanes, row, self.columns.each_ref().map(|column| &column[first..end]));
        }
        self.rows.clear();
        self.columns.iter_mut().for_each(Vec::clear);
    }
}
