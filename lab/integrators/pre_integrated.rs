//! Pre-integration of a transfer function of the scalar alone: a table over (s_f, s_b, D).
//!
//! Roettger & Ertl 2002, section 3, with its sums corrected (module `slice`). Kept are the mean extinction ρ̄ of a
//! path, which does not depend on D, and C/(D E₁(ρ̄D)) with E₁(T) = (1 − e^(−T))/T: both vary slowly where C and A
//! themselves rise and saturate, so that T = ρ̄D and A = 1 − e^(−T) have no error along D, C ≤ c A holds between
//! entries, and a colour is never darkened towards where nothing is. Slices lie at D = (k/(n − 1))² of the longest
//! segment, closer where D is small. Trilinear; the error falls with the side (bench `tables`).

use super::pre_integrated;
use super::slice::Ramp;
use rayon::prelude::*;
use voltet_core::Result;
use voltet_core::transfer::TransferFunction;
use voltet_optics::integrators::{Extent, SegmentIntegrator, can_serve};
use voltet_optics::special::{mean_transmittance, opacity};
use voltet_optics::{Contribution, Segment};

/// The table.
#[derive(Debug, Clone)]
pub struct PreIntegrated {
    ramp: Ramp,
    longest: f64,
    /// ρ̄ by (s_f, s_b).
    extinction: Vec<f32>,
    /// C/(D E₁) by (D, s_f, s_b).
    glow: Vec<[f32; 3]>,
}

impl PreIntegrated {
    /// Fills the table on all cores. Serves transfer functions of the scalar alone; `table_size` entries a side,
    /// 2 … [`super::MAX_TABLE_SIDE`], `oversampling` pieces from one to the next, 1 … [`super::MAX_OVERSAMPLING`].
    /// Segments longer than the extent's longest take the colour of that one.
    pub fn new(
        transfer_function: &TransferFunction,
        table_size: usize,
        oversampling: usize,
        extent: &Extent,
    ) -> Result<Self> {
        can_serve(&pre_integrated(table_size, oversampling), transfer_function)?;
        let ramp = Ramp::new(transfer_function, table_size, oversampling, extent)?;
        let slice = table_size * table_size;
        let mut glow = vec![[0.0; 3]; slice * table_size];
        glow.par_chunks_mut(slice).enumerate().for_each(|(k, slice)| {
            let share = k as f64 / (table_size - 1) as f64;
            ramp.fill(share * share, slice);
        });
        Ok(PreIntegrated { extinction: ramp.mean_extinctions(), longest: extent.longest, ramp, glow })
    }

    /// Bytes that it takes.
    pub fn bytes(&self) -> usize {
        self.extinction.len() * size_of::<f32>() + self.glow.len() * size_of::<[f32; 3]>()
    }

    /// C/(D E₁) by (D, s_f, s_b).
    pub fn glow(&self) -> &[[f32; 3]] {
        &self.glow
    }

    pub(super) fn into_parts(self) -> (Ramp, Vec<f32>) {
        (self.ramp, self.extinction)
    }

    /// C/(D E₁) at places in s, and the share of the longest segment.
    pub(super) fn glow_at(&self, front: f64, back: f64, share: f64) -> [f64; 3] {
        let n = self.ramp.size();
        let at = Bilinear::new(front, back, n);
        let place = share.clamp(0.0, 1.0).sqrt() * (n - 1) as f64;
        let low = (place as usize).min(n - 2);
        let slice = |k: usize| at.color(&self.glow[k * n * n..(k + 1) * n * n]);
        blend(slice(low), slice(low + 1), place - low as f64)
    }
}

impl SegmentIntegrator for PreIntegrated {
    fn table_bytes(&self) -> usize {
        self.bytes()
    }

    fn integrate(&self, segment: &Segment) -> Contribution {
        let (front, back) = (self.ramp.place(segment.front[0]), self.ramp.place(segment.back[0]));
        let extinction = Bilinear::new(front, back, self.ramp.size()).number(&self.extinction);
        let length = segment.length / self.longest;
        contribution(length, extinction, || self.glow_at(front, back, length))
    }
}

/// C and A from ρ̄ and C/(D E₁), D a share of the longest segment. Values that are not numbers contribute nothing.
pub(super) fn contribution(length: f64, extinction: f64, glow: impl FnOnce() -> [f64; 3]) -> Contribution {
    let depth = extinction * length;
    if !(depth >= 0.0 && length > 0.0) {
        return Contribution::default();
    }
    let reach = length * mean_transmittance(depth);
    Contribution { optical_depth: depth, color: glow().map(|g| g * reach), opacity: opacity(depth) }
}

#[inline]
pub(super) fn blend(low: [f64; 3], high: [f64; 3], share: f64) -> [f64; 3] {
    std::array::from_fn(|i| low[i] + share * (high[i] - low[i]))
}

/// A place between four entries of a square table.
pub(super) struct Bilinear {
    first: usize,
    size: usize,
    row: f64,
    column: f64,
}

impl Bilinear {
    /// Row and column in entries, within the table.
    #[inline]
    pub fn new(row: f64, column: f64, size: usize) -> Self {
        let (i, j) = ((row as usize).min(size - 2), (column as usize).min(size - 2));
        Bilinear { first: i * size + j, size, row: row - i as f64, column: column - j as f64 }
    }

    #[inline]
    fn shares(&self) -> [(usize, f64); 4] {
        let (u, v) = (self.row, self.column);
        [
            (self.first, (1.0 - u) * (1.0 - v)),
            (self.first + 1, (1.0 - u) * v),
            (self.first + self.size, u * (1.0 - v)),
            (self.first + self.size + 1, u * v),
        ]
    }

    #[inline]
    pub fn number(&self, entries: &[f32]) -> f64 {
        self.shares().iter().map(|&(k, share)| share * f64::from(entries[k])).sum()
    }

    #[inline]
    pub fn color(&self, entries: &[[f32; 3]]) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for (k, share) in self.shares() {
            for (s, c) in sum.iter_mut().zip(entries[k]) {
                *s += share * f64::from(c);
            }
        }
        sum
    }
}
