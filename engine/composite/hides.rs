//! Whether so much of a picture is hidden that cells are best taken from front to back ([`super::slabs`]): the first tiles tell, drawn
//! as they come. All others wait for their answer, so that no picture depends on which worker was first.

use std::sync::atomic::{AtomicUsize, Ordering};

/// Tiles that tell.
const SAMPLED: usize = 4;

/// Share of their segments that must be hidden: ordering a tile's cells costs about as much as shading a third of them.
const HIDDEN_LEAST: f64 = 0.6;

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

    /// Whether the cells of the tile of this place are taken from front to back; none where the run is `cancelled`.
    pub fn answer(&self, place: usize, cancelled: impl Fn() -> bool) -> Option<bool> {
        if self.sampled == 0 || place < self.sampled {
            return Some(false);
        }
        while self.told.load(Ordering::Acquire) < self.sampled {
            if cancelled() {
                return None;
            }
            std::thread::yield_now();
        }
        let [segments, hidden] =
            [&self.segments, &self.hidden].map(|count| count.load(Ordering::Relaxed) as f64);
        Some(HIDDEN_LEAST * segments < hidden)
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
