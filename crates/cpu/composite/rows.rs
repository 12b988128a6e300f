//! Pixels that take their segments front to back, those of a row side by side.

use crate::composite::lists::UNSEEN;
use crate::composite::sinks::{OPAQUE_DEPTH, TilePicture};
use crate::fragments::batch::Batch;
use crate::project::record::TILE;
use crate::shade::shaded::Shaded;
use voltet_simd::{Float, Kernel, LaneSet, Lanes, array, dispatch};

/// A tile's pixels.
pub(crate) struct Rows {
    /// Premultiplied colour and opacity.
    rgba: [[f32; TILE * TILE]; 4],
    through: [f32; TILE * TILE],
}

impl Rows {
    pub fn new() -> Rows {
        Rows { rgba: [[0.0; TILE * TILE]; 4], through: [1.0; TILE * TILE] }
    }

    /// The picture.
    pub fn end(&self, picture: &mut TilePicture) {
        for (pixel, out) in picture.iter_mut().enumerate() {
            *out = self.pixel(pixel);
        }
    }

    /// Colour and opacity of a pixel.
    pub fn pixel(&self, pixel: usize) -> [f32; 4] {
        let [r, g, b, a] = [0, 1, 2, 3].map(|c: usize| self.rgba[c][pixel]);
        [r, g, b, a.min(1.0)]
    }

    /// 1 − A of a row's pixels, as far as it is more than [`UNSEEN`].
    pub fn through(&self, row: usize) -> &[f32; TILE] {
        self.through[row * TILE..].first_chunk().expect("a tile's row")
    }

    /// Whether nothing that may come changes any pixel of a row.
    pub fn is_full(&self, row: usize) -> bool {
        self.through(row).iter().all(|through| *through <= UNSEEN)
    }

    /// Blends the first `count` segments of a batch, slices of a row, into it.
    pub fn take(&mut self, lanes: LaneSet, row: usize, batch: &Batch, shaded: &Shaded, count: usize) {
        let lengths = Some(&batch.length[..count]);
        let columns = [0, 1, 2, 3].map(|c: usize| &shaded.rgba[c][..count]);
        dispatch(lanes, Over { rows: self, row, lengths, columns });
    }

    /// The same of colours and opacities, slice by slice.
    pub fn blend(&mut self, lanes: LaneSet, row: usize, columns: [&[f32]; 4]) {
        dispatch(lanes, Over { rows: self, row, lengths: None, columns });
    }
}

/// Sums of optical depths, where there is one colour; or composited opacities, see [`super::sinks::DepthSink`].
pub(crate) struct RowSums<'a> {
    pub sums: &'a mut [f32; TILE * TILE],
    pub opacities: bool,
}

impl RowSums<'_> {
    /// Whether nothing that may come changes any pixel of a row.
    pub fn is_full(&self, row: usize) -> bool {
        let full = if self.opacities { 1.0 } else { OPAQUE_DEPTH };
        self.sums[row * TILE..][..TILE].iter().all(|sum| full <= *sum)
    }

    /// Adds the first `count` segments of a batch, slices of a row, to it.
    pub fn take(&mut self, lanes: LaneSet, row: usize, shaded: &Shaded, count: usize) {
        let RowSums { sums, opacities } = self;
        dispatch(lanes, Add { sums, row, depths: &shaded.depth[..count], opacities: *opacities });
    }
}

struct Add<'a> {
    sums: &'a mut [f32; TILE * TILE],
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
    rows: &'a mut Rows,
    row: usize,
    /// Of segments, where those of no length are none.
    lengths: Option<&'a [f32]>,
    columns: [&'a [f32]; 4],
}

impl Kernel for Over<'_> {
    type Output = ();
    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Over { rows, row, lengths, columns } = self;
        let (zero, one) = (L::F::splat(0.0), L::F::splat(1.0));
        for half in (0..TILE).step_by(L::WIDTH) {
            let first = row * TILE + half;
            let mut sums: [L::F; 4] = array(
                #[inline(always)]
                |c| L::F::load(&rows.rgba[c][first..]),
            );
            let mut through = L::F::load(&rows.through[first..]);
            let mut at = half;
            while at < columns[0].len() {
                let mut layer: [L::F; 4] = array(
                    #[inline(always)]
                    |c| L::F::load(&columns[c][at..]),
                );
                if let Some(lengths) = lengths {
                    let hit = zero.lt(L::F::load(&lengths[at..]));
                    layer = array(
                        #[inline(always)]
                        |c| L::F::select(hit, layer[c], zero),
                    );
                }
                for (sum, layer) in sums.iter_mut().zip(layer) {
                    *sum = through.mul_add(layer, *sum);
                }
                through = through * (one - layer[3]);
                at += TILE;
            }
            for (column, sum) in rows.rgba.iter_mut().zip(sums) {
                sum.store(&mut column[first..]);
            }
            through.store(&mut rows.through[first..]);
        }
    }
}
