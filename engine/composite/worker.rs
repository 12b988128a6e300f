//! One worker: tile by tile, cells to fragments to segments to pixels.
//!
//! Each worker takes tiles, the fullest first, and walks a tile's cells in grid order, as many at a time as there
//! are lanes: spans of all cells become one dense list of fragments ([`crate::fragments::spans`]), batches of it are
//! intersected ([`crate::fragments::crossing`]) and integrated ([`crate::shade`]), and the results go to per-pixel lists
//! ([`super::lists`]), or, where the scene has one colour, are summed: there no order is needed.
//!
//! Of large grids it takes windows, projects the cells of one and draws its tiles.

use crate::composite::front_to_back::{ListSlices, Shading, Slices};
use crate::composite::growing_lists::GrowingLists;
use crate::composite::hides::Hides;
use crate::composite::kernels::{Append, Arrange, Cover, Evaluate, Illuminate};
use crate::composite::lists::{Limit, Lists, Overflow, UNSEEN};
use crate::composite::rows::{RowSums, Rows};
use crate::composite::sinks::{DepthSink, OPAQUE_DEPTH, Sink, TilePicture, of_one_color};
use crate::composite::slabs::{Open, Slabs, all_open};
use crate::fragments::batch::{BATCH, Batch, LANES_MOST};
use crate::fragments::crossing::Group;
use crate::fragments::ends::cut;
use crate::fragments::spans::{Edges, Fragments, Places};
use crate::kept::{Keeper, Keeping, KeptTile};
use crate::project::cell64::{Cell64, Crossing64};
use crate::project::record::TILE;
use crate::project::windows::Window;
use crate::sample::Frame;
use crate::shade::light::rays;
use crate::shade::roads::integrate;
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
    stretch: [f32; TILE * TILE],
    shading: Shading,
    slabs: Slabs,
    /// Whether cells are taken from front to back.
    slabbed: bool,
    counts: WorkerCounts,
}

impl Scratch {
    fn new(frame: &Frame<'_>) -> Scratch {
        Scratch {
            fragments: Fragments::new(LANES_MOST),
            edges: Edges::new(),
            group: Group::new(frame.attribute_count),
            stretch: [1.0; TILE * TILE],
            shading: Shading::new(frame),
            slabs: Slabs::new(),
            slabbed: false,
            counts: WorkerCounts::default(),
        }
    }

    /// Makes ready what is known of a tile's rays.
    fn begin(&mut self, frame: &Frame<'_>, Bounds { left, top, .. }: Bounds) {
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
struct Bounds {
    tile: usize,
    left: usize,
    top: usize,
    /// Columns and rows that are in the picture.
    size: [usize; 2],
}

impl Bounds {
    fn of(frame: &Frame<'_>, tile: usize) -> Bounds {
        let (left, top) = (tile % frame.tiles_wide * TILE, tile / frame.tiles_wide * TILE);
        let [width, height] = frame.view.size;
        Bounds { tile, left, top, size: [TILE.min(width - left), TILE.min(height - top)] }
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
        let Shading { shaded, pool, .. } = &scratch.shading;
        scratch.counts.segments_exact = shaded.exact_count + pool.shaded.exact_count;
        scratch.counts.evaluations = shaded.evaluation_count + pool.shaded.evaluation_count;
        scratch.counts.segments_overlapping = shaded.overlap_count;
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
        let hidden = draw_tile(frame, tile as usize, scratch, lists, &mut picture);
        if let Some(sampled) = sampled {
            sampled.tell(hidden);
        }
        done.push((tile, picture));
        true
    }
}

/// Draws a tile. Returns its segments in lists, and those of them that are hidden.
fn draw_tile(
    frame: &Frame<'_>,
    tile: usize,
    scratch: &mut Scratch,
    lists: &mut Lists,
    picture: &mut TilePicture,
) -> [usize; 2] {
    let bounds = Bounds::of(frame, tile);
    scratch.begin(frame, bounds);
    if let Some(color) = frame.shader.one_color {
        draw_in_one_color(frame, bounds, color, scratch, picture);
        return [0; 2];
    }
    if let Some(kept) = frame.kept {
        let mut rows = Rows::new();
        if let Some(kept) = kept.tile(tile) {
            for row in 0..bounds.size[1] {
                let mut slices = Slices::Kept(kept.slices(row, frame.scalar_count), 0);
                scratch.shading.blend(frame, row, &mut slices, &mut rows);
                scratch.counts.segments += slices.segments();
            }
        }
        scratch.shading.end(frame, &mut rows);
        rows.end(picture);
        return [0; 2];
    }
    let before = scratch.counts;
    match draw_in_lists(frame, bounds, scratch, lists, picture) {
        Ok(hidden) => {
            scratch.counts.tiles_sorted += u64::from(frame.sorted);
            hidden
        }
        Err(Overflow) => {
            // Rows are independent: draw them one at a time with lists that grow.
            scratch.counts = before;
            scratch.counts.tiles_sorted += u64::from(frame.sorted);
            scratch.counts.tiles_deep += 1;
            let mut growing = GrowingLists::default();
            for row in 0..bounds.size[1] {
                growing.clear();
                walk(frame, bounds, row..row + 1, scratch, &mut growing);
                scratch.counts.pixels_disordered +=
                    growing.composite(frame.sorted, &mut picture[row * TILE..][..TILE]);
            }
            [0; 2]
        }
    }
}

/// Draws a tile of a scene of one colour, which needs no order.
fn draw_in_one_color(
    frame: &Frame<'_>,
    bounds: Bounds,
    color: [f32; 3],
    scratch: &mut Scratch,
    picture: &mut TilePicture,
) {
    let mut depth = [0.0; TILE * TILE];
    // Pixels beyond the picture's edge wait for nothing.
    for (pixel, depth) in depth.iter_mut().enumerate() {
        if bounds.size[0] <= pixel % TILE || bounds.size[1] <= pixel / TILE {
            *depth = OPAQUE_DEPTH;
        }
    }
    let opacities = frame.shader.surface.is_some();
    match frame.kept {
        Some(kept) => {
            for row in 0..bounds.size[1] {
                let Some(kept) = kept.tile(bounds.tile) else { break };
                let mut slices = Slices::Kept(kept.slices(row, frame.scalar_count), 0);
                scratch.shading.sum(frame, row, &mut slices, &mut RowSums(&mut depth));
                scratch.counts.segments += slices.segments();
            }
        }
        None => {
            walk(frame, bounds, 0..bounds.size[1], scratch, &mut DepthSink { sums: &mut depth, opacities })
        }
    }
    for (pixel, &sum) in picture.iter_mut().zip(&depth) {
        *pixel = of_one_color(color, sum, opacities);
    }
}

/// Draws a tile by lists. Returns its segments in them, and those of them that are hidden. Errors: a pixel has too many.
fn draw_in_lists(
    frame: &Frame<'_>,
    bounds: Bounds,
    scratch: &mut Scratch,
    lists: &mut Lists,
    picture: &mut TilePicture,
) -> Result<[usize; 2], Overflow> {
    let mut rows = Rows::new();
    let mut open = all_open(bounds.size);
    let mut told = [0; 2];
    lists.clear(frame.attribute_count);
    // Whatever lies in front of what hides the others.
    list64(frame, bounds, scratch, lists)?;
    if scratch.slabbed {
        let mut slabs = std::mem::replace(&mut scratch.slabs, Slabs::new());
        slabs.begin(frame, bounds.tile);
        let (entries, mut from) = (slabs.entries(), 0);
        for (to, nearest) in slabs.ends(frame.lanes.width()) {
            list(frame, &entries[from..to], bounds, Some(&open), scratch, lists)?;
            from = to;
            for row in (0..TILE).filter(|&row| open[row] != 0) {
                let mut limit = Limit::new(nearest);
                draw_row(frame, row, Some(&mut limit), scratch, lists, &mut rows);
                lists.let_go(row, &limit);
            }
            scratch.shading.end(frame, &mut rows);
            for (row, open) in open.iter_mut().enumerate() {
                for (x, through) in rows.through(row).iter().enumerate() {
                    // So much less that rounding never closes what the sum of the list would still show.
                    *open &= !(u16::from(*through <= 0.5 * UNSEEN) << x);
                }
                lists.close(row, *open);
            }
            if to < entries.len() && open == [0; TILE] {
                scratch.counts.tiles_stopped += 1;
                scratch.counts.cells_hidden += (entries.len() - to) as u64;
                break;
            }
        }
        scratch.slabs = slabs;
    } else {
        list(frame, frame.entries_of(bounds.tile), bounds, None, scratch, lists)?;
        for row in 0..bounds.size[1] {
            let [all, hidden] = draw_row(frame, row, None, scratch, lists, &mut rows);
            told = [told[0] + all, told[1] + hidden];
        }
        scratch.shading.end(frame, &mut rows);
    }
    rows.end(picture);
    Ok(told)
}

/// Draws what a row's lists hold, as far as a limit lets it through. Returns its segments, and those of them that are hidden.
fn draw_row(
    frame: &Frame<'_>,
    row: usize,
    limit: Option<&mut Limit>,
    scratch: &mut Scratch,
    lists: &mut Lists,
    rows: &mut Rows,
) -> [usize; 2] {
    let deepest = lists.deepest(row);
    if deepest == 0 {
        return [0; 2];
    }
    scratch.counts.pixels_disordered += dispatch(frame.lanes, Arrange { lists, row, sorted: frame.sorted });
    let slices = ListSlices { lists, row, stretch: &scratch.stretch, limit, taken: 0, deepest };
    let taken = scratch.shading.blend(frame, row, &mut Slices::Lists(slices), rows);
    let counts = lists.counts(row);
    let hidden = counts.iter().map(|&count| (count as usize).saturating_sub(taken)).sum();
    [counts.iter().sum::<u32>() as usize, hidden]
}

/// Keeps a tile's segments; gives up where they are too many.
fn keep_tile(
    frame: &Frame<'_>,
    tile: usize,
    scratch: &mut Scratch,
    lists: &mut Lists,
    keeping: &Keeping,
) -> Option<KeptTile> {
    let bounds = Bounds::of(frame, tile);
    scratch.begin(frame, bounds);
    lists.clear(frame.attribute_count);
    let listed = list64(frame, bounds, scratch, lists)
        .and_then(|()| list(frame, frame.entries_of(tile), bounds, None, scratch, lists));
    if listed.is_err() {
        keeping.give_up();
        return None;
    }
    let mut keeper = Keeper::new(frame.scalar_count);
    for row in 0..bounds.size[1] {
        dispatch(frame.lanes, Arrange { lists, row, sorted: true });
        let (stretch, deepest) = (&scratch.stretch, lists.deepest(row));
        let mut slices = Slices::Lists(ListSlices { lists, row, stretch, limit: None, taken: 0, deepest });
        let batch = &mut scratch.shading.batch;
        loop {
            let count = slices.next(frame, batch);
            if count == 0 {
                break;
            }
            keeper.take(row, batch, count);
        }
    }
    keeper.end(keeping)
}

/// Appends the segments of a tile's cells to its lists, of pixels that are `open`. Errors: a pixel has too many.
fn list(
    frame: &Frame<'_>,
    entries: &[u32],
    Bounds { left, top, size, .. }: Bounds,
    open: Option<&Open>,
    scratch: &mut Scratch,
    lists: &mut Lists,
) -> Result<(), Overflow> {
    let Scratch { fragments, edges, group, counts, .. } = scratch;
    let width = frame.lanes.width();
    for (number, cells) in entries.chunks(width).enumerate() {
        let ahead = &entries[((number + 1) * width).min(entries.len())..];
        let (right, rows) = (left + size[0], 0..size[1]);
        let places = Some(Places { next: &mut lists.next, open });
        let cover = Cover {
            frame,
            cells,
            ahead,
            left,
            top,
            right,
            rows,
            places,
            group: &mut *group,
            edges: &mut *edges,
            fragments: &mut *fragments,
        };
        dispatch(frame.lanes, cover);
        counts.segments += dispatch(frame.lanes, Append { frame, group, fragments, lists })?;
    }
    Ok(())
}

/// The same of its cells that are crossed in 64 bits.
fn list64(
    frame: &Frame<'_>,
    bounds: Bounds,
    scratch: &mut Scratch,
    lists: &mut Lists,
) -> Result<(), Overflow> {
    let Scratch { shading: Shading { batch, .. }, counts, .. } = scratch;
    for_each64(frame, bounds, 0..bounds.size[1], |cell, crossing, place| {
        // Lists hold depths.
        frame.put64(cell, crossing, place, 1.0, 0, batch);
        counts.segments += 1;
        let ends = batch.front.iter().zip(&batch.back).map(|(front, back)| [front[0], back[0]]);
        lists.push(batch.pixel[0] as usize, [batch.entry[0], batch.length[0]], ends)
    })
}

/// Calls for each pixel of some rows of a tile that meets a cell which is crossed in 64 bits, until an error.
fn for_each64(
    frame: &Frame<'_>,
    Bounds { tile, left, top, size: [columns, _] }: Bounds,
    rows: Range<usize>,
    mut each: impl FnMut(&Cell64, &Crossing64, [usize; 2]) -> Result<(), Overflow>,
) -> Result<(), Overflow> {
    for cell in frame.cells64_of(tile) {
        let [x0, y0, x1, y1] = cell.bounds;
        for j in y0.max(top + rows.start)..y1.min(top + rows.end) {
            for i in x0.max(left)..x1.min(left + columns) {
                if let Some(crossing) = cell.cross(&frame.view, i, j) {
                    each(cell, &crossing, [i, j])?;
                }
            }
        }
    }
    Ok(())
}

/// Sends all segments of some rows of a tile to a sink, as they come.
fn walk<S: Sink>(frame: &Frame<'_>, bounds: Bounds, rows: Range<usize>, scratch: &mut Scratch, sink: &mut S) {
    let Bounds { tile, left, top, size } = bounds;
    let Scratch { fragments, edges, group, stretch, shading, counts, .. } = scratch;
    let Shading { batch, shaded, rays, ends, .. } = shading;
    let mut send = |sink: &mut S, batch: &mut Batch, count: usize| {
        if frame.ends.is_some() {
            cut(batch, count, frame.attribute_count, ends);
        }
        integrate(frame.shader, frame.lanes, batch, count, shaded);
        if frame.shader.surface.is_some() {
            dispatch(frame.lanes, Illuminate { frame, batch, count, rays, shaded });
        }
        sink.take(batch, shaded, count);
    };

    let width = frame.lanes.width();
    let entries = frame.entries_of(tile);
    for (number, cells) in entries.chunks(width).enumerate() {
        if sink.is_full() {
            counts.tiles_stopped += 1;
            counts.cells_hidden += (entries.len() - number * width + frame.cells64_of(tile).count()) as u64;
            return;
        }
        let ahead = &entries[((number + 1) * width).min(entries.len())..];
        let (right, rows) = (left + size[0], rows.clone());
        dispatch(
            frame.lanes,
            Cover { frame, cells, ahead, left, top, right, rows, places: None, group, edges, fragments },
        );
        let mut from = 0;
        while from < fragments.count {
            let count = (fragments.count - from).min(BATCH);
            let codes = &fragments.codes[from..];
            dispatch(frame.lanes, Evaluate { frame, group, codes, count, stretch, batch });
            counts.segments += u64::from(batch.hits);
            send(sink, batch, count);
            from += count;
        }
    }

    // These may lie in front of what hides the others.
    let mut count = 0;
    let _ = for_each64(frame, bounds, rows, |cell, crossing, [i, j]| {
        let stretch = frame.view.stretch(i as f64, j as f64);
        frame.put64(cell, crossing, [i, j], stretch, count, batch);
        count += 1;
        if count == BATCH {
            counts.segments += count as u64;
            send(sink, batch, std::mem::take(&mut count));
        }
        Ok(())
    });
    if count > 0 {
        counts.segments += count as u64;
        send(sink, batch, count);
    }
}
