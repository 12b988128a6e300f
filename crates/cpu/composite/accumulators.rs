//! Accumulators of a tile's pixels: colours front to back, those of a row side by side; and sinks of segments that are shaded as they come,
//! sums where no order is needed, or lists of any length, for pixels with more segments than the fixed lists hold.

use crate::composite::fragment_lists::is_behind;
use crate::fragments::batch::Batch;
use crate::shade::shaded_batch::ShadedBatch;
use crate::shade::shader::Shader;
use crate::tile::{PIXELS, TILE, TilePicture};
use crate::tolerances::{MIN_TRANSMITTANCE, OPAQUE_OPTICAL_DEPTH};
use voltet_simd::{Float, Kernel, LaneSet, Lanes, array, dispatch};

/// Colour and transmittance of a tile's pixels.
pub(crate) struct TileAccumulator {
    /// Premultiplied colour and opacity.
    rgba: [[f32; PIXELS]; 4],
    /// Errors of the sums by rounding.
    rounded: [[f32; PIXELS]; 4],
    transmittance: [f32; PIXELS],
    /// Error of the transmittances by rounding: the product of thousands of numbers just below 1 is off by that much.
    rest: [f32; PIXELS],
    /// Transmittance of what was taken out.
    before: [f32; PIXELS],
}

impl TileAccumulator {
    pub fn new() -> TileAccumulator {
        TileAccumulator {
            rgba: [[0.0; PIXELS]; 4],
            rounded: [[0.0; PIXELS]; 4],
            transmittance: [1.0; PIXELS],
            rest: [0.0; PIXELS],
            before: [1.0; PIXELS],
        }
    }

    /// Stores colour and opacity of all pixels.
    pub fn store(&self, picture: &mut TilePicture) {
        for (pixel, out) in picture.iter_mut().enumerate() {
            *out = self.color(pixel);
        }
    }

    /// Colour and opacity of a pixel.
    fn color(&self, pixel: usize) -> [f32; 4] {
        let [r, g, b, a] = [0, 1, 2, 3].map(|c: usize| self.rgba[c][pixel] + self.rounded[c][pixel]);
        [r, g, b, a.min(1.0)]
    }

    /// Takes out colour and opacity of a pixel: what is blended further comes behind.
    pub fn take_out(&mut self, pixel: usize) -> [f32; 4] {
        self.before[pixel] *= std::mem::replace(&mut self.transmittance[pixel], 1.0);
        self.rest[pixel] = 0.0;
        let color = self.color(pixel);
        self.rgba.iter_mut().chain(&mut self.rounded).for_each(|column| column[pixel] = 0.0);
        color
    }

    /// Notes that what is blended further into a pixel lies behind something of an opacity.
    pub fn hide(&mut self, pixel: usize, opacity: f32) {
        self.before[pixel] *= 1.0 - opacity;
    }

    /// Transmittance of each pixel in a row; values below [`MIN_TRANSMITTANCE`] are not meaningful.
    pub fn transmittance(&self, row: usize) -> [f32; TILE] {
        std::array::from_fn(|column| {
            self.before[row * TILE + column] * self.transmittance[row * TILE + column]
        })
    }

    /// True if no further segment changes any pixel of a row.
    pub fn is_opaque(&self, row: usize) -> bool {
        self.transmittance(row).iter().all(|transmittance| *transmittance <= MIN_TRANSMITTANCE)
    }

    /// Blends colours and opacities, slice by slice, into a row; with `lengths` those of no length are none.
    pub fn blend(&mut self, lanes: LaneSet, row: usize, lengths: Option<&[f32]>, columns: [&[f32]; 4]) {
        dispatch(lanes, Over { pixels: self, row, lengths, columns });
    }
}

/// Sums of optical depth of a tile's pixels, where there is one colour; or composited opacities, where each segment's has a factor of its
/// own: A is then more than a sum of depths, but its order does not matter either.
pub(crate) struct OpticalDepths {
    pub sums: [f32; PIXELS],
    pub opacities: bool,
}

impl OpticalDepths {
    /// True if no further segment changes any of some pixels.
    fn are_opaque(&self, pixels: &[f32]) -> bool {
        let full = if self.opacities { 1.0 } else { OPAQUE_OPTICAL_DEPTH };
        pixels.iter().all(|sum| full <= *sum)
    }

    /// Adds the first `count` segments of a batch, slices of a row, to it.
    pub fn take_row(&mut self, lanes: LaneSet, row: usize, shaded: &ShadedBatch, count: usize) {
        let OpticalDepths { sums, opacities } = self;
        dispatch(lanes, Add { sums, row, depths: &shaded.depth[..count], opacities: *opacities });
    }
}

#[expect(clippy::large_enum_variant, reason = "a worker has one, on its stack")]
pub(crate) enum TilePixels {
    OneColor([f32; 3], OpticalDepths),
    Colors(TileAccumulator),
}

impl TilePixels {
    /// Pixels for a shader, before any segment. `sums`: optical depths that they begin with, where there is one colour.
    pub fn new(shader: &Shader, sums: [f32; PIXELS]) -> TilePixels {
        match shader.one_color {
            Some(color) => {
                TilePixels::OneColor(color, OpticalDepths { sums, opacities: shader.surface.is_some() })
            }
            None => TilePixels::Colors(TileAccumulator::new()),
        }
    }

    /// True if no further segment changes any pixel of a row.
    pub fn is_opaque(&self, row: usize) -> bool {
        match self {
            TilePixels::OneColor(_, depths) => depths.are_opaque(&depths.sums[row * TILE..][..TILE]),
            TilePixels::Colors(pixels) => pixels.is_opaque(row),
        }
    }

    /// Stores colour and opacity of all pixels.
    pub fn store(&self, picture: &mut TilePicture) {
        match self {
            TilePixels::OneColor(color, OpticalDepths { sums, opacities }) => {
                for (pixel, &sum) in picture.iter_mut().zip(sums) {
                    *pixel = pixel_in_one_color(*color, sum, *opacities);
                }
            }
            TilePixels::Colors(pixels) => pixels.store(picture),
        }
    }
}

struct Add<'a> {
    sums: &'a mut [f32; PIXELS],
    row: usize,
    depths: &'a [f32],
    opacities: bool,
}

impl Kernel for Add<'_> {
    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Add { sums, row, depths, opacities } = self;
        let (zero, one) = (L::F::splat(0.0), L::F::splat(1.0));
        for half in (0..TILE).step_by(L::WIDTH) {
            let sums = &mut sums[row * TILE + half..];
            let mut sum = if opacities { L::F::load(sums) } else { zero };
            for at in (half..depths.len()).step_by(TILE) {
                // Fragments of no length have no depth.
                let more = L::F::load(&depths[at..]);
                sum = sum + if opacities { (one - sum) * more } else { more };
            }
            if !opacities {
                // Depths of the batch, rounded as the small numbers that they are.
                sum = L::F::load(sums) + sum;
            }
            sum.store(sums);
        }
    }
}

/// Front to back: C += (1 − A) C_seg, A += (1 − A) A_seg.
struct Over<'a> {
    pixels: &'a mut TileAccumulator,
    row: usize,
    /// Lengths of the segments, where those of no length are none.
    lengths: Option<&'a [f32]>,
    columns: [&'a [f32]; 4],
}

/// Segments that are summed before the sum goes into a pixel's, slices of a row: a sum of 16 is off by 16·2⁻²⁵ of itself at most.
const SUMMED: usize = 16 * TILE;

impl Kernel for Over<'_> {
    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Over { pixels, row, lengths, columns } = self;
        let (zero, one, infinity) = (L::F::splat(0.0), L::F::splat(1.0), L::F::splat(f32::INFINITY));
        for half in (0..TILE).step_by(L::WIDTH) {
            let first = row * TILE + half;
            let mut transmittance = L::F::load(&pixels.transmittance[first..]);
            let mut rest = L::F::load(&pixels.rest[first..]);
            for chunk in (0..columns[0].len()).step_by(SUMMED) {
                let end = columns[0].len().min(chunk + SUMMED);
                // Sums of some segments, each rounded as the small number that it is.
                let mut sums = [zero; 4];
                for at in (chunk + half..end).step_by(TILE) {
                    let mut layer: [L::F; 4] = array!(|c| L::F::load(&columns[c][at..]));
                    if let Some(lengths) = lengths {
                        let hit = zero.lt(L::F::load(&lengths[at..]));
                        layer = array!(|c| L::F::select(hit, layer[c], zero));
                    }
                    let visibility = transmittance + rest;
                    for (sum, layer) in sums.iter_mut().zip(layer) {
                        *sum = visibility.mul_add(layer, *sum);
                    }
                    // The product of T + rest and 1 − A, both with what their rounding takes.
                    let clear = one - layer[3];
                    let rounding = (one - clear) - layer[3];
                    let product = transmittance * clear;
                    let of_product = transmittance.mul_add(clear, -product);
                    rest = rest.mul_add(clear, transmittance.mul_add(rounding, of_product));
                    transmittance = product;
                }
                // Added with what rounding takes (Knuth 1969, The Art of Computer Programming 2, section 4.2.2).
                for ((column, rounded), sum) in pixels.rgba.iter_mut().zip(&mut pixels.rounded).zip(sums) {
                    let (column, rounded) = (&mut column[first..], &mut rounded[first..]);
                    let before = L::F::load(column);
                    let after = before + sum;
                    let added = after - before;
                    let error = (before - (after - added)) + (sum - added);
                    after.store(column);
                    // Beyond the largest number there is no rest.
                    let error = L::F::select(after.abs().lt(infinity), error, zero);
                    (L::F::load(rounded) + error).store(rounded);
                }
            }
            transmittance.store(&mut pixels.transmittance[first..]);
            rest.store(&mut pixels.rest[first..]);
        }
    }
}

/// Destination of a tile's segments.
pub(crate) trait Sink {
    /// Takes the first `count` fragments of a batch; those of no length are not segments.
    fn take(&mut self, batch: &Batch, shaded: &ShadedBatch, count: usize);

    /// True if no further segment changes any pixel.
    fn is_opaque(&self) -> bool {
        false
    }
}

impl Sink for OpticalDepths {
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
        self.are_opaque(&self.sums)
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
            self.push(batch.pixel[k] as usize & (TILE - 1), Fragment::of(batch, shaded, k));
        }
    }
}

#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Fragment {
    /// Premultiplied colour and opacity.
    pub rgba: [f32; 4],
    pub entry: f32,
    pub exit: f32,
}

impl Fragment {
    pub fn new(entry: f32, exit: f32, rgba: [f32; 4]) -> Fragment {
        Fragment { rgba, entry, exit }
    }

    /// Segment `k` of a batch.
    pub fn of(batch: &Batch, shaded: &ShadedBatch, k: usize) -> Fragment {
        Fragment::new(batch.entry[k], batch.exit[k], shaded.rgba.each_ref().map(|column| column[k]))
    }

    /// True if this segment comes behind the other: [`is_behind`].
    fn is_behind(&self, other: &Fragment) -> bool {
        is_behind([self.entry, other.entry], self.exit - other.exit)
    }
}

#[derive(Default)]
pub(crate) struct UnboundedFragmentLists {
    pixels: [Vec<Fragment>; TILE],
    pub transmittance: [f64; TILE],
}

impl UnboundedFragmentLists {
    pub fn clear(&mut self) {
        self.pixels.iter_mut().for_each(Vec::clear);
    }

    pub fn push(&mut self, column: usize, fragment: Fragment) {
        self.pixels[column].push(fragment);
    }

    pub fn pixels(&self) -> &[Vec<Fragment>; TILE] {
        &self.pixels
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
