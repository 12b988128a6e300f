//! Cells of a tile from front to back, roughly, so that what is hidden is neither covered nor put in order: where a scene is opaque.
//!
//! Cells are put in order by the bins of their nearest depths and taken in slabs. After each the segments that end before the nearest
//! of what is to come are blended; pixels through which nothing is seen then take no further fragments.

use crate::project::record::TILE;
use crate::sample::Frame;

const BINS: usize = 256;

/// Cells of a slab at least, in vectors.
const SLAB_LEAST: usize = 4;

/// A tile's cells in order.
#[derive(Default)]
pub(crate) struct Slabs {
    /// Records of the tile, by bins, and their nearest depths.
    entries: Vec<u32>,
    nearest: Vec<f32>,
    bins: Vec<u8>,
}

impl Slabs {
    /// Puts the cells of a tile in order.
    pub fn begin(&mut self, frame: &Frame<'_>, tile: usize) {
        let entries = frame.entries_of(tile);
        let depths = || entries.iter().map(|&entry| frame.nearest(entry));
        let (low, high) = depths()
            .fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), depth| (low.min(depth), high.max(depth)));
        let range = high - low;
        let scale = if range > 0.0 { (BINS as f32 / range).min(f32::MAX) } else { 0.0 };
        self.bins.clear();
        // A cast from float saturates.
        self.bins.extend(depths().map(|depth| ((depth - low) * scale) as u8));
        let mut next = [0usize; BINS + 1];
        self.bins.iter().for_each(|&bin| next[usize::from(bin) + 1] += 1);
        (0..BINS).for_each(|bin| next[bin + 1] += next[bin]);
        self.entries.resize(entries.len(), 0);
        self.nearest.resize(entries.len(), 0.0);
        for ((&entry, depth), &bin) in entries.iter().zip(depths()).zip(&self.bins) {
            let place = &mut next[usize::from(bin)];
            (self.entries[*place], self.nearest[*place]) = (entry, depth);
            *place += 1;
        }
    }

    /// Records in order.
    pub fn entries(&self) -> &[u32] {
        &self.entries
    }

    /// Where so many slabs end, whole vectors of `width` lanes, each with the nearest depth of what follows.
    pub fn ends(&self, slabs: usize, width: usize) -> Vec<(usize, f32)> {
        let all = self.entries.len();
        let length = all.div_ceil(slabs).next_multiple_of(width).max(SLAB_LEAST * width);
        let least = |depths: &[f32]| depths.iter().fold(f32::INFINITY, |least, depth| least.min(*depth));
        let mut nearest = f32::INFINITY;
        let mut ends: Vec<(usize, f32)> = (0..all)
            .step_by(length)
            .rev()
            .map(|from| {
                let end = (from + length).min(all);
                let behind = nearest;
                nearest = nearest.min(least(&self.nearest[from..end]));
                (end, behind)
            })
            .collect();
        ends.reverse();
        ends
    }
}

/// Pixels of a tile that take fragments, a bit a column.
pub(crate) type Open = [u16; TILE];

/// All pixels of a tile that are in the picture: so many columns and rows.
pub(crate) fn all_open([columns, rows]: [usize; 2]) -> Open {
    let mask = ((1u32 << columns.min(TILE)) - 1) as u16;
    std::array::from_fn(|row| if row < rows { mask } else { 0 })
}
