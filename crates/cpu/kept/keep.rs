//! A tile's segments, kept.

use crate::fragments::batch::Batch;
use crate::kept::KeptTile;
use crate::project::record::TILE;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// What all who keep a picture's segments share.
#[derive(Debug)]
pub(crate) struct Keeping {
    /// Bytes that may still be kept.
    left: AtomicU64,
    /// Whether they were too many, or a pixel's were.
    given_up: AtomicBool,
}

impl Keeping {
    /// `limit`: bytes.
    pub fn new(limit: u64) -> Keeping {
        Keeping { left: AtomicU64::new(limit), given_up: AtomicBool::new(false) }
    }

    pub fn is_given_up(&self) -> bool {
        self.given_up.load(Ordering::Relaxed)
    }

    pub fn give_up(&self) {
        self.given_up.store(true, Ordering::Relaxed);
    }

    /// Takes so many bytes of what may be kept; gives up where there are none.
    fn take(&self, bytes: u64) -> bool {
        let less = |left: u64| left.checked_sub(bytes);
        let taken = self.left.fetch_update(Ordering::Relaxed, Ordering::Relaxed, less).is_ok();
        if !taken {
            self.give_up();
        }
        taken
    }
}

/// Takes a tile's segments in order.
pub(crate) struct Keeper {
    kept: KeptTile,
    scalar_count: usize,
}

impl Keeper {
    pub fn new(scalar_count: usize) -> Keeper {
        Keeper { kept: KeptTile { begins: [0; TILE + 1], numbers: Vec::new() }, scalar_count }
    }

    /// Takes the first `count` segments of a batch, slices of a row.
    pub fn take(&mut self, row: usize, batch: &Batch, count: usize) {
        let columns = || {
            let ends = batch.front[..self.scalar_count].iter().chain(&batch.back[..self.scalar_count]);
            std::iter::once(&*batch.length).chain(ends)
        };
        for at in (0..count).step_by(TILE) {
            for column in columns() {
                self.kept.numbers.extend_from_slice(&column[at..][..TILE]);
            }
        }
        let slices = (count / TILE) as u32;
        self.kept.begins[row + 1..].iter_mut().for_each(|begin| *begin += slices);
    }

    /// What was taken. `None` where it is too much.
    pub fn end(self, keeping: &Keeping) -> Option<KeptTile> {
        let Keeper { mut kept, .. } = self;
        let bytes = kept.numbers.len() * size_of::<f32>();
        kept.numbers.shrink_to_fit();
        keeping.take(bytes as u64).then_some(kept)
    }
}
