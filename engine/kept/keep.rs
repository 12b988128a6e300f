//! A tile's segments from its lists.

use crate::composite::lists::{Lists, Overflow};
use crate::composite::sinks::Sink;
use crate::fragments::batch::{BATCH, Batch};
use crate::kept::KeptTile;
use crate::project::record::TILE;
use crate::shade::shaded::Shaded;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use voltet_lanes::LaneSet;

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

/// Sorts a tile's segments in lists; their numbers stand where colours would.
pub(crate) struct Keeper<'a> {
    lists: &'a mut Lists,
    numbers: Shaded,
    /// Batch by batch: lengths, entries' and exits' values.
    batches: Vec<f32>,
    /// Columns of a batch.
    columns: usize,
}

impl<'a> Keeper<'a> {
    /// `lists`: empty.
    pub fn new(lists: &'a mut Lists, scalar_count: usize) -> Keeper<'a> {
        Keeper { lists, numbers: Shaded::new(), batches: Vec::new(), columns: 1 + 2 * scalar_count }
    }

    /// What was taken, in order. `None` where it is too much.
    pub fn end(self, lanes: LaneSet, keeping: &Keeping) -> Option<KeptTile> {
        let Keeper { lists, batches, columns, .. } = self;
        let slices: usize = (0..TILE).map(|row| lists.deepest(row)).sum();
        let count = slices * columns * TILE;
        if !keeping.take((count * size_of::<f32>()) as u64) {
            return None;
        }
        let mut kept = KeptTile { begins: [0; TILE + 1], numbers: vec![0.0; count] };
        let mut at = 0;
        for row in 0..TILE {
            kept.begins[row] = at as u32;
            lists.in_order(lanes, row, |depth, x, number| {
                let from = number as usize / BATCH * BATCH * columns + number as usize % BATCH;
                let to = (at + depth) * columns * TILE + x;
                for column in 0..columns {
                    kept.numbers[to + column * TILE] = batches[from + column * BATCH];
                }
            });
            at += lists.deepest(row);
        }
        kept.begins[TILE] = at as u32;
        Some(kept)
    }
}

impl Sink for Keeper<'_> {
    fn take(
        &mut self,
        lanes: LaneSet,
        batch: &Batch,
        _shaded: &Shaded,
        count: usize,
    ) -> Result<(), Overflow> {
        let first = self.batches.len() / self.columns;
        for (k, number) in self.numbers.rgba[0].iter_mut().enumerate() {
            *number = f32::from_bits((first + k) as u32);
        }
        self.batches.extend_from_slice(&**batch.length);
        for columns in [&batch.front, &batch.back] {
            columns[..batch.scalar_count].iter().for_each(|column| self.batches.extend_from_slice(&**column));
        }
        Sink::take(self.lists, lanes, batch, &self.numbers, count)
    }

    fn wants_colors(&self) -> bool {
        false
    }
}
