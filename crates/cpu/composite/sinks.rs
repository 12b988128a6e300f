//! Where segments go that are shaded as they come: to sums, where no order is needed, or to lists that grow.

use crate::composite::growing_lists::{GrowingLists, Layer};
use crate::fragments::batch::Batch;
use crate::project::record::TILE;
use crate::shade::shaded::Shaded;

/// Colour and opacity of a tile's pixels.
pub(crate) type TilePicture = [[f32; 4]; TILE * TILE];

/// Where a tile's segments go.
pub(crate) trait Sink {
    /// Takes the first `count` fragments of a batch; those of no length are not segments.
    fn take(&mut self, batch: &Batch, shaded: &Shaded, count: usize);

    /// Whether nothing that may come changes any pixel.
    fn is_full(&self) -> bool {
        false
    }
}

/// Depth at which a pixel is opaque: what is missing of 1 is under 1e-11.
pub(crate) const OPAQUE_DEPTH: f32 = 25.0;

/// Sums optical depths, or composites opacities where each segment's has a factor of its own: A is then more than a
/// sum of depths, but its order does not matter either.
pub(crate) struct DepthSink<'a> {
    pub sums: &'a mut [f32; TILE * TILE],
    pub opacities: bool,
}

impl Sink for DepthSink<'_> {
    fn take(&mut self, batch: &Batch, shaded: &Shaded, count: usize) {
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

    fn is_full(&self) -> bool {
        let full = if self.opacities { 1.0 } else { OPAQUE_DEPTH };
        self.sums.iter().all(|sum| full <= *sum)
    }
}

/// A pixel of one colour from the sum of its segments' optical depths, or `opacities`.
pub(crate) fn of_one_color(color: [f32; 3], sum: f32, opacities: bool) -> [f32; 4] {
    let sum = f64::from(sum);
    let opacity = if opacities { sum } else { -(-sum).exp_m1() };
    let [r, g, b] = color.map(|c| (f64::from(c) * opacity) as f32);
    [r, g, b, opacity as f32]
}

impl Sink for GrowingLists {
    fn take(&mut self, batch: &Batch, shaded: &Shaded, count: usize) {
        for k in (0..count).filter(|&k| batch.length[k] > 0.0) {
            let rgba = [shaded.rgba[0][k], shaded.rgba[1][k], shaded.rgba[2][k], shaded.rgba[3][k]];
            let column = batch.pixel[k] as usize & (TILE - 1);
            self.push(column, Layer::new(batch.entry[k], batch.exit[k], rgba));
        }
    }
}
