//! One tile: segments from its source, in visibility order or as they come, to pixels.

use crate::cast::RayCaster;
use crate::cast::packet::{PACKETS_IN_FLIGHT, RayPacket, pixel_of};
use crate::cast::traversal::{PacketConfig, next_segments};
use crate::composite::accumulators::{Fragment, TileAccumulator, TilePixels, UnboundedFragmentLists};
use crate::composite::fragment_lists::{Arrange, FragmentLists, Overflow};
use crate::composite::frame::FrameContext;
use crate::composite::projected_cells::{fill_lists, walk};
use crate::composite::row_shader::{ListedSlices, Scratch};
use crate::composite::segment_parts::surfaces_of;
use crate::composite::stretches::StretchRecorder;
use crate::fragments::batch::Batch;
use crate::project::tile_bins::TileBins;
use crate::segment_cache::{CacheBudget, CachedTile, SegmentCache};
use crate::tile::{PIXELS, TILE, TilePicture, TileRect};
use crate::tolerances::OPAQUE_OPTICAL_DEPTH;
use voltet_simd::dispatch;

pub(crate) fn draw_projected(
    frame: &FrameContext<'_>,
    bins: &TileBins,
    tile: usize,
    scratch: &mut Scratch,
    lists: &mut FragmentLists,
    picture: &mut TilePicture,
) {
    let rect = scratch.begin(frame, tile);
    let mut pixels = TilePixels::new(frame.shader, opaque_outside(rect));
    if let TilePixels::OneColor(_, depths) = &mut pixels {
        walk(frame, bins, rect, 0..rect.size[1], scratch, depths);
        return pixels.store(picture);
    }
    scratch.counts.tiles_sorted += u64::from(frame.sorted);
    let before = scratch.counts;
    if draw_in_lists(frame, bins, rect, scratch, lists, picture).is_err() {
        // Rows are independent: draw them one at a time with lists that grow.
        scratch.counts = before;
        scratch.counts.tiles_deep += 1;
        scratch.row_shader.recorder.iter_mut().for_each(StretchRecorder::clear);
        let mut growing = UnboundedFragmentLists::default();
        for row in 0..rect.size[1] {
            growing.clear();
            walk(frame, bins, rect, row..row + 1, scratch, &mut growing);
            if let Some(recorder) = &mut scratch.row_shader.recorder {
                for (column, fragments) in growing.pixels().iter().enumerate() {
                    fragments.iter().for_each(|own| recorder.push(row * TILE + column, *own));
                }
            }
            for column in 0..rect.size[0] {
                for (depth, rgba) in surfaces_of(frame, [rect.left + column, rect.top + row]) {
                    growing.push(column, Fragment::new(depth, depth, rgba));
                }
            }
            scratch.counts.pixels_disordered +=
                growing.composite(frame.sorted, &mut picture[row * TILE..][..TILE]);
        }
        return;
    }
    scratch.row_shader.end_events(frame, picture);
}

pub(crate) fn draw_cached(
    frame: &FrameContext<'_>,
    cache: &SegmentCache,
    tile: usize,
    scratch: &mut Scratch,
    picture: &mut TilePicture,
) {
    let rect = scratch.begin(frame, tile);
    let mut pixels = TilePixels::new(frame.shader, opaque_outside(rect));
    if let Some(cached) = cache.tile(tile) {
        for row in 0..rect.size[1] {
            let mut slices = cached.slices(row, frame.scalar_count);
            scratch.row_shader.blend(frame, row, &mut |batch| slices.next(batch), &mut pixels);
            scratch.counts.segments += slices.segments;
        }
    }
    scratch.row_shader.store(frame, pixels, picture);
}

/// Draws a tile by rays from cell to cell. Returns false if a ray was mistracked on the way.
pub(crate) fn draw_cast(
    frame: &FrameContext<'_>,
    caster: &RayCaster,
    tile: usize,
    scratch: &mut Scratch,
    picture: &mut TilePicture,
) -> bool {
    let rect = scratch.begin(frame, tile);
    let Scratch { row_shader, hits, further, length_per_depth, counts, .. } = scratch;
    hits.find(caster, frame.lanes, rect);
    let mut pixels = TilePixels::new(frame.shader, [0.0; PIXELS]);
    let (mut entered, mut terminated) = (0, 0);
    let config = PacketConfig {
        lanes: frame.lanes,
        attribute_count: frame.attribute_count(),
        depths: frame.needs_depths(),
    };
    let distance_origin = frame.input.distance_origin;
    let mut packets: [RayPacket<'_>; PACKETS_IN_FLIGHT] =
        std::array::from_fn(|_| RayPacket::new(caster, hits, distance_origin));
    for first in (0..TILE).step_by(PACKETS_IN_FLIGHT) {
        for (packet, number) in packets.iter_mut().zip(first..) {
            packet.begin(number, rect, length_per_depth);
        }
        entered += packets.iter().filter(|packet| packet.is_active()).count();
        loop {
            let [batch_1, batch_2, batch_3] = &mut *further;
            let batches = [&mut row_shader.batch, batch_1, batch_2, batch_3];
            let counts = next_segments(config, &mut packets, batches);
            if counts == [0; PACKETS_IN_FLIGHT] {
                break;
            }
            for ((k, packet), count) in packets.iter_mut().enumerate().zip(counts) {
                let number = first + k;
                if k > 0 {
                    std::mem::swap(&mut row_shader.batch, &mut further[k - 1]);
                }
                if count > 0 {
                    row_shader.blend_batch(frame, number, count, &mut pixels);
                    let is_opaque = row_shader.is_opaque(number, &pixels);
                    if is_opaque && !frame.exhaustive && packet.is_active() {
                        packet.stop();
                        terminated += 1;
                    }
                }
            }
        }
        if packets.iter().any(|packet| packet.is_mistracked) {
            row_shader.end(frame, &mut pixels);
            return false;
        }
        if row_shader.deferred.is_large() {
            row_shader.end(frame, &mut pixels);
        }
    }
    let mut by_packet = [[0.0; 4]; PIXELS];
    row_shader.store(frame, pixels, &mut by_packet);
    counts.segments += packets.iter().map(|packet| packet.segments).sum::<u64>();
    counts.tiles_stopped += u64::from(entered > 0 && terminated == entered);
    for (slot, pixel) in by_packet.iter().enumerate() {
        picture[pixel_of(slot / TILE, slot % TILE)] = *pixel;
    }
    row_shader.end_events(frame, picture);
    true
}

/// Sums of optical depth before any segment: opaque in pixels beyond the picture's edge, which nothing is added to.
fn opaque_outside(rect: TileRect) -> [f32; PIXELS] {
    let is_outside = |pixel: usize| rect.size[0] <= pixel % TILE || rect.size[1] <= pixel / TILE;
    std::array::from_fn(|pixel| if is_outside(pixel) { OPAQUE_OPTICAL_DEPTH } else { 0.0 })
}

/// Draws a tile by lists. Errors: a pixel has too many segments.
fn draw_in_lists(
    frame: &FrameContext<'_>,
    bins: &TileBins,
    rect: TileRect,
    scratch: &mut Scratch,
    lists: &mut FragmentLists,
    picture: &mut TilePicture,
) -> Result<(), Overflow> {
    let mut pixels = TilePixels::Colors(TileAccumulator::new());
    fill_lists(frame, bins, rect, scratch, lists)?;
    for row in 0..rect.size[1] {
        scratch.counts.pixels_disordered +=
            dispatch(frame.lanes, Arrange { lists, row, sorted: frame.sorted });
        let mut slices = ListedSlices::new(lists, row, &scratch.length_per_depth);
        let mut next = |batch: &mut Batch| slices.next(frame.lanes, frame.needs_depths(), batch);
        scratch.row_shader.blend(frame, row, &mut next, &mut pixels);
    }
    scratch.row_shader.store(frame, pixels, picture);
    Ok(())
}

/// Records a tile's segments; exhausts the budget where they are too many.
pub(crate) fn record_tile(
    frame: &FrameContext<'_>,
    bins: &TileBins,
    tile: usize,
    scratch: &mut Scratch,
    lists: &mut FragmentLists,
    budget: &CacheBudget,
) -> Option<CachedTile> {
    let rect = scratch.begin(frame, tile);
    if fill_lists(frame, bins, rect, scratch, lists).is_err() {
        budget.exhaust();
        return None;
    }
    let mut recorded = CachedTile::default();
    for row in 0..rect.size[1] {
        dispatch(frame.lanes, Arrange { lists, row, sorted: true });
        let mut slices = ListedSlices::new(lists, row, &scratch.length_per_depth);
        let batch = &mut scratch.row_shader.batch;
        loop {
            let count = slices.next(frame.lanes, false, batch);
            if count == 0 {
                break;
            }
            recorded.record(row, batch, count);
        }
    }
    budget.take(recorded)
}
