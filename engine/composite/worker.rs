//! One worker: tile by tile, cells to fragments to segments to pixels.
//!
//! Each worker takes tiles, the fullest first, and walks a tile's cells in grid order, as many at a time as there
//! are lanes: spans of all cells become one dense list of fragments ([`crate::fragments::spans`]), batches of it are
//! intersected ([`crate::fragments::crossing`]) and integrated ([`crate::shade`]), and the results go to per-pixel lists
//! ([`super::lists`]), or, where the scene has one colour, are summed: there no order is needed.
//!
//! Of large grids it takes windows, projects the cells of one and draws its tiles.

use crate::composite::growing_lists::GrowingLists;
use crate::composite::hides::Hides;
use crate::composite::kernels::{Blend, Cover, Evaluate, Illuminate};
use crate::composite::lists::{Lists, Overflow, Resolve, UNSEEN};
use crate::composite::pool::Pool;
use crate::composite::sinks::{DepthSink, OPAQUE_DEPTH, Sink, TilePicture, of_one_color};
use crate::composite::slabs::Slabs;
use crate::fragments::batch::{BATCH, Batch, LANES_MOST};
use crate::fragments::crossing::Group;
use crate::fragments::ends::{Ends, cut};
use crate::fragments::spans::{Edges, Fragments};
use crate::kept::{Keeper, Keeping, KeptTile, RowSums, Rows};
use crate::project::record::TILE;
use crate::project::windows::Window;
use crate::sample::Frame;
use crate::shade::later::{Later, Mark};
use crate::shade::light::{Rays, rays};
use crate::shade::roads::{finish, integrate, quick};
use crate::shade::shaded::Shaded;
use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};
use voltet_core::Result as Fallible;
use voltet_core::progress::Progress;
use voltet_lanes::dispatch;

/// What one worker drew, with tiles' numbers, and its counts.
pub(crate) struct Drawn {
    pub tiles: Vec<(u32, Box<TilePicture>)>,
    /// Where segments were kept in place of drawing them.
    pub kept: Vec<(u32, KeptTile)>,
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

/// Scratch of one worker.
struct Scratch {
    fragments: Fragments,
    edges: Edges,
    group: Group,
    batch: Batch,
    shaded: Shaded,
    stretch: [f32; TILE * TILE],
    rays: Rays,
    pool: Pool,
    later: Later,
    slabs: Slabs,
    /// Whether cells are taken from front to back.
    slabbed: bool,
    ends: Ends,
    counts: WorkerCounts,
}

impl Scratch {
    fn new(frame: &Frame<'_>) -> Scratch {
        Scratch {
            fragments: Fragments::new(LANES_MOST),
            edges: Edges::new(),
            group: Group::new(frame.attribute_count),
            batch: Batch::new(frame.attribute_count, frame.scalar_count),
            shaded: Shaded::new(),
            stretch: [1.0; TILE * TILE],
            rays: [[0.0; TILE * TILE]; 3],
            pool: Pool::new(frame.scalar_count),
            later: Later::new(frame.scalar_count),
            slabs: Slabs::new(),
            slabbed: false,
            ends: [f32::INFINITY; TILE * TILE],
            counts: WorkerCounts::default(),
        }
    }

    /// Makes ready what is known of a tile's rays.
    fn begin(&mut self, frame: &Frame<'_>, [left, top]: [usize; 2]) {
        if frame.view.perspective {
            for (pixel, stretch) in self.stretch.iter_mut().enumerate() {
                *stretch =
                    frame.view.stretch((left + pixel % TILE) as f64, (top + pixel / TILE) as f64) as f32;
            }
        }
        if frame.shader.surface.is_some_and(|surface| surface.silhouette.is_some()) {
            rays(&frame.view, left, top, &mut self.rays);
        }
        frame.ends_of(left, top, &mut self.ends);
    }
}

/// What a worker draws with, and what it drew.
struct Desk {
    scratch: Scratch,
    lists: Lists,
    done: Vec<(u32, Box<TilePicture>)>,
    kept: Vec<(u32, KeptTile)>,
}

impl Worker<'_> {
    /// Draws until nothing is left. Returns the pictures with their tile numbers.
    ///
    /// Errors: more cells in a window than can be counted.
    pub fn run(self) -> Fallible<Drawn> {
        let frame = self.frame;
        let lists = frame.spare().lists.take();
        let mut desk = Desk { scratch: Scratch::new(frame), lists, done: Vec::new(), kept: Vec::new() };
        match self.work {
            Work::Tiles(queue) => {
                while let Some((place, &tile)) = self.take(queue)
                    && self.draw(frame, tile, place, &mut desk)
                {}
            }
            Work::Windows(windows) => self.draw_windows(windows, &mut desk)?,
        }
        let Desk { mut scratch, lists, done, kept } = desk;
        frame.spare().lists.put(lists);
        scratch.counts.segments_exact +=
            scratch.shaded.exact_count + scratch.pool.shaded.exact_count + scratch.later.exact_count();
        scratch.counts.evaluations = scratch.shaded.evaluation_count
            + scratch.pool.shaded.evaluation_count
            + scratch.later.evaluation_count();
        scratch.counts.segments_overlapping = scratch.shaded.overlap_count;
        Ok(Drawn { tiles: done, kept, counts: scratch.counts })
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
                for tile in tiles.queue(frame.tiles_wide) {
                    if !places.next().is_some_and(|place| self.draw(&frame, tile, place, desk)) {
                        return Ok(());
                    }
                }
            }
            // The others may wait for what empty tiles tell: nothing.
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
        let Desk { scratch, lists, done, kept } = desk;
        if let Some(keeping) = frame.keeping {
            kept.extend(
                keep_tile(frame, tile as usize, scratch, lists, keeping).map(|segments| (tile, segments)),
            );
            return !keeping.is_given_up();
        }
        let mut picture = Box::new([[0.0; 4]; TILE * TILE]);
        let sampled = self.hides.sample(place);
        let Some(slabbed) = self.hides.answer(place, || self.progress.cancelled()) else { return false };
        scratch.slabbed = slabbed;
        draw_tile(frame, tile as usize, scratch, lists, &mut picture);
        if let Some(sampled) = sampled {
            sampled.tell(lists.hidden(TILE / 2));
        }
        done.push((tile, picture));
        true
    }
}

fn draw_tile(
    frame: &Frame<'_>,
    tile: usize,
    scratch: &mut Scratch,
    lists: &mut Lists,
    picture: &mut TilePicture,
) {
    let (left, top) = (tile % frame.tiles_wide * TILE, tile / frame.tiles_wide * TILE);
    scratch.begin(frame, [left, top]);
    if let Some(color) = frame.shader.one_color {
        let mut depth = [0.0; TILE * TILE];
        // Pixels beyond the picture's edge wait for nothing.
        let [columns, rows] = [frame.view.size[0] - left, frame.view.size[1] - top];
        for (pixel, depth) in depth.iter_mut().enumerate() {
            if columns <= pixel % TILE || rows <= pixel / TILE {
                *depth = OPAQUE_DEPTH;
            }
        }
        // A sum cannot overflow its pixel.
        let opacities = frame.shader.surface.is_some();
        let _ = match frame.kept {
            Some(_) => all(frame, tile, scratch, &mut RowSums(&mut depth)),
            None => all(frame, tile, scratch, &mut DepthSink { sums: &mut depth, opacities }),
        };
        for (pixel, &sum) in picture.iter_mut().zip(&depth) {
            *pixel = of_one_color(color, sum, opacities);
        }
        return;
    }
    if frame.kept.is_some() {
        let (mut rows, before) = (Rows::new(), scratch.counts);
        if all(frame, tile, scratch, &mut rows).is_ok() {
            rows.end(picture);
            return;
        }
        scratch.counts = before;
    }
    lists.clear();
    scratch.counts.tiles_sorted += u64::from(frame.sorted);
    let before = scratch.counts;
    let drawn = all(frame, tile, scratch, lists);
    if drawn.is_ok() {
        let Scratch { later, counts, .. } = scratch;
        let waits = !later.is_empty();
        let mut color = |marks: &mut [Mark]| later.color(frame.shader, frame.lanes, marks);
        let resolve: Resolve<'_> = if waits { Some(&mut color) } else { None };
        let blend = Blend { lists, sorted: frame.sorted, picture, resolve };
        let disordered = dispatch(frame.lanes, blend);
        counts.pixels_disordered += disordered;
    } else {
        // Rows are independent: draw them one at a time with lists that grow.
        scratch.counts = before;
        scratch.counts.tiles_deep += 1;
        let mut growing = GrowingLists::default();
        for row in 0..TILE.min(frame.view.size[1] - top) {
            growing.clear();
            let _ = walk(frame, tile, row..row + 1, scratch, &mut growing);
            scratch.counts.pixels_disordered +=
                growing.composite(frame.sorted, &mut picture[row * TILE..][..TILE]);
        }
    }
}

/// Keeps a tile's segments; gives up where they are too many.
fn keep_tile(
    frame: &Frame<'_>,
    tile: usize,
    scratch: &mut Scratch,
    lists: &mut Lists,
    keeping: &Keeping,
) -> Option<KeptTile> {
    let (left, top) = (tile % frame.tiles_wide * TILE, tile / frame.tiles_wide * TILE);
    scratch.begin(frame, [left, top]);
    scratch.slabbed = false;
    lists.clear();
    let mut keeper = Keeper::new(lists, frame.scalar_count);
    if walk(frame, tile, 0..TILE, scratch, &mut keeper).is_err() {
        keeping.give_up();
        return None;
    }
    keeper.end(frame.lanes, keeping)
}

/// Sends all segments of a tile to a sink, from its cells or from what was kept of them.
fn all<S: Sink>(frame: &Frame<'_>, tile: usize, scratch: &mut Scratch, sink: &mut S) -> Result<(), Overflow> {
    match frame.kept {
        None => walk(frame, tile, 0..TILE, scratch, sink),
        Some(kept) => kept.tile(tile).map_or(Ok(()), |kept| walk_kept(frame, kept, scratch, sink)),
    }
}

/// Fragments of a batch that quick forms may leave over where nothing is pooled.
const LEFT_MOST: usize = 16;

/// Sends what was kept of a tile's segments to a sink, front to back. Errors: quick forms leave over so much that it is worth pooling,
/// and the sink has no lists.
fn walk_kept<S: Sink>(
    frame: &Frame<'_>,
    kept: &KeptTile,
    scratch: &mut Scratch,
    sink: &mut S,
) -> Result<(), Overflow> {
    let Scratch { batch, shaded, pool, later, counts, .. } = scratch;
    pool.clear();
    later.clear();
    let pools = frame.shader.pools() && sink.lists().is_some();
    for row in 0..TILE {
        let mut slices = kept.slices(row, frame.scalar_count);
        // At least what is seen through the pixels.
        let mut through = [1.0f32; TILE];
        loop {
            let count = slices.next(batch);
            let hidden = through.iter().all(|through| *through <= 0.5 * UNSEEN);
            if count == 0 || hidden || sink.is_row_full(row) {
                break;
            }
            counts.segments += u64::from(batch.hits);
            quick(frame.shader, frame.lanes, batch, count, shaded);
            if !pools {
                if frame.shader.pools() && LEFT_MOST < shaded.left_over() {
                    return Err(Overflow);
                }
                finish(frame.shader, frame.lanes, batch, shaded, None);
                sink.take(frame.lanes, batch, shaded, count)?;
                continue;
            }
            pool.lend(shaded);
            let opacities = pool.opacities(shaded);
            for (lengths, opacities) in batch.length[..count].chunks(TILE).zip(opacities.chunks(TILE)) {
                for ((through, length), opacity) in through.iter_mut().zip(lengths).zip(opacities) {
                    *through *= if *length > 0.0 { 1.0 - opacity } else { 1.0 };
                }
            }
            sink.take(frame.lanes, batch, shaded, count)?;
            if let Some(lists) = sink.lists() {
                pool.take(frame, batch, shaded, lists, later);
            }
        }
    }
    if let Some(lists) = sink.lists() {
        pool.finish(frame, lists, later);
    }
    Ok(())
}

/// Sends all segments of some rows of a tile to a sink.
fn walk<S: Sink>(
    frame: &Frame<'_>,
    tile: usize,
    rows: Range<usize>,
    scratch: &mut Scratch,
    sink: &mut S,
) -> Result<(), Overflow> {
    let (left, top) = (tile % frame.tiles_wide * TILE, tile / frame.tiles_wide * TILE);
    let right = (left + TILE).min(frame.view.size[0]);
    let bottom = (top + TILE).min(frame.view.size[1]);
    let rows = rows.start..rows.end.min(bottom - top);
    let Scratch {
        fragments,
        edges,
        group,
        batch,
        shaded,
        stretch,
        rays,
        pool,
        later,
        slabs,
        slabbed,
        ends,
        counts,
    } = scratch;
    pool.clear();
    later.clear();
    let pools = frame.shader.pools() && sink.lists().is_some();
    let slabbed = *slabbed && sink.lists().is_some();
    let mut send = |sink: &mut S, slabs: &mut Slabs, batch: &mut Batch, count: usize| {
        if frame.ends.is_some() {
            cut(batch, count, frame.attribute_count, ends);
        }
        if !sink.wants_colors() {
            return sink.take(frame.lanes, batch, shaded, count);
        }
        if pools {
            quick(frame.shader, frame.lanes, batch, count, shaded);
            pool.lend(shaded);
        } else {
            integrate(frame.shader, frame.lanes, batch, count, shaded);
        }
        if frame.shader.surface.is_some() {
            dispatch(frame.lanes, Illuminate { frame, batch, count, rays, shaded });
        }
        if slabbed {
            let opacity = if pools { pool.opacities(shaded) } else { &shaded.rgba[3] };
            slabs.take(&batch.pixel, &batch.exit, opacity, count);
        }
        sink.take(frame.lanes, batch, shaded, count)?;
        if let Some(lists) = sink.lists().filter(|_| pools) {
            pool.take(frame, batch, shaded, lists, later);
        }
        Ok(())
    };

    let width = frame.lanes.width();
    let mut sorted = Vec::new();
    if slabbed {
        slabs.begin(frame, tile, [right - left, bottom - top]);
        sorted = std::mem::take(&mut slabs.entries);
    }
    let entries = if slabbed { &sorted } else { frame.entries_of(tile) };
    for (number, cells) in entries.chunks(width).enumerate() {
        if slabbed
            && (number * width).is_multiple_of(slabs.length)
            && !slabs.close(number * width / slabs.length)
        {
            counts.tiles_stopped += 1;
            counts.cells_hidden += (entries.len() - number * width) as u64;
            break;
        }
        if sink.is_full() {
            counts.tiles_stopped += 1;
            counts.cells_hidden += (entries.len() - number * width + frame.cells64_of(tile).count()) as u64;
            return Ok(());
        }
        let after = (number + 1) * width;
        let ahead = &entries[after.min(entries.len())..];
        dispatch(
            frame.lanes,
            Cover {
                frame,
                cells,
                ahead,
                left,
                top,
                right,
                rows: rows.clone(),
                open: slabbed.then_some(&slabs.open),
                group,
                edges,
                fragments,
            },
        );
        let mut from = 0;
        while from < fragments.count {
            let count = (fragments.count - from).min(BATCH);
            let codes = &fragments.codes[from..];
            dispatch(frame.lanes, Evaluate { frame, group, codes, count, stretch, batch });
            counts.segments += u64::from(batch.hits);
            send(sink, slabs, batch, count)?;
            from += count;
        }
    }

    slabs.entries = sorted;

    // These may lie in front of what hides the others.
    let mut count = 0;
    for cell in frame.cells64_of(tile) {
        let [x0, y0, x1, y1] = cell.bounds;
        for j in y0.max(top + rows.start)..y1.min(top + rows.end) {
            for i in x0.max(left)..x1.min(right) {
                let Some(crossing) = cell.cross(&frame.view, i, j) else { continue };
                frame.put64(cell, &crossing, [i, j], count, batch);
                count += 1;
                if count == BATCH {
                    counts.segments += count as u64;
                    send(sink, slabs, batch, std::mem::take(&mut count))?;
                }
            }
        }
    }
    if count > 0 {
        counts.segments += count as u64;
        send(sink, slabs, batch, count)?;
    }
    if let Some(lists) = sink.lists() {
        pool.finish(frame, lists, later);
    }
    Ok(())
}
