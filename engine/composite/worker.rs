//! One worker: tile by tile, cells to fragments to segments to pixels.
//!
//! Each worker takes tiles, the fullest first, and walks a tile's cells in grid order, as many at a time as there
//! are lanes: spans of all cells become one dense list of fragments ([`crate::fragments::spans`]), batches of it are
//! intersected ([`crate::fragments::crossing`]) and integrated ([`crate::shade`]), and the results go to per-pixel lists
//! ([`super::lists`]), or, where the scene has one colour, are summed: there no order is needed.

use crate::composite::growing_lists::GrowingLists;
use crate::composite::kernels::{Blend, Cover, Evaluate, Illuminate};
use crate::composite::lists::{Lists, Overflow, Resolve};
use crate::composite::pool::Pool;
use crate::composite::sinks::{DepthSink, OPAQUE_DEPTH, Sink, TilePicture, of_one_color};
use crate::fragments::batch::{BATCH, Batch, LANES_MOST};
use crate::fragments::crossing::Group;
use crate::fragments::ends::{Ends, cut};
use crate::fragments::spans::{Edges, Fragments};
use crate::project::record::TILE;
use crate::sample::Frame;
use crate::shade::later::Later;
use crate::shade::light::{Rays, rays};
use crate::shade::roads::{integrate, quick};
use crate::shade::shaded::Shaded;
use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};
use voltet_core::progress::Progress;
use voltet_lanes::dispatch;

/// What one worker drew: pictures with their tile numbers, and its counts.
pub(crate) type Drawn = (Vec<(u32, Box<TilePicture>)>, WorkerCounts);

/// Counts of one worker.
#[derive(Debug, Default, Clone, Copy)]
pub(crate) struct WorkerCounts {
    pub segments: u64,
    pub segments_exact: u64,
    pub segments_overlapping: u64,
    pub tiles_deep: u64,
    pub tiles_sorted: u64,
    pub pixels_disordered: u64,
    pub tiles_stopped: u64,
    pub cells_hidden: u64,
}

/// One worker: takes tiles until none is left.
pub(crate) struct Worker<'a> {
    pub frame: &'a Frame<'a>,
    /// Tile numbers, fullest first.
    pub queue: &'a [u32],
    pub next: &'a AtomicUsize,
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
    ends: Ends,
    counts: WorkerCounts,
}

impl Worker<'_> {
    /// Draws tiles until the queue is empty. Returns the pictures with their tile numbers.
    pub fn run(self) -> Drawn {
        let frame = self.frame;
        let mut scratch = Scratch {
            fragments: Fragments::new(LANES_MOST),
            edges: Edges::new(),
            group: Group::new(frame.attribute_count),
            batch: Batch::new(frame.attribute_count, frame.scalar_count),
            shaded: Shaded::new(),
            stretch: [1.0; TILE * TILE],
            rays: [[0.0; TILE * TILE]; 3],
            pool: Pool::new(frame.scalar_count),
            later: Later::default(),
            ends: [f32::INFINITY; TILE * TILE],
            counts: WorkerCounts::default(),
        };
        let mut lists = Lists::new();
        let mut done = Vec::new();
        loop {
            let k = self.next.fetch_add(1, Ordering::Relaxed);
            let Some(&tile) = self.queue.get(k) else { break };
            if k.is_multiple_of(16) {
                self.progress.report("composite", k as f64 / self.queue.len() as f64);
            }
            if self.progress.cancelled() {
                break;
            }
            let mut picture = Box::new([[0.0; 4]; TILE * TILE]);
            draw_tile(frame, tile as usize, &mut scratch, &mut lists, &mut picture);
            done.push((tile, picture));
        }
        scratch.counts.segments_exact += scratch.shaded.exact_count + scratch.pool.shaded.exact_count;
        scratch.counts.segments_overlapping = scratch.shaded.overlap_count;
        (done, scratch.counts)
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
    if frame.view.perspective {
        for (pixel, stretch) in scratch.stretch.iter_mut().enumerate() {
            *stretch = frame.view.stretch((left + pixel % TILE) as f64, (top + pixel / TILE) as f64) as f32;
        }
    }
    if frame.shader.surface.is_some_and(|surface| surface.silhouette.is_some()) {
        rays(&frame.view, left, top, &mut scratch.rays);
    }
    frame.ends_of(left, top, &mut scratch.ends);
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
        let _ = walk(frame, tile, 0..TILE, scratch, &mut DepthSink { sums: &mut depth, opacities });
        for (pixel, &sum) in picture.iter_mut().zip(&depth) {
            *pixel = of_one_color(color, sum, opacities);
        }
        return;
    }
    lists.clear();
    scratch.counts.tiles_sorted += u64::from(frame.sorted);
    let before = scratch.counts;
    let drawn = walk(frame, tile, 0..TILE, scratch, lists);
    if drawn.is_ok() {
        let Scratch { later, counts, .. } = scratch;
        let mut color = |rgba: [f32; 4]| {
            let found = later.color(frame.shader, rgba);
            counts.segments_exact += u64::from(found.is_some());
            found
        };
        let resolve: Resolve<'_> = if later.is_empty() { None } else { Some(&mut color) };
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
    let Scratch { fragments, edges, group, batch, shaded, stretch, rays, pool, later, ends, counts } =
        scratch;
    pool.clear();
    later.clear();
    let pools = frame.shader.pools() && sink.lists().is_some();
    let mut send = |sink: &mut S, batch: &mut Batch, count: usize| {
        if frame.ends.is_some() {
            cut(batch, count, frame.attribute_count, ends);
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
        sink.take(frame.lanes, batch, shaded, count)?;
        if let Some(lists) = sink.lists().filter(|_| pools) {
            pool.take(frame, batch, shaded, lists, later);
        }
        Ok(())
    };

    let width = frame.lanes.width();
    let entries = frame.entries_of(tile);
    for (number, cells) in entries.chunks(width).enumerate() {
        if sink.is_full() {
            counts.tiles_stopped += 1;
            counts.cells_hidden += (entries.len() - number * width + frame.cells64_of(tile).count()) as u64;
            return Ok(());
        }
        let after = (number + 1) * width;
        let ahead = &entries[after.min(entries.len())..];
        dispatch(
            frame.lanes,
            Cover { frame, cells, ahead, left, top, right, rows: rows.clone(), group, edges, fragments },
        );
        let mut from = 0;
        while from < fragments.count {
            let count = (fragments.count - from).min(BATCH);
            let codes = &fragments.codes[from..];
            dispatch(frame.lanes, Evaluate { frame, group, codes, count, stretch, batch });
            counts.segments += u64::from(batch.hits);
            send(sink, batch, count)?;
            from += count;
        }
    }

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
                    send(sink, batch, std::mem::take(&mut count))?;
                }
            }
        }
    }
    if count > 0 {
        counts.segments += count as u64;
        send(sink, batch, count)?;
    }
    if let Some(lists) = sink.lists() {
        pool.finish(frame, lists, later);
    }
    Ok(())
}
