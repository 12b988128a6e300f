//! Straight pieces of a row's segments along curved axes ([`voltet_optics::curved_axes`]): one each, or two, of which the second ones become
//! a slice of their own. Segments that need more, or meet a surface or a clip, are cut one by one.

use crate::composite::frame::FrameContext;
use crate::composite::lane_axes::{LaneAxes, LaneEnds, LanePieces};
use crate::composite::segment_parts::{SegmentCutter, pixels_of};
use crate::fragments::batch::{BATCH, Batch};
use crate::shade::light::Rays;
use crate::tile::TILE;
use std::ops::Range;
use voltet_simd::{Float, Kernel, Lanes, Mask, Unsigned, array, dispatch};

/// Fills a batch with straight pieces of the segments of another, slices of a row, from one slot on as far as there is room. Returns the slot
/// to go on from, the count of segments in the batch, and the slots and colours of those that were cut.
pub(super) fn straighten<'c>(
    cutter: &'c mut SegmentCutter,
    frame: &FrameContext<'_>,
    axes: &LaneAxes,
    (source, slots): (&Batch, Range<usize>),
    batch: &mut Batch,
    rays: &Rays,
) -> (usize, usize, &'c [(usize, [f32; 4])]) {
    cutter.forget();
    let pixels = pixels_of(source, slots.end);
    let row = StraightenRow { cutter, frame, axes, source, slots, batch, pixels, rays };
    let (next, count) = dispatch(frame.lanes, row);
    (next, count, cutter.finish(frame, rays))
}

/// Straightening of a row's slices, see [`straighten`].
struct StraightenRow<'a, 'f> {
    cutter: &'a mut SegmentCutter,
    frame: &'a FrameContext<'f>,
    axes: &'a LaneAxes,
    source: &'a Batch,
    slots: Range<usize>,
    batch: &'a mut Batch,
    pixels: [usize; TILE],
    rays: &'a Rays,
}

impl Kernel<(usize, usize)> for StraightenRow<'_, '_> {
    #[inline(always)]
    fn run<L: Lanes>(mut self) -> (usize, usize) {
        let mut depths = self.pixels.map(|pixel| self.cutter.next_depth(pixel));
        let mut shown = self.pixels.map(|pixel| self.cutter.shown(pixel));
        let (zero, mut filled) = (L::F::splat(0.0), 0);
        let mut next = self.slots.start;
        while next < self.slots.end && filled + 2 * TILE <= BATCH {
            let (mut cut, mut straight, mut paired) = (0, 0, 0);
            for lane in (0..TILE).step_by(L::WIDTH) {
                let from = next + lane;
                let exit = L::F::load(&self.source.exit[from..]);
                let is_there = zero.lt(L::F::load(&self.source.length[from..]));
                let pieces = self.axes.pieces::<L>(self.source, from);
                let is_met = L::F::load(&depths[lane..]).lt(exit);
                let is_shown = zero.lt(L::F::load(&shown[lane..]));
                let is_plain = is_met.not().and(pieces.is_pair.or(pieces.is_drawn.not()));
                cut |= is_there.and(is_plain.not()).and(is_met.or(is_shown)).bits() << lane;
                let is_kept = is_there.and(is_plain).and(is_shown).and(pieces.is_drawn);
                let is_paired = is_kept.and(pieces.is_straight.not());
                straight |= is_kept.bits() << lane;
                paired |= is_paired.bits() << lane;
                self.put_pieces::<L>(&pieces, [is_kept, is_paired], [from, filled + lane]);
            }
            if cut != 0 {
                for lane in (0..TILE).filter(|lane| cut >> lane & 1 == 1) {
                    let slots = [next, filled].map(|first| first + lane);
                    self.cutter.cut(self.frame, self.source, slots, self.pixels[lane], self.rays);
                }
                depths = self.pixels.map(|pixel| self.cutter.next_depth(pixel));
                shown = self.pixels.map(|pixel| self.cutter.shown(pixel));
            }
            filled += TILE * (usize::from(cut | straight != 0) + usize::from(paired != 0));
            next += TILE;
        }
        (next, filled)
    }
}

impl StraightenRow<'_, '_> {
    /// Puts the first, or only, pieces of segments in the slots from `to` on, and the second ones a slice behind; those without are empty.
    #[inline(always)]
    fn put_pieces<L: Lanes>(
        &mut self,
        pieces: &LanePieces<L>,
        [is_kept, is_paired]: [L::M; 2],
        [from, to]: [usize; 2],
    ) {
        let StraightenRow { frame, source, batch, .. } = self;
        let (zero, half) = (L::F::splat(0.0), L::F::splat(0.5));
        let second = to + TILE;
        let length = L::F::load(&source.length[from..]);
        let first_length = L::F::select(is_paired, length * half, length);
        L::F::select(is_kept, first_length, zero).store(&mut batch.length[to..]);
        L::F::select(is_paired, first_length, zero).store(&mut batch.length[second..]);
        let pixel = L::U::load(&source.pixel[from..]);
        pixel.store(&mut batch.pixel[to..]);
        pixel.store(&mut batch.pixel[second..]);
        if frame.needs_depths() {
            let (entry, exit) = (L::F::load(&source.entry[from..]), L::F::load(&source.exit[from..]));
            let middle = (entry + exit) * half;
            entry.store(&mut batch.entry[to..]);
            L::F::select(is_paired, middle, exit).store(&mut batch.exit[to..]);
            middle.store(&mut batch.entry[second..]);
            exit.store(&mut batch.exit[second..]);
        }
        for a in 0..frame.attribute_count() {
            let (front, back) = (L::F::load(&source.front[a][from..]), L::F::load(&source.back[a][from..]));
            let (front, middles, back) = match pieces.ends.get(a) {
                // Of slots without a segment positions are not defined.
                Some(Some(LaneEnds(ends))) => {
                    let [front, middle, back]: [L::F; 3] = array!(|k| L::F::select(is_kept, ends[k], zero));
                    (front, [middle; 2], back)
                }
                // A piece has the gradient of all of its part.
                _ if a >= frame.scalar_count => (front, [back, front], back),
                _ => (front, [(front + back) * half; 2], back),
            };
            front.store(&mut batch.front[a][to..]);
            L::F::select(is_paired, middles[0], back).store(&mut batch.back[a][to..]);
            middles[1].store(&mut batch.front[a][second..]);
            back.store(&mut batch.back[a][second..]);
        }
    }
}
