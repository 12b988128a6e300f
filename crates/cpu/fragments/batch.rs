//! Batch of fragments, from the intersection to the shader, and its clipping at depth limits: rays that end within the grid, at opaque
//! surfaces of another renderer.

use crate::tile::{PIXELS, TILE};
use std::ops::{Deref, DerefMut};
use voltet_simd::{Lanes, Mask};

/// Lanes of the widest lane set.
pub(crate) const MAX_LANES: usize = 16;
/// Fragments evaluated at a time: their arrays stay in the first-level cache.
pub(crate) const BATCH: usize = 256;

/// A number for each fragment of a batch, aligned to cache lines, so that no vector straddles two.
#[derive(Clone, Copy)]
#[repr(align(64))]
pub(crate) struct Column<T = f32>([T; BATCH]);

impl<T: Copy + Default> Column<T> {
    /// On the heap.
    pub fn new() -> Box<Self> {
        Box::new(Column::default())
    }
}

impl<T: Copy + Default> Default for Column<T> {
    fn default() -> Self {
        Column([T::default(); BATCH])
    }
}

impl<T> Deref for Column<T> {
    type Target = [T; BATCH];
    #[inline(always)]
    fn deref(&self) -> &[T; BATCH] {
        &self.0
    }
}

impl<T> DerefMut for Column<T> {
    #[inline(always)]
    fn deref_mut(&mut self) -> &mut [T; BATCH] {
        &mut self.0
    }
}

/// Batch of fragments. Lengths in scene lengths; attributes scaled.
pub(crate) struct Batch {
    /// Pixel of the tile, row << 4 | column.
    pub pixel: Box<Column<u32>>,
    /// Fragments that cross their cell over a positive length.
    pub hits: u32,
    /// D; 0 where the ray misses the cell.
    pub length: Box<Column>,
    /// Depth of the entry from the distance origin (orders segments; × stretch = distance).
    pub entry: Box<Column>,
    pub exit: Box<Column>,
    /// Values at the entry, attribute by attribute.
    pub front: Vec<Column>,
    /// Values at the exit.
    pub back: Vec<Column>,
    /// Attributes that widgets read; behind them comes the gradient.
    pub scalar_count: usize,
}

impl Batch {
    pub fn new(attribute_count: usize, scalar_count: usize) -> Self {
        Batch {
            pixel: Column::new(),
            hits: 0,
            length: Column::new(),
            entry: Column::new(),
            exit: Column::new(),
            front: vec![Column::default(); attribute_count],
            back: vec![Column::default(); attribute_count],
            scalar_count,
        }
    }

    /// Moves a slice to another first slot.
    pub fn move_slice(&mut self, from: usize, to: usize) {
        self.pixel.copy_within(from..from + TILE, to);
        let columns = [&mut *self.length, &mut *self.entry, &mut *self.exit];
        for column in columns.into_iter().chain(&mut self.front).chain(&mut self.back) {
            column.copy_within(from..from + TILE, to);
        }
    }
}

/// Lanes (bits) of a mask that hold the first `count` fragments; those past the end of the batch are fragments of the next one.
#[inline(always)]
pub(crate) fn meant<L: Lanes>(mask: L::M, count: usize) -> u32 {
    mask.bits() & u32::MAX >> (32 - count.min(L::WIDTH))
}

/// Depth at which the ray of each of a tile's pixels ends (scene lengths from the distance origin); infinite where nothing ends it.
pub(crate) type DepthLimits = [f32; PIXELS];

/// Clips the first `count` segments of a batch at the depth limits of their rays. Along a ray depths and attributes are linear, so a
/// fraction of the one is a fraction of the other.
pub(crate) fn clip_to_depth(batch: &mut Batch, count: usize, attribute_count: usize, limits: &DepthLimits) {
    for k in 0..count {
        let limit = limits[batch.pixel[k] as usize % PIXELS];
        let (entry, exit) = (batch.entry[k], batch.exit[k]);
        if exit <= limit {
            continue;
        }
        let fraction = ((limit - entry) / (exit - entry)).max(0.0);
        batch.length[k] *= fraction;
        batch.exit[k] = limit;
        for a in 0..attribute_count {
            let front = batch.front[a][k];
            batch.back[a][k] = front + fraction * (batch.back[a][k] - front);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_segment_ends_where_its_ray_does_and_keeps_what_it_is_before() {
        let mut batch = Batch::new(1, 1);
        let mut limits = [f32::INFINITY; PIXELS];
        limits[7] = 2.5;
        for (k, (pixel, entry, exit)) in
            [(7, 2.0, 3.0), (7, 3.0, 4.0), (7, 1.0, 2.0), (8, 2.0, 3.0)].into_iter().enumerate()
        {
            (batch.pixel[k], batch.entry[k], batch.exit[k]) = (pixel, entry, exit);
            (batch.length[k], batch.front[0][k], batch.back[0][k]) = (1.5, 10.0, 20.0);
        }
        clip_to_depth(&mut batch, 4, 1, &limits);
        assert_eq!([0, 1, 2, 3].map(|k| batch.length[k]), [0.75, 0.0, 1.5, 1.5]);
        assert_eq!([0, 2, 3].map(|k| batch.back[0][k]), [15.0, 20.0, 20.0]);
        assert_eq!([0, 2, 3].map(|k| batch.exit[k]), [2.5, 2.0, 3.0]);
    }
}
