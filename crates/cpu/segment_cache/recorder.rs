//! Recorder of a tile's segments.

use super::tile::CachedTile;
use crate::fragments::batch::Batch;
use crate::tile::TILE;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// Memory budget of a segment cache, shared by the workers that record.
#[derive(Debug)]
pub(crate) struct CacheBudget {
    /// Bytes that remain.
    remaining: AtomicU64,
    /// True if the segments were too many, or those of a pixel.
    exhausted: AtomicBool,
}

impl CacheBudget {
    /// `limit`: bytes.
    pub fn new(limit: u64) -> CacheBudget {
        CacheBudget { remaining: AtomicU64::new(limit), exhausted: AtomicBool::new(false) }
    }

    pub fn is_exhausted(&self) -> bool {
        self.exhausted.load(Ordering::Relaxed)
    }

    pub fn exhaust(&self) {
        self.exhausted.store(true, Ordering::Relaxed);
    }

    /// Takes bytes of the budget. Returns false, and exhausts it, where they are too many.
    fn take(&self, bytes: u64) -> bool {
        let less = |remaining: u64| remaining.checked_sub(bytes);
        let taken = self.remaining.fetch_update(Ordering::Relaxed, Ordering::Relaxed, less).is_ok();
        if !taken {
            self.exhaust();
        }
        taken
    }
}

/// Recorder of a tile's segments, in order.
pub(crate) struct TileRecorder {
    tile: CachedTile,
    scalar_count: usize,
}

impl TileRecorder {
    pub fn new(scalar_count: usize) -> TileRecorder {
        TileRecorder { tile: CachedTile { begins: [0; TILE + 1], numbers: Vec::new() }, scalar_count }
    }

    /// Takes the first `count` segments of a batch, slices of a row.
    pub fn take(&mut self, row: usize, batch: &Batch, count: usize) {
        let columns = || {
            let ends = batch.front[..self.scalar_count].iter().chain(&batch.back[..self.scalar_count]);
            std::iter::once(&*batch.length).chain(ends)
        };
        for at in (0..count).step_by(TILE) {
            for column in columns() {
                self.tile.numbers.extend_from_slice(&column[at..][..TILE]);
            }
        }
        let slices = (count / TILE) as u32;
        self.tile.begins[row + 1..].iter_mut().for_each(|begin| *begin += slices);
    }

    /// The recorded tile; `None` where the budget is exhausted.
    pub fn end(self, budget: &CacheBudget) -> Option<CachedTile> {
        let TileRecorder { mut tile, .. } = self;
        let bytes = tile.numbers.len() * size_of::<f32>();
        tile.numbers.shrink_to_fit();
        budget.take(bytes as u64).then_some(tile)
    }
}
