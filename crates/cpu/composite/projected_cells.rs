//! A tile's projected cells in grid order, as many at a time as there are lanes: spans of all become one dense list of fragments
//! ([`crate::fragments::spans`]), these are intersected ([`crate::fragments::crossing`]), and the segments go to per-pixel lists
//! ([`super::fragment_lists`]) or, shaded as they come, to a sink.

use crate::composite::accumulators::Sink;

use crate::composite::fragment_lists::{FragmentLists, Overflow};
use crate::composite::frame::FrameContext;
use crate::composite::illumination;
use crate::composite::row_shader::{RowShader, Scratch};
use crate::fragments::batch::{BATCH, Batch, MAX_LANES, clip_to_depth};
use crate::fragments::crossing::CellPacket;
use crate::fragments::spans::{Edges, Fragments, NextSlots};
use crate::project::precise_cell::{PreciseCell, PreciseCrossing};
use crate::project::tile_bins::TileBins;
use crate::tile::{PIXELS, TILE, TileRect};
use std::ops::Range;
use voltet_simd::{Kernel, Lanes, dispatch, prefetch};

/// Fills the lists of a tile with the segments of its cells. Errors: a pixel has too many.
pub(crate) fn fill_lists(
    frame: &FrameContext<'_>,
    bins: &TileBins,
    rect: TileRect,
    scratch: &mut Scratch,
    lists: &mut FragmentLists,
) -> Result<(), Overflow> {
    lists.clear(frame.attribute_count());
    let Scratch { fragments, edges, packet, row_shader: RowShader { batch, .. }, counts, .. } = scratch;
    for_each_precise(frame, bins, rect, 0..rect.size[1], |cell, crossing, pixel| {
        // Lists hold depths.
        frame.put_precise(cell, crossing, pixel, 1.0, 0, batch);
        counts.segments += 1;
        let ends = batch.front.iter().zip(&batch.back).map(|(front, back)| [front[0], back[0]]);
        lists.push(batch.pixel[0] as usize, [batch.entry[0], batch.length[0]], ends)
    })?;
    for number in 0..bins.entries_of(rect.position()).len().div_ceil(frame.lanes.width()) {
        let (rows, next) = (0..rect.size[1], Some(&mut lists.next));
        dispatch(frame.lanes, Cover { frame, bins, rect, rows, number, next, packet, edges, fragments });
        counts.segments += dispatch(frame.lanes, Append { frame, packet, fragments, lists })?;
    }
    Ok(())
}

/// Calls for each pixel of some rows of a tile that meets a precise cell, until an error.
fn for_each_precise(
    frame: &FrameContext<'_>,
    bins: &TileBins,
    rect @ TileRect { left, top, size: [columns, _], .. }: TileRect,
    rows: Range<usize>,
    mut each: impl FnMut(&PreciseCell, &PreciseCrossing, [usize; 2]) -> Result<(), Overflow>,
) -> Result<(), Overflow> {
    for cell in bins.precise_cells_of(rect.position()) {
        let [x0, y0, x1, y1] = cell.bounds;
        for j in y0.max(top + rows.start)..y1.min(top + rows.end) {
            for i in x0.max(left)..x1.min(left + columns) {
                if let Some(crossing) = cell.cross(frame.view, i, j) {
                    each(cell, &crossing, [i, j])?;
                }
            }
        }
    }
    Ok(())
}

/// Sends all segments of some rows of a tile to a sink, as they come.
pub(crate) fn walk<S: Sink>(
    frame: &FrameContext<'_>,
    bins: &TileBins,
    rect: TileRect,
    rows: Range<usize>,
    scratch: &mut Scratch,
    sink: &mut S,
) {
    let Scratch { fragments, edges, packet, length_per_depth, row_shader, counts, .. } = scratch;
    let RowShader { batch, shaded, rays, depth_limits, cutter, .. } = row_shader;
    let mut shade = |sink: &mut S, batch: &Batch, count: usize| {
        illumination::shade(frame, batch, count, rays, shaded);
        sink.take(batch, shaded, count);
    };
    let mut send = |sink: &mut S, batch: &mut Batch, count: usize| {
        if frame.depth_limit.is_some() {
            clip_to_depth(batch, count, frame.attribute_count(), depth_limits);
        }
        if let Some(cutter) = cutter.as_deref_mut() {
            for k in 0..count {
                if batch.length[k] > 0.0 {
                    let within = batch.pixel[k] as usize % PIXELS;
                    let pixel = [rect.left + within % TILE, rect.top + within / TILE];
                    cutter.cut_alone(frame, pixel, batch, k, |parts, count| shade(sink, parts, count));
                }
            }
            cutter.end_alone(|parts, count| shade(sink, parts, count));
        }
        shade(sink, batch, count);
    };

    let width = frame.lanes.width();
    let entries = bins.entries_of(rect.position());
    for number in 0..entries.len().div_ceil(width) {
        if sink.is_opaque() {
            let precise = bins.precise_cells_of(rect.position()).count();
            counts.tiles_stopped += 1;
            counts.cells_hidden += (entries.len() - number * width + precise) as u64;
            return;
        }
        let (rows, next) = (rows.clone(), None);
        dispatch(frame.lanes, Cover { frame, bins, rect, rows, number, next, packet, edges, fragments });
        let mut from = 0;
        while from < fragments.count {
            let count = (fragments.count - from).min(BATCH);
            let codes = &fragments.codes[from..];
            dispatch(frame.lanes, Evaluate { frame, packet, codes, count, length_per_depth, batch });
            counts.segments += u64::from(batch.hits);
            send(sink, batch, count);
            from += count;
        }
    }

    // These may lie in front of what hides the others.
    let mut count = 0;
    let _ = for_each_precise(frame, bins, rect, rows, |cell, crossing, [i, j]| {
        let length_per_depth = frame.view.length_per_depth(i as f64, j as f64);
        frame.put_precise(cell, crossing, [i, j], length_per_depth, count, batch);
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

/// Finds the pixels that a vector of a tile's cells covers.
struct Cover<'a> {
    frame: &'a FrameContext<'a>,
    bins: &'a TileBins,
    rect: TileRect,
    rows: Range<usize>,
    /// Vectors of the tile's cells before this one.
    number: usize,
    /// Next free slots of the pixels' lists, where fragments go to lists.
    next: Option<&'a mut NextSlots>,
    packet: &'a mut CellPacket,
    edges: &'a mut Edges,
    fragments: &'a mut Fragments,
}

impl Kernel for Cover<'_> {
    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Cover { frame, bins, rect, rows, number, next, packet, edges, fragments } = self;
        let TileRect { left, top, size, .. } = rect;
        let screen_vertices = frame.input.screen_vertices;
        let entries = &bins.entries_of(rect.position())[number * L::WIDTH..];
        // Cells of the next vectors are prefetched one by one, so that the requests do not queue up.
        let (cells, ahead) = entries.split_at(entries.len().min(L::WIDTH));
        for (lane, &entry) in cells.iter().enumerate() {
            if let Some(&next) = ahead.get(lane) {
                for corner in bins.cell(next).corners() {
                    prefetch(screen_vertices.as_ptr().wrapping_add(corner as usize));
                }
            }
            if let Some(&later) = ahead.get(L::WIDTH + lane) {
                bins.cell(later).prefetch();
            }
            let cell = bins.cell(entry);
            packet.take(lane, cell.planes(), cell.attributes());
            edges.take(lane, cell.corners().map(|p| &screen_vertices[p as usize]));
        }
        packet.transpose::<L>(left, top);
        edges.find::<L>(left, top, &rows);
        fragments.cover::<L>(edges, cells.len(), size[0], next);
    }
}

/// Intersects fragments with their cells, into a batch.
struct Evaluate<'a> {
    frame: &'a FrameContext<'a>,
    packet: &'a CellPacket,
    codes: &'a [u16],
    count: usize,
    length_per_depth: &'a [f32; PIXELS],
    batch: &'a mut Batch,
}

impl Kernel for Evaluate<'_> {
    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Evaluate { frame, packet, codes, count, length_per_depth, batch } = self;
        // Rays that end need depths, too.
        let ordered = frame.shader.one_color.is_none() || frame.depth_limit.is_some();
        if frame.view.perspective {
            packet.evaluate::<L, true>(codes, count, length_per_depth, frame.near, ordered, batch);
        } else {
            packet.evaluate::<L, false>(codes, count, length_per_depth, frame.near, ordered, batch);
        }
    }
}

/// Intersects fragments with their cells, into lists.
struct Append<'a> {
    frame: &'a FrameContext<'a>,
    packet: &'a CellPacket,
    fragments: &'a Fragments,
    lists: &'a mut FragmentLists,
}

impl Kernel<Result<u64, Overflow>> for Append<'_> {
    /// Returns the number of fragments that cross their cells.
    #[inline(always)]
    fn run<L: Lanes>(self) -> Result<u64, Overflow> {
        let Append { frame, packet, fragments, lists } = self;
        let Fragments { codes, slots, count, .. } = fragments;
        let (slots, near, quads) = (&slots[..count + MAX_LANES], frame.near, &mut lists.quads);
        let hits = if frame.view.perspective {
            packet.append::<L, true>(codes, slots, near, quads)
        } else {
            packet.append::<L, false>(codes, slots, near, quads)
        };
        if lists.is_over_full() { Err(Overflow) } else { Ok(hits) }
    }
}
