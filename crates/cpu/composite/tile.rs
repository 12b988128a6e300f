//! One tile: its cells to segments, in lists that are put in order or as they come, and these to pixels.

use crate::cast::Cast;
use crate::cast::bundle::{Bundle, WAYS, next, pixel_of};
use crate::composite::cells::{list, list64, walk};
use crate::composite::front_to_back::{ListSlices, Slices};
use crate::composite::growing_lists::GrowingLists;
use crate::composite::kernels::Arrange;
use crate::composite::lists::{Lists, Overflow};
use crate::composite::rows::{RowSums, Rows};
use crate::composite::scratch::{Bounds, Scratch};
use crate::composite::sinks::{DepthSink, OPAQUE_DEPTH, TilePicture, of_one_color};
use crate::kept::{Keeper, Keeping, KeptTile};
use crate::project::record::TILE;
use crate::sample::Frame;
use voltet_simd::dispatch;

/// Draws a tile from cells or from cached segments.
pub(crate) fn draw_tile(
    frame: &Frame<'_>,
    tile: usize,
    scratch: &mut Scratch,
    lists: &mut Lists,
    picture: &mut TilePicture,
) {
    let bounds = Bounds::of(frame, tile);
    scratch.begin(frame, bounds);
    if let Some(color) = frame.shader.one_color {
        draw_in_one_color(frame, bounds, color, scratch, picture);
        return;
    }
    if let Some(kept) = frame.kept {
        let mut rows = Rows::new();
        if let Some(kept) = kept.tile(tile) {
            for row in 0..bounds.size[1] {
                let mut slices = Slices::Kept(kept.slices(row, frame.scalar_count));
                scratch.shading.blend(frame, row, &mut slices, &mut rows);
                scratch.counts.segments += slices.segments();
            }
        }
        scratch.shading.end(frame, &mut rows);
        rows.end(picture);
        return;
    }
    scratch.counts.tiles_sorted += u64::from(frame.sorted);
    let before = scratch.counts;
    if draw_in_lists(frame, bounds, scratch, lists, picture).is_err() {
        // Rows are independent: draw them one at a time with lists that grow.
        scratch.counts = before;
        scratch.counts.tiles_deep += 1;
        let mut growing = GrowingLists::default();
        for row in 0..bounds.size[1] {
            growing.clear();
            walk(frame, bounds, row..row + 1, scratch, &mut growing);
            scratch.counts.pixels_disordered +=
                growing.composite(frame.sorted, &mut picture[row * TILE..][..TILE]);
        }
    }
}

/// Draws a tile by rays from cell to cell; whether none was lost on the way.
pub(crate) fn cast_tile(
    frame: &Frame<'_>,
    cast: &Cast,
    tile: usize,
    scratch: &mut Scratch,
    picture: &mut TilePicture,
) -> bool {
    let bounds @ Bounds { left, top, size, .. } = Bounds::of(frame, tile);
    scratch.begin(frame, bounds);
    let Scratch { shading, entered, further, stretch, counts, .. } = scratch;
    entered.find(cast, frame.lanes, tile, [left, top], size);
    let opacities = frame.shader.surface.is_some();
    let (mut rows, mut depth) = (Rows::new(), [0.0; TILE * TILE]);
    let (mut on_way, mut stopped) = (0, 0);
    let mut bundles: [Bundle<'_>; WAYS] = std::array::from_fn(|_| Bundle::new(frame, cast, entered));
    for first in (0..TILE).step_by(WAYS) {
        bundles.iter_mut().zip(first..).for_each(|(bundle, number)| bundle.begin(number, bounds, stretch));
        on_way += bundles.iter().filter(|bundle| bundle.goes_on()).count();
        loop {
            let [batch_1, batch_2, batch_3] = &mut *further;
            let found = next(frame, &mut bundles, [&mut shading.batch, batch_1, batch_2, batch_3]);
            if found == [0; WAYS] {
                break;
            }
            for ((k, bundle), count) in bundles.iter_mut().enumerate().zip(found) {
                let number = first + k;
                if k > 0 {
                    std::mem::swap(&mut shading.batch, &mut further[k - 1]);
                }
                if count > 0 {
                    let is_full = if frame.shader.one_color.is_some() {
                        let mut sums = RowSums { sums: &mut depth, opacities };
                        shading.sum_batch(frame, number, count, &mut sums);
                        sums.is_full(number)
                    } else {
                        shading.blend_batch(frame, number, count, &mut rows);
                        shading.hides(number, &rows)
                    };
                    if is_full && !frame.whole && bundle.goes_on() {
                        bundle.stop();
                        stopped += 1;
                    }
                }
            }
        }
        if bundles.iter().any(|bundle| bundle.is_lost) {
            shading.end(frame, &mut rows);
            return false;
        }
        if shading.layers.are_many() {
            shading.end(frame, &mut rows);
        }
    }
    shading.end(frame, &mut rows);
    counts.segments += bundles.iter().map(|bundle| bundle.segments).sum::<u64>();
    counts.tiles_stopped += u64::from(on_way > 0 && stopped == on_way);
    for place in 0..TILE * TILE {
        let pixel = &mut picture[pixel_of(place / TILE, place % TILE)];
        *pixel = match frame.shader.one_color {
            Some(color) => of_one_color(color, depth[place], opacities),
            None => rows.pixel(place),
        };
    }
    true
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
                let mut slices = Slices::Kept(kept.slices(row, frame.scalar_count));
                let mut sums = RowSums { sums: &mut depth, opacities };
                scratch.shading.sum(frame, row, &mut slices, &mut sums);
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

/// Draws a tile by lists. Errors: a pixel has too many segments.
fn draw_in_lists(
    frame: &Frame<'_>,
    bounds: Bounds,
    scratch: &mut Scratch,
    lists: &mut Lists,
    picture: &mut TilePicture,
) -> Result<(), Overflow> {
    let mut rows = Rows::new();
    lists.clear(frame.attribute_count);
    list64(frame, bounds, scratch, lists)?;
    list(frame, frame.entries_of(bounds.tile), bounds, scratch, lists)?;
    for row in 0..bounds.size[1] {
        scratch.counts.pixels_disordered +=
            dispatch(frame.lanes, Arrange { lists, row, sorted: frame.sorted });
        let slices = ListSlices::new(lists, row, &scratch.stretch);
        scratch.shading.blend(frame, row, &mut Slices::Lists(slices), &mut rows);
    }
    scratch.shading.end(frame, &mut rows);
    rows.end(picture);
    Ok(())
}

/// Keeps a tile's segments; gives up where they are too many.
pub(crate) fn keep_tile(
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
        .and_then(|()| list(frame, frame.entries_of(tile), bounds, scratch, lists));
    if listed.is_err() {
        keeping.give_up();
        return None;
    }
    let mut keeper = Keeper::new(frame.scalar_count);
    for row in 0..bounds.size[1] {
        dispatch(frame.lanes, Arrange { lists, row, sorted: true });
        let mut slices = ListSlices::new(lists, row, &scratch.stretch);
        let batch = &mut scratch.shading.batch;
        loop {
            let count = slices.next(frame.lanes, false, batch);
            if count == 0 {
                break;
            }
            keeper.take(row, batch, count);
        }
    }
    keeper.end(keeping)
}
