//! Stretches of a tile's rays that the cells fill, for [`voltet_optics::depth_image`].

use crate::composite::accumulators::Fragment;
use crate::composite::frame::FrameContext;
use crate::fragments::batch::Batch;
use crate::shade::shaded_batch::ShadedBatch;
use crate::tile::{PIXELS, TILE, TilePicture, TileRect};
use voltet_optics::depth_image::{Supersegment, composite_behind, sort_and_join};

/// Roundings by which two depths of one face may differ that were found from both of its cells: of a plane's four products, twice.
const ROUNDINGS: f64 = 8.0;

/// Stretches of a tile's pixels, row by row.
pub(crate) struct TileStretches {
    /// End of each pixel's among all.
    ends: Vec<usize>,
    stretches: Vec<Supersegment>,
    /// Difference up to which depths are the same, world units.
    pub resolution: f64,
}

impl TileStretches {
    /// The stretches of a pixel.
    pub fn of_pixel(&self, pixel: usize) -> &[Supersegment] {
        let start = pixel.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.stretches[start..self.ends[pixel]]
    }
}

/// Segments of a ray that came one after the other, each where the one before ends.
struct Run {
    entry: f32,
    exit: f32,
    rgba: [f64; 4],
}

/// Recorder of a tile's shaded segments.
pub(crate) struct StretchRecorder {
    pixels: Vec<Vec<Run>>,
    /// True if segments are joined as they come: no surface lies between any.
    joins: bool,
}

impl StretchRecorder {
    /// `has_events`: surfaces lie along the rays.
    pub fn new(has_events: bool) -> StretchRecorder {
        StretchRecorder { pixels: (0..PIXELS).map(|_| Vec::new()).collect(), joins: !has_events }
    }

    pub fn clear(&mut self) {
        self.pixels.iter_mut().for_each(Vec::clear);
    }

    pub fn push(&mut self, pixel: usize, fragment: Fragment) {
        let Fragment { rgba, entry, exit } = fragment;
        match self.pixels[pixel].last_mut().filter(|last| self.joins && last.exit == entry) {
            Some(last) => {
                composite_behind(&mut last.rgba, rgba);
                last.exit = exit;
            }
            None => self.pixels[pixel].push(Run { entry, exit, rgba: rgba.map(f64::from) }),
        }
    }

    /// Takes the first `count` segments of a batch, but for those that were cut.
    pub fn take(&mut self, batch: &Batch, shaded: &ShadedBatch, count: usize, cut: &[(usize, [f32; 4])]) {
        for k in (0..count).filter(|&k| batch.length[k] > 0.0) {
            if cut.iter().all(|(slot, _)| *slot != k) {
                self.push(batch.pixel[k] as usize % PIXELS, Fragment::of(batch, shaded, k));
            }
        }
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
        let resolution = ROUNDINGS * f64::from(f32::EPSILON) * f64::from(farthest) * length;
        let depth = |depth: f32| (f64::from(depth) + origin) * length;
        let of = |own: &Run| Supersegment {
            entry: depth(own.entry),
            exit: depth(own.exit),
            rgba: own.rgba.map(|value| value as f32),
        };
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
