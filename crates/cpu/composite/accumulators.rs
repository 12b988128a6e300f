//! Accumulators of a tile's pixels, front to back, those of a row side by side.

use crate::fragments::batch::Batch;
use crate::shade::shaded_batch::ShadedBatch;
use crate::tile::{PIXELS, TILE, TilePicture};
use crate::tolerances::{MIN_TRANSMITTANCE, OPAQUE_OPTICAL_DEPTH};
use voltet_simd::{Float, Kernel, LaneSet, Lanes, array, dispatch};

/// Colour and transmittance of a tile's pixels.
pub(crate) struct TileAccumulator {
    /// Premultiplied colour and opacity.
    rgba: [[f32; PIXELS]; 4],
    transmittance: [f32; PIXELS],
}

impl TileAccumulator {
    pub fn new() -> TileAccumulator {
        TileAccumulator { rgba: [[0.0; PIXELS]; 4], transmittance: [1.0; PIXELS] }
    }

    /// Stores colour and opacity of all pixels.
    pub fn store(&self, picture: &mut TilePicture) {
        for (pixel, out) in picture.iter_mut().enumerate() {
            *out = self.pixel(pixel);
        }
    }

    fn pixel(&self, pixel: usize) -> [f32; 4] {
        let [r, g, b, a] = [0, 1, 2, 3].map(|c: usize| self.rgba[c][pixel]);
        [r, g, b, a.min(1.0)]
    }

    /// Transmittance of each pixel in a row; values below [`MIN_TRANSMITTANCE`] are not meaningful.
    pub fn transmittance(&self, row: usize) -> &[f32; TILE] {
        self.transmittance[row * TILE..].first_chunk().expect("a tile's row")
    }

    /// True if no further segment changes any pixel of a row.
    pub fn is_opaque(&self, row: usize) -> bool {
        self.transmittance(row).iter().all(|transmittance| *transmittance <= MIN_TRANSMITTANCE)
    }

    /// Blends the first `count` segments of a batch, slices of a row, into it.
    pub fn take(&mut self, lanes: LaneSet, row: usize, batch: &Batch, shaded: &ShadedBatch, count: usize) {
        let lengths = Some(&batch.length[..count]);
        let columns = [0, 1, 2, 3].map(|c: usize| &shaded.rgba[c][..count]);
        dispatch(lanes, Over { pixels: self, row, lengths, columns });
    }

    /// Blends colours and opacities, slice by slice, into a row.
    pub fn blend(&mut self, lanes: LaneSet, row: usize, columns: [&[f32]; 4]) {
        dispatch(lanes, Over { pixels: self, row, lengths: None, columns });
    }
}

/// Sums of optical depth of a tile's pixels, where there is one colour; or composited opacities, see [`super::sinks::OpticalDepthSink`].
pub(crate) struct OpticalDepthRows<'a> {
    pub sums: &'a mut [f32; PIXELS],
    pub opacities: bool,
}

impl OpticalDepthRows<'_> {
    /// True if no further segment changes any pixel of a row.
    pub fn is_opaque(&self, row: usize) -> bool {
        let full = if self.opacities { 1.0 } else { OPAQUE_OPTICAL_DEPTH };
        self.sums[row * TILE..][..TILE].iter().all(|sum| full <= *sum)
    }

    /// Adds the first `count` segments of a batch, slices of a row, to it.
    pub fn take(&mut self, lanes: LaneSet, row: usize, shaded: &ShadedBatch, count: usize) {
        let OpticalDepthRows { sums, opacities } = self;
        dispatch(lanes, Add { sums, row, depths: &shaded.depth[..count], opacities: *opacities });
    }
}

struct Add<'a> {
    sums: &'a mut [f32; PIXELS],
    row: usize,
    depths: &'a [f32],
    opacities: bool,
}

impl Kernel for Add<'_> {
    type Output = ();
    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Add { sums, row, depths, opacities } = self;
        let one = L::F::splat(1.0);
        for at in (0..depths.len()).step_by(L::WIDTH) {
            // Fragments of no length have no depth.
            let sums = &mut sums[row * TILE + at % TILE..];
            let (sum, more) = (L::F::load(sums), L::F::load(&depths[at..]));
            let more = if opacities { (one - sum) * more } else { more };
            (sum + more).store(sums);
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

impl Kernel for Over<'_> {
    type Output = ();
    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Over { pixels, row, lengths, columns } = self;
        let (zero, one) = (L::F::splat(0.0), L::F::splat(1.0));
        for half in (0..TILE).step_by(L::WIDTH) {
            let first = row * TILE + half;
            let mut sums: [L::F; 4] = array!(|c| L::F::load(&pixels.rgba[c][first..]));
            let mut transmittance = L::F::load(&pixels.transmittance[first..]);
            let mut at = half;
            while at < columns[0].len() {
                let mut layer: [L::F; 4] = array!(|c| L::F::load(&columns[c][at..]));
                if let Some(lengths) = lengths {
                    let hit = zero.lt(L::F::load(&lengths[at..]));
                    layer = array!(|c| L::F::select(hit, layer[c], zero));
                }
                for (sum, layer) in sums.iter_mut().zip(layer) {
                    *sum = transmittance.mul_add(layer, *sum);
                }
                transmittance = transmittance * (one - layer[3]);
                at += TILE;
            }
            for (column, sum) in pixels.rgba.iter_mut().zip(sums) {
                sum.store(&mut column[first..]);
            }
            transmittance.store(&mut pixels.transmittance[first..]);
        }
    }
}
