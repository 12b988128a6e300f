//! Stretches of a tile's rays that the cells fill, for [`voltet_optics::depth_image`].

use crate::composite::accumulators::Fragment;
use crate::composite::frame::FrameContext;
use crate::fragments::batch::Batch;
use crate::shade::shaded_batch::ShadedBatch;
use crate::tile::{PIXELS, TILE, TilePicture, TileRect};
use voltet_optics::depth_image::{Supersegment, sort_and_join};

/// Roundings by which two depths of one face may differ that were found from both of its cells: of a plane's four products, twice.
const ROUNDINGS: f64 = 8.0;

/// Stretches of a tile's pixels, row by row.
pub(crate) struct TileStretches {
    pub pixels: Vec<Vec<Supersegment>>,
    /// Difference up to which depths are the same, world units.
    pub resolution: f64,
}

/// Recorder of a tile's shaded segments.
pub(crate) struct StretchRecorder {
    pixels: Vec<Vec<Fragment>>,
}

impl StretchRecorder {
    pub fn new() -> StretchRecorder {
        StretchRecorder { pixels: vec![Vec::new(); PIXELS] }
    }

    pub fn clear(&mut self) {
        self.pixels.iter_mut().for_each(Vec::clear);
    }

    pub fn push(&mut self, pixel: usize, fragment: Fragment) {
        self.pixels[pixel].push(fragment);
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
        let stretches = |pixel: usize| {
            if frame.shader.one_color.is_some() {
                let own = Supersegment { entry: 0.0, exit: 0.0, rgba: picture[pixel] };
                return Vec::from_iter((own.rgba[3] > 0.0).then_some(own));
            }
            let of = |own: &Fragment| Supersegment {
                entry: depth(own.entry),
                exit: depth(own.exit),
                rgba: own.rgba,
            };
            let mut all: Vec<Supersegment> = self.pixels[pixel].iter().map(of).collect();
            let [i, j] = [rect.left + pixel % TILE, rect.top + pixel / TILE];
            let is_inside = pixel % TILE < rect.size[0] && pixel / TILE < rect.size[1];
            let events = frame.events.filter(|_| is_inside).map(|events| events.of_pixel(i, j));
            sort_and_join(&mut all, events.unwrap_or_default(), resolution);
            all
        };
        let pixels = (0..PIXELS).map(stretches).collect();
        self.clear();
        TileStretches { pixels, resolution }
    }
}
