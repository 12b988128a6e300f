//! Pixels that take their segments front to back, those of a row side by side.

use crate::composite::lists::{Overflow, UNSEEN};
use crate::composite::sinks::{OPAQUE_DEPTH, Sink, TilePicture};
use crate::fragments::batch::Batch;
use crate::project::record::TILE;
use crate::shade::shaded::Shaded;
use voltet_lanes::{Float, Kernel, LaneSet, Lanes, dispatch};

/// A tile's pixels. Takes batches whose fragments are whole rows, one after another.
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
            *out = [0, 1, 2, 3].map(|c: usize| self.rgba[c][pixel]);
            out[3] = out[3].min(1.0);
        }
    }
}

impl Sink for Rows {
    fn take(&mut self, lanes: LaneSet, batch: &Batch, shaded: &Shaded, count: usize) -> Result<(), Overflow> {
        dispatch(lanes, Over { rows: self, batch, shaded, count });
        Ok(())
    }

    fn is_row_full(&self, row: usize) -> bool {
        self.through[row * TILE..][..TILE].iter().all(|through| *through <= UNSEEN)
    }
}

/// Sums of optical depths, where there is one colour; rows as above.
pub(crate) struct RowSums<'a>(pub &'a mut [f32; TILE * TILE]);

impl Sink for RowSums<'_> {
    fn take(&mut self, lanes: LaneSet, batch: &Batch, shaded: &Shaded, count: usize) -> Result<(), Overflow> {
        dispatch(lanes, Add { sums: self.0, batch, shaded, count });
        Ok(())
    }

    fn is_row_full(&self, row: usize) -> bool {
        self.0[row * TILE..][..TILE].iter().all(|sum| OPAQUE_DEPTH <= *sum)
    }
}

struct Add<'a> {
    sums: &'a mut [f32; TILE * TILE],
    batch: &'a Batch,
    shaded: &'a Shaded,
    count: usize,
}

impl Kernel for Add<'_> {
    type Output = ();
    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Add { sums, batch, shaded, count } = self;
        for at in (0..count).step_by(L::WIDTH) {
            // Fragments of no length have no depth.
            let sums = &mut sums[batch.pixel[at] as usize..];
            (L::F::load(sums) + L::F::load(&shaded.depth[at..])).store(sums);
        }
    }
}

/// Front to back: C += (1 − A) C_seg, A += (1 − A) A_seg.
struct Over<'a> {
    rows: &'a mut Rows,
    batch: &'a Batch,
    shaded: &'a Shaded,
    count: usize,
}

impl Kernel for Over<'_> {
    type Output = ();
    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Over { rows, batch, shaded, count } = self;
        let splat = L::F::splat;
        for at in (0..count).step_by(L::WIDTH) {
            let first = batch.pixel[at] as usize;
            let hit = splat(0.0).lt(L::F::load(&batch.length[at..]));
            let before = &mut rows.through[first..];
            let through = L::F::load(before);
            for (sum, layer) in rows.rgba.iter_mut().zip(&shaded.rgba) {
                let layer = L::F::select(hit, L::F::load(&layer[at..]), splat(0.0));
                let sum = &mut sum[first..];
                through.mul_add(layer, L::F::load(sum)).store(sum);
            }
            let opacity = L::F::select(hit, L::F::load(&shaded.rgba[3][at..]), splat(0.0));
            (through * (splat(1.0) - opacity)).store(before);
        }
    }
}
