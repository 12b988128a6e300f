//! Small grids by formula: a box cut into tetrahedra, and fields sampled on it.

use super::parts::{Cells, Options, RawGrid};
use super::{Grid, build, code};
use crate::SharedSlice;
use crate::progress::NoProgress;
use glam::DVec3;
use std::sync::Arc;

/// A box of `counts[0] × counts[1] × counts[2]` hexahedra, each cut into five or six tetrahedra by the rule of
/// [`build()`], without a scalar. Points inside are moved at random (always alike) by up to `jitter` × the spacing
/// along each axis, those on the boundary within it; up to 0.25 no cell turns over.
pub fn box_of_tetrahedra(counts: [usize; 3], bounds: [DVec3; 2], jitter: f64) -> Grid {
    let parts =
        RawGrid::new(lattice(counts, bounds, jitter), Cells::Structured(counts.map(|n| n.max(1) + 1)));
    let mut grid = build(parts, &Options::default(), &NoProgress).expect("a box has cells");
    // These tetrahedra are the cells, rather than parts of hexahedra.
    grid.source_cells = None;
    let origin = Arc::make_mut(&mut grid.origin);
    origin.cells_by_type = [(code::TETRA, grid.tetrahedra.len() as u64)].into();
    grid
}

/// Gives a grid the scalar `field`, sampled at its points.
pub fn with_scalar(mut grid: Grid, name: &str, field: impl Fn(DVec3) -> f64) -> Grid {
    grid.scalar = Some(SharedSlice::from(sample(&grid, field)));
    grid.scalar_name = name.into();
    grid
}

/// A field at every point of a grid.
pub fn sample<T>(grid: &Grid, field: impl Fn(DVec3) -> T) -> Vec<T> {
    grid.points.iter().map(|&p| field(p)).collect()
}

/// The points of a box, x fastest.
pub(super) fn lattice(counts: [usize; 3], [low, high]: [DVec3; 2], jitter: f64) -> Vec<DVec3> {
    let counts = counts.map(|n| n.max(1));
    let mut points = Vec::with_capacity(counts.iter().map(|n| n + 1).product());
    let mut random = Random(0x9E37_79B9_7F4A_7C15);
    for k in 0..=counts[2] {
        for j in 0..=counts[1] {
            for i in 0..=counts[0] {
                let at = [i, j, k];
                let t = DVec3::from_array(std::array::from_fn(|axis| {
                    let shift = jitter * (2.0 * random.next() - 1.0);
                    let inside = at[axis] > 0 && at[axis] < counts[axis];
                    (at[axis] as f64 + if inside { shift } else { 0.0 }) / counts[axis] as f64
                }));
                points.push(low * (DVec3::ONE - t) + high * t);
            }
        }
    }
    points
}

/// A small generator of uniform numbers (xorshift64*, Marsaglia 2003, Vigna 2016), the same on every machine.
pub struct Random(pub u64);

impl Random {
    /// The next number in [0, 1).
    #[allow(clippy::should_implement_trait)]
    pub fn next(&mut self) -> f64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 11) as f64 / (1_u64 << 53) as f64
    }
}
