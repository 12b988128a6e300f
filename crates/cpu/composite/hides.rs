//! Whether so much of a picture is hidden that cells are best taken from front to back ([`super::slabs`]): the first tiles tell, drawn
//! as they come. All others wait for their answer, so that no picture depends on which worker was first.

use crate::project::record::TILE;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Tiles that tell.
const SAMPLED: usize = 4;

/// Share of their segments that must be hidden: ordering a tile's cells costs about as much as shading a third of them.
const HIDDEN_LEAST: f64 = 0.75;

/// Segments of a pixel and slab: as many as are shaded at a time.
const SLAB: f64 = 16.0;

/// Slabs of a tile at most.
const SLABS_MOST: f64 = 8.0;

/// What the first tiles tell.
pub(crate) struct Hides {
    sampled: usize,
    told: AtomicUsize,
    segments: AtomicUsize,
    hidden: AtomicUsize,
}

/// A tile that will tell; dropped, it has told nothing.
pub(crate) struct Sampled<'a>(&'a Hides);

impl Hides {
    /// `asks`: whether anything may be hidden at all.
    pub fn new(asks: bool, tiles: usize) -> Hides {
        let sampled = if asks && SAMPLED < tiles { SAMPLED } else { 0 };
        Hides {
            sampled,
            told: AtomicUsize::new(0),
            segments: AtomicUsize::new(0),
            hidden: AtomicUsize::new(0),
        }
    }

    /// The tile of this place in the queue, if it is one that tells.
    pub fn sample(&self, place: usize) -> Option<Sampled<'_>> {
        (place < self.sampled).then_some(Sampled(self))
    }

    /// In how many slabs the cells of the tile of this place are taken from front to back, 1 where they are taken as they come; none
    /// where the run is `cancelled`.
    pub fn answer(&self, place: usize, cancelled: impl Fn() -> bool) -> Option<usize> {
        if self.sampled == 0 || place < self.sampled {
            return Some(1);
        }
        while self.told.load(Ordering::Acquire) < self.sampled {
            if cancelled() {
                return None;
            }
            std::thread::yield_now();
        }
        let [segments, hidden] =
            [&self.segments, &self.hidden].map(|count| count.load(Ordering::Relaxed) as f64);
        let of_pixel = segments / (self.sampled * TILE * TILE) as f64;
        let slabs = (of_pixel / SLAB).clamp(1.0, SLABS_MOST) as usize;
        Some(if HIDDEN_LEAST * segments < hidden { slabs } else { 1 })
    }
}

impl Sampled<'_> {
    /// Some segments of the tile, and those of them that are hidden.
    pub fn tell(self, [segments, hidden]: [usize; 2]) {
        self.0.segments.fetch_add(segments, Ordering::Relaxed);
        self.0.hidden.fetch_add(hidden, Ordering::Relaxed);
    }
}

impl Drop for Sampled<'_> {
    fn drop(&mut self) {
        self.0.told.fetch_add(1, Ordering::Release);
    }
}
