//! Sinks of segments that are shaded as they come: sums, where no order is needed, or lists that grow.

use crate::composite::unbounded_lists::{Fragment, UnboundedFragmentLists};
use crate::fragments::batch::Batch;
use crate::shade::shaded_batch::ShadedBatch;
use crate::tile::{PIXELS, TILE, TilePicture};
use crate::tolerances::OPAQUE_OPTICAL_DEPTH;

/// Destination of a tile's segments.
pub(crate) trait Sink {
    /// Takes the first `count` fragments of a batch; those of no length are not segments.
    fn take(&mut self, batch: &Batch, shaded: &ShadedBatch, count: usize);

    /// True if no further segment changes any pixel.
    fn is_opaque(&self) -> bool {
        false
    }
}

/// Sums optical depths, or composites opacities where each segment's has a factor of its own: A is then more than a
/// sum of depths, but its order does not matter either.
pub(crate) struct OpticalDepthSink<'a> {
    pub sums: &'a mut [f32; PIXELS],
    pub opacities: bool,
}

impl Sink for OpticalDepthSink<'_> {
    fn take(&mut self, batch: &Batch, shaded: &ShadedBatch, count: usize) {
        // Fragments of no length have no depth: no test.
        let segments = batch.pixel[..count].iter().zip(&shaded.depth[..count]);
        if self.opacities {
            for (&pixel, &opacity) in segments {
                let sum = &mut self.sums[usize::from(pixel as u8)];
                *sum += (1.0 - *sum) * opacity;
            }
        } else {
            for (&pixel, &depth) in segments {
                self.sums[usize::from(pixel as u8)] += depth;
            }
        }
    }

    fn is_opaque(&self) -> bool {
        let full = if self.opacities { 1.0 } else { OPAQUE_OPTICAL_DEPTH };
        self.sums.iter().all(|sum| full <= *sum)
    }
}

/// Stores pixels of one colour from the sums of their segments' optical depths, or `opacities`.
pub(crate) fn in_one_color(
    color: [f32; 3],
    sums: &[f32; PIXELS],
    opacities: bool,
    picture: &mut TilePicture,
) {
    for (pixel, &sum) in picture.iter_mut().zip(sums) {
        *pixel = pixel_in_one_color(color, sum, opacities);
    }
}

/// Colour and opacity of a pixel of one colour.
pub(crate) fn pixel_in_one_color(color: [f32; 3], sum: f32, opacities: bool) -> [f32; 4] {
    let sum = f64::from(sum);
    let opacity = if opacities { sum } else { -(-sum).exp_m1() };
    let [r, g, b] = color.map(|c| (f64::from(c) * opacity) as f32);
    [r, g, b, opacity as f32]
}

impl Sink for UnboundedFragmentLists {
    fn take(&mut self, batch: &Batch, shaded: &ShadedBatch, count: usize) {
        for k in (0..count).filter(|&k| batch.length[k] > 0.0) {
            let rgba = [shaded.rgba[0][k], shaded.rgba[1][k], shaded.rgba[2][k], shaded.rgba[3][k]];
            let column = batch.pixel[k] as usize & (TILE - 1);
            self.push(column, Fragment::new(batch.entry[k], batch.exit[k], rgba));
        }
    }
}
