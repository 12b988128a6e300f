//! Sinks of segments that are shaded as they come: sums, where no order is needed, or lists of any length, for pixels with more segments
//! than the fixed lists hold.

use crate::composite::fragment_lists::is_behind;
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

/// A shaded segment.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Fragment {
    /// Premultiplied colour and opacity.
    pub rgba: [f32; 4],
    /// Depth of the entry.
    pub entry: f32,
    /// Depth of the exit.
    pub exit: f32,
}

impl Fragment {
    pub fn new(entry: f32, exit: f32, rgba: [f32; 4]) -> Fragment {
        Fragment { rgba, entry, exit }
    }

    /// True if this segment comes behind the other: [`is_behind`].
    fn is_behind(&self, other: &Fragment) -> bool {
        is_behind([self.entry, self.exit], [other.entry, other.exit])
    }
}

/// Fragment lists of one row of pixels.
#[derive(Default)]
pub(crate) struct UnboundedFragmentLists {
    pixels: [Vec<Fragment>; TILE],
    /// Transmittance of each pixel.
    pub transmittance: [f64; TILE],
}

impl UnboundedFragmentLists {
    pub fn clear(&mut self) {
        self.pixels.iter_mut().for_each(Vec::clear);
    }

    pub fn push(&mut self, column: usize, fragment: Fragment) {
        self.pixels[column].push(fragment);
    }

    /// Composites the row; returns the pixels whose segments were not in order.
    pub fn composite(&mut self, sorted: bool, out: &mut [[f32; 4]]) -> u64 {
        let mut disordered = 0;
        for ((fragments, transmittance), out) in self.pixels.iter_mut().zip(&mut self.transmittance).zip(out)
        {
            if sorted {
                fragments.sort_by(|a, b| a.entry.total_cmp(&b.entry).then_with(|| a.exit.total_cmp(&b.exit)));
                for k in 1..fragments.len() {
                    let mut to = k;
                    while to > 0 && fragments[to - 1].is_behind(&fragments[to]) {
                        fragments.swap(to - 1, to);
                        to -= 1;
                    }
                }
            } else {
                disordered += u64::from(!fragments.is_sorted_by(|a, b| a.entry <= b.entry));
            }
            // Thousands of fragments: 64-bit sums.
            let (mut color, mut through) = ([0f64; 3], 1f64);
            for fragment in fragments.iter() {
                for (sum, c) in color.iter_mut().zip(fragment.rgba) {
                    *sum += through * f64::from(c);
                }
                through *= 1.0 - f64::from(fragment.rgba[3]);
            }
            *transmittance = through;
            *out = [color[0] as f32, color[1] as f32, color[2] as f32, (1.0 - through) as f32];
        }
        disordered
    }
}
