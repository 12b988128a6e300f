//! Batch of fragments, from the intersection to the shader.

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
    /// Depth of the exit.
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
}

/// Lanes (bits) of a mask that hold the first `count` fragments; those past the end of the batch are fragments of the next one.
#[inline(always)]
pub(crate) fn meant<L: Lanes>(mask: L::M, count: usize) -> u32 {
    mask.bits() & u32::MAX >> (32 - count.min(L::WIDTH))
}
