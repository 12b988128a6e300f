//! Stretches of a tile's rays that the cells fill, for [`voltet_optics::depth_image`].

use crate::cast::packet::pixel_of;
use crate::composite::accumulators::{Fragment, TileAccumulator};
use crate::composite::frame::FrameContext;
use crate::tile::{PIXELS, TILE, TilePicture, TileRect};
use voltet_optics::depth_image::{Supersegment, sort_and_join};
use voltet_simd::{Float, Kernel, LaneSet, Lanes, Mask, dispatch, inlined};

/// Fraction of itself by which two depths of one face may differ that were found from both of its cells: by rounding of a plane's four
/// products, twice.
const ROUNDING: f32 = 8.0 * f32::EPSILON;

/// Stretches of a tile's pixels, row by row.
pub(crate) struct TileStretches {
    /// End of each pixel's among all.
    ends: Vec<usize>,
    stretches: Vec<Supersegment>,
    /// Difference up to which depths are the same, world units.
    pub resolution: f64,
}

impl TileStretches {
    pub fn of_pixel(&self, pixel: usize) -> &[Supersegment] {
        let start = pixel.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.stretches[start..self.ends[pixel]]
    }
}

/// Segments of a ray that came one after the other, each where the one before ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Run {
    pub entry: f32,
    pub exit: f32,
    pub rgba: [f32; 4],
}

/// Exit of a pixel's run where none is open: no segment begins there.
const NONE_OPEN: f32 = f32::NAN;

/// Exit of a slot without a segment, because the segment was cut and its parts are by themselves: the run before it ends, however thin it
/// was.
pub(crate) const WAS_CUT: f32 = f32::NAN;

/// Recorder of a tile's shaded segments. Those of a pixel that follow each other without a gap are composited as in any picture, in the
/// accumulator; where a segment begins elsewhere, what is there is taken out as a run.
pub(crate) struct StretchRecorder {
    /// Runs of each pixel that have ended.
    pixels: Vec<Vec<Run>>,
    /// Begin and end of the open run of each of the accumulator's pixels.
    entry: [f32; PIXELS],
    exit: [f32; PIXELS],
    /// Pixels of each row (bits) whose open runs end although the next segment begins there.
    ended: [u32; TILE],
    /// Pixel of the tile that each of the accumulator's is: its own, or that of a packet's ray.
    pixel_of: [u8; PIXELS],
    /// True if segments are joined: no surface lies between any.
    joins: bool,
}

#[derive(Clone, Copy)]
pub(crate) struct RowSegments<'a> {
    /// Lengths, where those of no length are none; otherwise none are those that enter at infinity.
    pub lengths: Option<&'a [f32]>,
    /// Premultiplied colours and opacities.
    pub columns: [&'a [f32]; 4],
    /// Depths of entries and exits; [`WAS_CUT`] stands among these.
    pub depths: [&'a [f32]; 2],
}

impl StretchRecorder {
    /// `has_events`: surfaces lie along the rays; `is_cast`: the accumulator's pixels are those of packets of rays.
    pub fn new(has_events: bool, is_cast: bool) -> StretchRecorder {
        let pixel_of = |slot: usize| if is_cast { pixel_of(slot / TILE, slot % TILE) } else { slot };
        StretchRecorder {
            pixels: (0..PIXELS).map(|_| Vec::new()).collect(),
            entry: [0.0; PIXELS],
            exit: [NONE_OPEN; PIXELS],
            ended: [0; TILE],
            pixel_of: std::array::from_fn(|slot| pixel_of(slot) as u8),
            joins: !has_events,
        }
    }

    pub fn clear(&mut self) {
        self.pixels.iter_mut().for_each(Vec::clear);
        (self.exit, self.ended) = ([NONE_OPEN; PIXELS], [0; TILE]);
    }

    /// Takes a segment of a pixel by itself.
    pub fn push(&mut self, pixel: usize, Fragment { rgba, entry, exit }: Fragment) {
        self.pixels[pixel].push(Run { entry, exit, rgba });
    }

    /// Blends segments, whole slices, into a row of the accumulator.
    pub fn blend(
        &mut self,
        lanes: LaneSet,
        row: usize,
        segments: RowSegments<'_>,
        pixels: &mut TileAccumulator,
    ) {
        let RowSegments { lengths, columns, depths } = segments;
        let (first, count) = (row * TILE, depths[0].len());
        debug_assert!(count.is_multiple_of(TILE), "whole slices");
        let (mut from, mut begun) = (0, 0);
        while from < count {
            let follow = FollowRuns {
                exits: &mut self.exit[first..first + TILE],
                lengths: lengths.map(|column| &column[from..]),
                depths: depths.map(|column| &column[from..]),
                begun,
                ended: self.ended[row],
                joins: self.joins,
            };
            let followed = dispatch(lanes, follow);
            let to = from + followed.slices * TILE;
            let lengths = lengths.map(|column| &column[from..to]);
            pixels.blend(lanes, row, lengths, columns.map(|column| &column[from..to]));
            for lane in (0..TILE).filter(|lane| followed.beginning >> lane & 1 != 0) {
                self.close(first + lane, pixels);
                self.entry[first + lane] = depths[0][to + lane];
            }
            self.ended[row] = followed.ended & !followed.beginning;
            (from, begun) = (to, followed.beginning);
        }
    }

    /// Ends the open run of one of the accumulator's pixels.
    fn close(&mut self, slot: usize, pixels: &mut TileAccumulator) {
        let (entry, exit) = (self.entry[slot], std::mem::replace(&mut self.exit[slot], NONE_OPEN));
        if !exit.is_nan() {
            let rgba = pixels.take_out(slot);
            self.pixels[usize::from(self.pixel_of[slot])].push(Run { entry, exit, rgba });
        }
    }

    /// Ends all open runs.
    pub fn close_all(&mut self, pixels: &mut TileAccumulator) {
        (0..PIXELS).for_each(|slot| self.close(slot, pixels));
    }

    /// Runs of each pixel that have ended.
    #[cfg(test)]
    pub fn runs(&self) -> &[Vec<Run>] {
        &self.pixels
    }

    /// The stretches of a tile that is drawn; its picture serves where all has one colour, and the order does not matter.
    pub fn finish(
        &mut self,
        frame: &FrameContext<'_>,
        rect: TileRect,
        picture: &TilePicture,
    ) -> TileStretches {
        let (length, origin) = (frame.view.length, frame.input.distance_origin);
        let farthest = self.pixels.iter().flatten().map(|own| own.exit).fold(0.0, f32::max);
        let resolution = f64::from(ROUNDING) * f64::from(farthest) * length;
        let depth = |depth: f32| (f64::from(depth) + origin) * length;
        let of = |own: &Run| Supersegment { entry: depth(own.entry), exit: depth(own.exit), rgba: own.rgba };
        let (mut ends, mut stretches, mut of_pixel) = (Vec::with_capacity(PIXELS), Vec::new(), Vec::new());
        for (pixel, runs) in self.pixels.iter().enumerate() {
            if frame.shader.one_color.is_some() {
                let own = Supersegment { entry: 0.0, exit: 0.0, rgba: picture[pixel] };
                stretches.extend((own.rgba[3] > 0.0).then_some(own));
            } else {
                let [i, j] = [rect.left + pixel % TILE, rect.top + pixel / TILE];
                let is_inside = pixel % TILE < rect.size[0] && pixel / TILE < rect.size[1];
                let events = frame.events.filter(|_| is_inside).map(|events| events.of_pixel(i, j));
                of_pixel.clear();
                of_pixel.extend(runs.iter().map(of));
                sort_and_join(&mut of_pixel, events.unwrap_or_default(), resolution);
                stretches.extend_from_slice(&of_pixel);
            }
            ends.push(stretches.len());
        }
        self.clear();
        // All tiles of the picture are held until it is drawn.
        stretches.shrink_to_fit();
        TileStretches { ends, stretches, resolution }
    }
}

/// Follows the open runs of a row's pixels through slices, up to the first in which a segment begins elsewhere than such a run ends.
struct FollowRuns<'a> {
    exits: &'a mut [f32],
    lengths: Option<&'a [f32]>,
    depths: [&'a [f32]; 2],
    /// Lanes (bits) whose runs begin in the first slice.
    begun: u32,
    /// Lanes (bits) whose runs end although the next segment begins there.
    ended: u32,
    joins: bool,
}

/// Slices through which runs were followed, the lanes (bits) whose runs begin in the next one, and those whose runs end there in any case.
struct FollowedRuns {
    slices: usize,
    beginning: u32,
    ended: u32,
}

impl Kernel<FollowedRuns> for FollowRuns<'_> {
    #[inline(always)]
    fn run<L: Lanes>(self) -> FollowedRuns {
        let FollowRuns { exits, lengths, depths: [entries, ends], mut begun, mut ended, joins } = self;
        let (zero, infinity, rounding) =
            (L::F::splat(0.0), L::F::splat(f32::INFINITY), L::F::splat(ROUNDING));
        let is_segment = inlined!(|at: usize| match lengths {
            Some(lengths) => zero.lt(L::F::load(&lengths[at..])),
            None => L::F::load(&entries[at..]).lt(infinity),
        });
        let slices = entries.len() / TILE;
        for slice in 0..slices {
            let (mut beginning, first) = (0, slice * TILE);
            for half in (0..TILE).step_by(L::WIDTH) {
                let (entry, exit) = (L::F::load(&entries[first + half..]), L::F::load(&exits[half..]));
                let follows = (entry - exit).abs().le(rounding * exit.abs());
                let follows = if joins { follows.bits() } else { 0 };
                beginning |= (is_segment(first + half).bits() & (!follows | ended >> half)) << half;
            }
            if beginning & !begun != 0 {
                return FollowedRuns { slices: slice, beginning: beginning & !begun, ended };
            }
            for half in (0..TILE).step_by(L::WIDTH) {
                let (exit, end) = (L::F::load(&exits[half..]), L::F::load(&ends[first + half..]));
                let is_segment = is_segment(first + half);
                L::F::select(is_segment, end, exit).store(&mut exits[half..]);
                // No number equals WAS_CUT, nor does it itself.
                ended |= is_segment.not().and(end.le(end).not()).bits() << half;
            }
            begun = 0;
        }
        FollowedRuns { slices, beginning: 0, ended }
    }
}
