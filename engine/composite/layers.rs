//! Colours and opacities of the segments of some rows, front to back, where some of them wait for their colour.

use crate::composite::rows::Rows;
use crate::fragments::batch::Batch;
use crate::project::record::TILE;
use crate::shade::shaded::Shaded;
use voltet_lanes::LaneSet;

/// Row by row, slice by slice, the pixels of the row side by side.
#[derive(Default)]
pub(crate) struct Layers {
    columns: [Vec<f32>; 4],
    /// Rows that wait, each with the place of its first segment.
    rows: Vec<(usize, usize)>,
}

/// Segments that wait at most before a further row may begin: what is more leaves the second-level cache.
const MANY: usize = 1 << 13;

impl Layers {
    /// Whether a row waits.
    pub fn holds(&self, row: usize) -> bool {
        self.rows.last().is_some_and(|(last, _)| *last == row)
    }

    /// Whether so many segments wait that they are best blended.
    pub fn are_many(&self) -> bool {
        self.columns[0].len() >= MANY
    }

    /// Begins a row.
    pub fn begin(&mut self, row: usize) {
        self.rows.push((row, self.columns[0].len()));
    }

    /// Whether a place is one of the row that began last.
    pub fn is_of_last_row(&self, place: usize) -> bool {
        self.rows.last().is_some_and(|(_, first)| *first <= place)
    }

    /// Takes the first `count` segments of a batch; those of no length are clear. Returns the place of the first.
    pub fn take(&mut self, batch: &Batch, shaded: &Shaded, count: usize) -> usize {
        let first = self.columns[0].len();
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
        let mut end = self.columns[0].len();
        for (row, first) in self.rows.drain(..).rev() {
            rows.blend(lanes, row, self.columns.each_ref().map(|column| &column[first..end]));
            end = first;
        }
        self.columns.iter_mut().for_each(Vec::clear);
    }
}
