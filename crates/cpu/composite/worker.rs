//! One worker: takes tiles, the fullest first, until none is left. Of large grids it takes windows, projects the cells of one and draws
//! its tiles.

use crate::cells::Counts;
use crate::composite::front_to_back::Shading;
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

/// Reports of progress for a picture, about.
const REPORTS: usize = 64;

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

/// One worker: takes tiles or windows until none is left.
pub(crate) struct Worker<'a> {
    pub frame: &'a Frame<'a>,
    pub work: &'a Work<'a>,
    pub next: &'a AtomicUsize,
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
                while let Some(&tile) = self.take(queue)
                    && self.draw(frame, tile, &mut desk)
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

    /// The next item of a list.
    fn take<'t, T>(&self, list: &'t [T]) -> Option<&'t T> {
        let number = self.next.fetch_add(1, Ordering::Relaxed);
        let item = list.get(number)?;
        if number.is_multiple_of((list.len() / REPORTS).max(1)) {
            self.progress.report("composite", number as f64 / list.len() as f64);
        }
        Some(item)
    }

    fn draw_windows(&self, windows: &[Window], desk: &mut Desk) -> Fallible<()> {
        let mut tiles = self.frame.spare().tiles.take();
        while let Some(window) = self.take(windows) {
            self.frame.project(window, &mut tiles)?;
            let frame = self.frame.within(&tiles);
            for tile in tiles.queue(frame.tiles_wide).into_iter().filter(|&tile| frame.draws(tile)) {
                if !self.draw(&frame, tile, desk) {
                    return Ok(());
                }
            }
        }
        self.frame.spare().tiles.put(tiles);
        Ok(())
    }

    /// Draws a tile. Returns true if the run goes on.
    fn draw(&self, frame: &Frame<'_>, tile: u32, desk: &mut Desk) -> bool {
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
        draw_tile(frame, tile as usize, scratch, lists, &mut picture);
        done.push((tile, picture));
        true
    }
}
