//! Worker: takes tiles, the fullest first, until none is left. Of large grids it takes regions, projects the cells of one and draws its
//! tiles.

use crate::composite::fragment_lists::FragmentLists;
use crate::composite::frame::{FrameContext, SegmentSource};
use crate::composite::row_shader::{RowShader, Scratch};
use crate::composite::stretches::{StretchRecorder, TileStretches};
use crate::composite::tile::{draw_cached, draw_cast, draw_projected, record_tile};
use crate::counts::Counts;
use crate::project::regions::Region;
use crate::project::tile_bins::TileBins;
use crate::segment_cache::{CacheBudget, CachedTile};
use crate::tile::{PIXELS, TilePicture, TileRect};
use std::sync::atomic::{AtomicUsize, Ordering};
use voltet_core::Result;
use voltet_core::progress::Progress;

/// Reports of progress for a picture, about.
const REPORTS: usize = 64;

/// Output of one worker: tiles with their numbers, and counts.
#[derive(Default)]
pub(crate) struct WorkerOutput {
    pub tiles: Vec<(u32, Box<TilePicture>)>,
    /// Tiles whose segments were recorded.
    pub cached: Vec<(u32, CachedTile)>,
    /// Stretches of each tile's rays, where they are recorded.
    pub stretches: Vec<(u32, TileStretches)>,
    /// Tiles in which rays were mistracked: to be drawn from projected cells.
    pub mistracked: Vec<u32>,
    pub counts: Counts,
}

impl WorkerOutput {
    /// Puts a tile that was drawn, or its stretches.
    fn put(&mut self, frame: &FrameContext<'_>, tile: u32, picture: Box<TilePicture>, scratch: &mut Scratch) {
        match &mut scratch.row_shader.recorder {
            None => self.tiles.push((tile, picture)),
            Some(recorder) => {
                let rect = TileRect::new(tile as usize, frame.view.size);
                self.stretches.push((tile, recorder.finish(frame, rect, &picture)));
            }
        }
    }
}

/// Worker: takes tiles or regions until none is left.
pub(crate) struct Worker<'a> {
    pub frame: &'a FrameContext<'a>,
    /// Next item of the queue that all workers share.
    pub next: &'a AtomicUsize,
    /// Budget of a segment cache: segments of projected cells are recorded in place of drawing them.
    pub recording: Option<&'a CacheBudget>,
    pub progress: &'a dyn Progress,
}

struct WorkerState {
    scratch: Scratch,
    lists: FragmentLists,
    output: WorkerOutput,
}

impl Worker<'_> {
    /// Draws until nothing is left.
    ///
    /// Errors: more cells in a region than can be counted.
    pub fn run(self) -> Result<WorkerOutput> {
        let frame = self.frame;
        let mut state = WorkerState {
            scratch: Scratch::new(frame),
            lists: frame.buffers.lists.take(),
            output: WorkerOutput::default(),
        };
        match (frame.cache, frame.source) {
            (Some(cache), _) => self.each_tile(&cache.queue, |tile| {
                let mut picture = Box::new([[0.0; 4]; PIXELS]);
                draw_cached(frame, cache, tile as usize, &mut state.scratch, &mut picture);
                state.output.tiles.push((tile, picture));
                true
            }),
            (None, SegmentSource::RayCast(caster)) => self.each_tile(frame.tiles, |tile| {
                let WorkerState { scratch, output, .. } = &mut state;
                let mut picture = Box::new([[0.0; 4]; PIXELS]);
                match draw_cast(frame, caster, tile as usize, scratch, &mut picture) {
                    true => output.put(frame, tile, picture, scratch),
                    false => {
                        scratch.row_shader.recorder.iter_mut().for_each(StretchRecorder::clear);
                        output.mistracked.push(tile);
                    }
                }
                true
            }),
            (None, SegmentSource::Tiles(bins)) => {
                self.each_tile(frame.tiles, |tile| self.draw_projected(bins, tile, &mut state));
            }
            (None, SegmentSource::Regions(regions)) => self.draw_regions(&regions.list, &mut state)?,
        }
        let WorkerState { scratch, lists, mut output } = state;
        frame.buffers.lists.put(lists);
        let RowShader { shaded, deferred_shading, cutter, .. } = &scratch.row_shader;
        let of_parts = cutter.as_ref().map(|cutter| &cutter.shaded);
        let all = || [shaded, &deferred_shading.shaded].into_iter().chain(of_parts);
        output.counts = Counts {
            segments_exact: all().map(|shaded| shaded.exact_count).sum(),
            evaluations: all().map(|shaded| shaded.evaluation_count).sum(),
            segments_overlapping: all().map(|shaded| shaded.overlap_count).sum(),
            ..scratch.counts
        };
        Ok(output)
    }

    fn take<'t, T>(&self, list: &'t [T]) -> Option<&'t T> {
        let number = self.next.fetch_add(1, Ordering::Relaxed);
        let item = list.get(number)?;
        if number.is_multiple_of((list.len() / REPORTS).max(1)) {
            self.progress.report("composite", number as f64 / list.len() as f64);
        }
        Some(item)
    }

    /// Draws tiles until none is left, the run is cancelled or `draw` returns false.
    fn each_tile(&self, tiles: &[u32], mut draw: impl FnMut(u32) -> bool) {
        while let Some(&tile) = self.take(tiles)
            && !self.progress.cancelled()
            && draw(tile)
        {}
    }

    fn draw_regions(&self, regions: &[Region], state: &mut WorkerState) -> Result<()> {
        let frame = self.frame;
        let is_drawn = |tile: &u32| frame.tiles.is_empty() || frame.tiles.binary_search(tile).is_ok();
        let mut bins = frame.buffers.bins.take();
        while let Some(region) = self.take(regions) {
            frame.project(region, &mut bins)?;
            for tile in bins.queue(frame.view.size[0]).into_iter().filter(is_drawn) {
                if self.progress.cancelled() || !self.draw_projected(&bins, tile, state) {
                    return Ok(());
                }
            }
        }
        frame.buffers.bins.put(bins);
        Ok(())
    }

    /// Draws or records a tile from projected cells. Returns false if the budget is exhausted.
    fn draw_projected(&self, bins: &TileBins, tile: u32, state: &mut WorkerState) -> bool {
        let WorkerState { scratch, lists, output } = state;
        if let Some(budget) = self.recording {
            let cached = record_tile(self.frame, bins, tile as usize, scratch, lists, budget);
            output.cached.extend(cached.map(|cached| (tile, cached)));
            return !budget.is_exhausted();
        }
        let mut picture = Box::new([[0.0; 4]; PIXELS]);
        draw_projected(self.frame, bins, tile as usize, scratch, lists, &mut picture);
        output.put(self.frame, tile, picture, scratch);
        true
    }
}
