//! A tile's cells in grid order, as many at a time as there are lanes: spans of all become one dense list of fragments
//! ([`crate::fragments::spans`]), these are intersected ([`crate::fragments::crossing`]), and the segments go to per-pixel lists
//! ([`super::lists`]) or, shaded as they come, to a sink.

use crate::composite::front_to_back::Shading;
use crate::composite::kernels::{Append, Cover, Evaluate, Illuminate};
use crate::composite::lists::{Lists, Overflow};
use crate::composite::scratch::{Bounds, Scratch};
use crate::composite::sinks::Sink;
use crate::fragments::batch::{BATCH, Batch};
use crate::fragments::ends::cut;
use crate::project::cell64::{Cell64, Crossing64};
use crate::sample::Frame;
use crate::shade::roads::integrate;
use std::ops::Range;
use voltet_simd::dispatch;

/// Appends the segments of a tile's cells to its lists. Errors: a pixel has too many.
pub(crate) fn list(
    frame: &Frame<'_>,
    entries: &[u32],
    Bounds { left, top, size, .. }: Bounds,
    scratch: &mut Scratch,
    lists: &mut Lists,
) -> Result<(), Overflow> {
    let Scratch { fragments, edges, group, counts, .. } = scratch;
    let width = frame.lanes.width();
    for (number, cells) in entries.chunks(width).enumerate() {
        let ahead = &entries[((number + 1) * width).min(entries.len())..];
        let (right, rows) = (left + size[0], 0..size[1]);
        let next = Some(&mut lists.next);
        let cover = Cover {
            frame,
            cells,
            ahead,
            left,
            top,
            right,
            rows,
            next,
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
pub(crate) fn list64(
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
pub(crate) fn walk<S: Sink>(
    frame: &Frame<'_>,
    bounds: Bounds,
    rows: Range<usize>,
    scratch: &mut Scratch,
    sink: &mut S,
) {
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
            Cover { frame, cells, ahead, left, top, right, rows, next: None, group, edges, fragments },
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
