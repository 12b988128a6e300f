//! What a worker draws a tile with, and where the tile is.

use crate::cast::bundle::WAYS;
use crate::cast::entered::Entered;
use crate::composite::front_to_back::Shading;
use crate::composite::worker::WorkerCounts;
use crate::fragments::batch::{Batch, LANES_MOST};
use crate::fragments::crossing::Group;
use crate::fragments::spans::{Edges, Fragments};
use crate::project::record::TILE;
use crate::sample::Frame;
use crate::shade::light::rays;

/// Scratch of one worker.
pub(crate) struct Scratch {
    pub fragments: Fragments,
    pub edges: Edges,
    pub group: Group,
    pub stretch: [f32; TILE * TILE],
    pub shading: Shading,
    /// Where rays go from cell to cell: where they come in, and segments of bundles beside the first.
    pub entered: Entered,
    pub further: [Batch; WAYS - 1],
    pub counts: WorkerCounts,
}

impl Scratch {
    pub fn new(frame: &Frame<'_>) -> Scratch {
        Scratch {
            fragments: Fragments::new(LANES_MOST),
            edges: Edges::new(),
            group: Group::new(frame.attribute_count),
            stretch: [1.0; TILE * TILE],
            shading: Shading::new(frame),
            entered: Entered::default(),
            further: std::array::from_fn(|_| Batch::new(frame.attribute_count, frame.scalar_count)),
            counts: WorkerCounts::default(),
        }
    }

    /// Makes ready what is known of a tile's rays.
    pub fn begin(&mut self, frame: &Frame<'_>, Bounds { left, top, .. }: Bounds) {
        if frame.view.perspective {
            for (pixel, stretch) in self.stretch.iter_mut().enumerate() {
                *stretch =
                    frame.view.stretch((left + pixel % TILE) as f64, (top + pixel / TILE) as f64) as f32;
            }
        }
        let Shading { rays: of_tile, ends, .. } = &mut self.shading;
        if frame.shader.surface.is_some_and(|surface| surface.silhouette.is_some()) {
            rays(&frame.view, left, top, of_tile);
        }
        frame.ends_of(left, top, ends);
    }
}

/// A tile's place in the picture.
#[derive(Clone, Copy)]
pub(crate) struct Bounds {
    pub tile: usize,
    pub left: usize,
    pub top: usize,
    /// Columns and rows that are in the picture.
    pub size: [usize; 2],
}

impl Bounds {
    pub fn of(frame: &Frame<'_>, tile: usize) -> Bounds {
        let (left, top) = (tile % frame.tiles_wide * TILE, tile / frame.tiles_wide * TILE);
        let [width, height] = frame.view.size;
        Bounds { tile, left, top, size: [TILE.min(width - left), TILE.min(height - top)] }
    }
}
