//! Cells of a tile from front to back, roughly, so that what is hidden is neither covered nor shaded: where a scene is opaque.
//!
//! Cells are put in order by the bins of their nearest depths and taken in slabs. Once the nearest depth of what is to come is
//! behind a segment's exit, all that may come is seen through that segment; pixels through which nothing is seen any more take
//! no further fragments.

use crate::composite::lists::UNSEEN;
use crate::fragments::batch::Column;
use crate::project::record::TILE;
use crate::sample::Frame;

/// Slabs of a tile.
const SLABS: usize = 16;
const BINS: usize = 256;

/// What is known of a tile while it is walked.
pub(crate) struct Slabs {
    /// Records of the tile, by bins.
    pub entries: Vec<u32>,
    /// Entries of a slab.
    pub length: usize,
    bins: Vec<u8>,
    /// bin = (depth − first) × scale.
    first: f32,
    scale: f32,
    /// The slab before which all segments that end in a bin are in front of what is to come.
    done_before: [u8; BINS],
    /// 1 − A of what is done before each slab, pixel by pixel.
    passes: Box<[[f32; TILE * TILE]; SLABS + 1]>,
    through: [f32; TILE * TILE],
    /// Pixels that take fragments, a bit a column.
    pub open: [u16; TILE],
}

impl Slabs {
    pub fn new() -> Slabs {
        Slabs {
            entries: Vec::new(),
            length: 1,
            bins: Vec::new(),
            first: 0.0,
            scale: 0.0,
            done_before: [0; BINS],
            passes: Box::new([[1.0; TILE * TILE]; SLABS + 1]),
            through: [1.0; TILE * TILE],
            open: [0; TILE],
        }
    }

    fn bin(&self, depth: f32) -> usize {
        // A cast from float saturates.
        usize::from(((depth - self.first) * self.scale) as u8)
    }

    /// Puts the cells of a tile in order. `size`: columns and rows of it that are in the picture.
    pub fn begin(&mut self, frame: &Frame<'_>, tile: usize, [columns, rows]: [usize; 2]) {
        let entries = frame.entries_of(tile);
        let nearest = || entries.iter().map(|&entry| frame.nearest(entry));
        let (low, high) = nearest()
            .fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), depth| (low.min(depth), high.max(depth)));
        let range = high - low;
        self.first = low;
        self.scale = if range > 0.0 { (BINS as f32 / range).min(f32::MAX) } else { 0.0 };
        self.bins.clear();
        self.bins.extend(nearest().map(|depth| ((depth - low) * self.scale) as u8));
        let mut next = [0usize; BINS + 1];
        self.bins.iter().for_each(|&bin| next[usize::from(bin) + 1] += 1);
        (0..BINS).for_each(|bin| next[bin + 1] += next[bin]);
        self.entries.resize(entries.len(), 0);
        for (&entry, &bin) in entries.iter().zip(&self.bins) {
            let place = &mut next[usize::from(bin)];
            self.entries[*place] = entry;
            *place += 1;
        }
        // Whole vectors of cells.
        let width = frame.lanes.width();
        self.length = entries.len().div_ceil(SLABS).next_multiple_of(width).max(4 * width);
        let begins: Vec<usize> =
            self.entries.iter().step_by(self.length).map(|&entry| self.bin(frame.nearest(entry))).collect();
        for (bin, slab) in self.done_before.iter_mut().enumerate() {
            *slab = begins.iter().position(|&begins| bin < begins).unwrap_or(SLABS) as u8;
        }
        self.passes.iter_mut().for_each(|passes| passes.fill(1.0));
        self.through.fill(1.0);
        let mask = ((1u32 << columns) - 1) as u16;
        for (row, open) in self.open.iter_mut().enumerate() {
            *open = if row < rows { mask } else { 0 };
        }
    }

    /// Takes in the opacities of segments.
    pub fn take(&mut self, pixel: &Column<u32>, exit: &Column, opacity: &Column, count: usize) {
        for ((&pixel, &exit), &opacity) in pixel.iter().zip(exit.iter()).zip(opacity.iter()).take(count) {
            let slab = usize::from(self.done_before[self.bin(exit)]).min(SLABS);
            self.passes[slab][pixel as usize % (TILE * TILE)] *= 1.0 - opacity;
        }
    }

    /// Before the slab of this number: closes pixels through which nothing of it is seen. Whether any is open.
    pub fn close(&mut self, slab: usize) -> bool {
        let mut any = 0;
        let passes = &self.passes[slab.min(SLABS)];
        for (row, open) in self.open.iter_mut().enumerate() {
            for x in 0..TILE {
                let through = &mut self.through[row * TILE + x];
                *through *= passes[row * TILE + x];
                // So much less that rounding never closes what the sum of the list would still show.
                *open &= !(u16::from(*through <= 0.5 * UNSEEN) << x);
            }
            any |= *open;
        }
        any != 0
    }
}
