//! One worker: takes tiles, the fullest first, until none is left. Of large grids it takes windows, projects the cells of one and draws
//! its tiles.

use crate::cells::Counts;
use crate::composite::front_to_back::Shading;
use crate::composite::hides::Hides;
use crate::composite::lists::Lists;
use crate::composite::scratch::Scratch;
use crate::composite::sinks::TilePicture;
use crate::composite::tile::{cast_tile, draw_tile, keep_tile};
use crate::kept::KeptTile;
use crate::project::record::TILE;
use crate::project::windows::Window;
use crate::sample::Frame;
use std::sync::atomic::{AtomicUsize, Ordering};
use voltet_core::Result as Fallible;
use voltet_core::progress::Progress;

/// What one worker drew, with tiles' numbers, and its counts.
pub(crate) struct Drawn {
    pub tiles: Vec<(u32, Box<TilePicture>)>,
    /// Where segments were kept in place of drawing them.
    pub kept: Vec<(u32, KeptTile)>,
    /// Tiles with rays that were lost between cells: to be drawn from the cells.
    pub lost: Vec<u32>,
    pub counts: WorkerCounts,
}

/// Counts of one worker.
#[derive(Debug, Default, Clone, Copy)]
pub(crate) struct WorkerCounts {
    pub segments: u64,
    pub segments_exact: u64,
    pub evaluations: u64,
    pub segments_overlapping: u64,
    pub tiles_deep: u64,
    pub tiles_sorted: u64,
    pub pixels_disordered: u64,
    pub tiles_stopped: u64,
    pub cells_hidden: u64,
}

impl WorkerCounts {
    /// Adds them to a picture's.
    pub fn add_to(&self, counts: &mut Counts) {
        let WorkerCounts {
            segments,
            segments_exact,
            evaluations,
            segments_overlapping,
            tiles_deep,
            tiles_sorted,
            pixels_disordered,
            tiles_stopped,
            cells_hidden,
        } = *self;
        counts.segments += segments;
        counts.segments_exact += segments_exact;
        counts.evaluations += evaluations;
        counts.segments_overlapping += segments_overlapping;
        counts.tiles_deep += tiles_deep;
        counts.tiles_sorted += tiles_sorted;
        counts.pixels_disordered += pixels_disordered;
        counts.tiles_stopped += tiles_stopped;
        counts.cells_hidden += cells_hidden;
    }
}

/// What workers take.
pub(crate) enum Work<'a> {
    /// Tiles by their numbers, fullest first.
    Tiles(Vec<u32>),
    /// Windows whose cells are not projected yet.
    Windows(&'a [Window]),
}

impl Work<'_> {
    /// Tiles in all, empty ones of windows among them.
    pub fn tile_count(&self) -> usize {
        match self {
            Work::Tiles(queue) => queue.len(),
            Work::Windows(windows) => windows.iter().map(|window| window.area.tile_count()).sum(),
        }
    }
}

/// One worker: takes tiles or windows until none is left.
pub(crate) struct Worker<'a> {
    pub frame: &'a Frame<'a>,
    pub work: &'a Work<'a>,
    pub next: &'a AtomicUsize,
    /// Whether cells are taken from front to back.
    pub hides: &'a Hides,
    pub progress: &'a dyn Progress,
}

/// What a worker draws with, and what it drew.
struct Desk {
    scratch: Scratch,
    lists: Lists,
    done: Vec<(u32, Box<TilePicture>)>,
    kept: Vec<(u32, KeptTile)>,
    lost: Vec<u32>,
}

impl Worker<'_> {
    /// Draws until nothing is left. Returns the pictures with their tile numbers.
    ///
    /// Errors: more cells in a window than can be counted.
    pub fn run(self) -> Fallible<Drawn> {
        let frame = self.frame;
        let lists = frame.spare().lists.take();
        let mut desk = Desk {
            scratch: Scratch::new(frame),
            lists,
            done: Vec::new(),
            kept: Vec::new(),
            lost: Vec::new(),
        };
        match self.work {
            Work::Tiles(queue) => {
                while let Some((place, &tile)) = self.take(queue)
                    && self.draw(frame, tile, place, &mut desk)
                {}
            }
            Work::Windows(windows) => self.draw_windows(windows, &mut desk)?,
        }
        let Desk { mut scratch, lists, done, kept, lost } = desk;
        frame.spare().lists.put(lists);
        let Shading { shaded, pool, .. } = &scratch.shading;
        scratch.counts.segments_exact = shaded.exact_count + pool.shaded.exact_count;
        scratch.counts.evaluations = shaded.evaluation_count + pool.shaded.evaluation_count;
        scratch.counts.segments_overlapping = shaded.overlap_count;
        Ok(Drawn { tiles: done, kept, lost, counts: scratch.counts })
    }

    /// The next of a list, and its place there.
    fn take<'t, T>(&self, list: &'t [T]) -> Option<(usize, &'t T)> {
        let place = self.next.fetch_add(1, Ordering::Relaxed);
        list.get(place).map(|item| (place, item))
    }

    fn draw_windows(&self, windows: &[Window], desk: &mut Desk) -> Fallible<()> {
        let mut tiles = self.frame.spare().tiles.take();
        while let Some((_, window)) = self.take(windows) {
            let mut places = window.tiles_before..window.tiles_before + window.area.tile_count();
            let projected = self.frame.project(window, &mut tiles);
            if projected.is_ok() {
                let frame = self.frame.within(&tiles);
                for tile in tiles.queue(frame.tiles_wide).into_iter().filter(|&tile| frame.draws(tile)) {
                    if !places.next().is_some_and(|place| self.draw(&frame, tile, place, desk)) {
                        return Ok(());
                    }
                }
            }
            // The others may wait for what empty tiles, and those that are not drawn, tell: nothing.
            places.for_each(|place| drop(self.hides.sample(place)));
            projected?;
        }
        self.frame.spare().tiles.put(tiles);
        Ok(())
    }

    /// Draws a tile; whether the run goes on.
    fn draw(&self, frame: &Frame<'_>, tile: u32, place: usize, desk: &mut Desk) -> bool {
        if place.is_multiple_of(16) {
            self.progress.report("composite", place as f64 / self.work.tile_count() as f64);
        }
        if self.progress.cancelled() {
            return false;
        }
        let Desk { scratch, lists, done, kept, lost } = desk;
        if let Some(keeping) = frame.keeping {
            kept.extend(
                keep_tile(frame, tile as usize, scratch, lists, keeping).map(|segments| (tile, segments)),
            );
            return !keeping.is_given_up();
        }
        let mut picture = Box::new([[0.0; 4]; TILE * TILE]);
        if let Some(cast) = frame.cast {
            match cast_tile(frame, cast, tile as usize, scratch, &mut picture) {
                true => done.push((tile, picture)),
                false => lost.push(tile),
            }
            return true;
        }
        let sampled = self.hides.sample(place);
        let Some(slabs) = self.hides.answer(place, || self.progress.cancelled()) else { return false };
        let hidden = draw_tile(frame, tile as usize, slabs, scratch, lists, &mut picture);
        if let Some(sampled) = sampled {
            sampled.tell(hidden);
        }
        done.push((tile, picture));
        true
    }
}
