//! A volume: a grid of tetrahedra with the scalar that is drawn and, where asked for, its gradient.

use crate::SharedSlice;
use crate::grid::{Grid, Subset, extent};
use glam::DVec3;
use rayon::prelude::*;
use std::sync::Arc;

/// Volume to draw: a grid with its scalar and gradient. All arrays are per point; `None`: not requested.
#[derive(Debug, Clone)]
pub struct Volume {
    /// Points, tetrahedra, further fields.
    pub grid: Arc<Grid>,
    /// The scalar *s* at every point.
    pub scalar: SharedSlice<f64>,
    /// ∇s at every point (units of s per world unit): only where lighting or silhouettes ask for it.
    pub gradient: Option<SharedSlice<DVec3>>,
    /// *g* = |∇s| at every point: only where a widget looks at it.
    pub gradient_magnitude: Option<SharedSlice<f64>>,
}

impl Volume {
    /// These cells of its grid, with the scalar and the gradient that all cells together gave them.
    pub fn subset(&self, cells: &Subset) -> Volume {
        let own = |values: &SharedSlice<f64>| SharedSlice::from(cells.of_points(|p| values[p as usize]));
        let scalar = own(&self.scalar);
        let mut grid = cells.grid(&self.grid);
        grid.scalar = self.grid.scalar.is_some().then(|| scalar.clone());
        let gradient = self.gradient.as_ref().map(|all| cells.of_points(|p| all[p as usize]).into());
        let gradient_magnitude = self.gradient_magnitude.as_ref().map(own);
        Volume { grid: Arc::new(grid), scalar, gradient, gradient_magnitude }
    }
}

/// Extent of a volume in space and in its values.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct VolumeExtent {
    /// Lowest and highest coordinates of the points of the cells that are drawn; `None` where there is none.
    pub bounds: Option<[DVec3; 2]>,
    /// Ranges of s and g at the points of the cells that are drawn; 0 of what there is not.
    pub ranges: [[f64; 2]; 2],
    /// Largest component of ∇s.
    pub max_gradient: f64,
}

impl VolumeExtent {
    /// The extent of a volume.
    pub fn from_volume(volume: &Volume) -> VolumeExtent {
        let drawn = volume.grid.drawn_points();
        let range = |values: &[f64]| extent::range(values).unwrap_or_default();
        let of_points = |values: &SharedSlice<f64>| range(&values[..drawn.min(values.len())]);
        let gradient = volume.gradient.as_ref().map(|all| &all[..drawn.min(all.len())]);
        VolumeExtent {
            bounds: volume.grid.bounds(),
            ranges: [
                of_points(&volume.scalar),
                volume.gradient_magnitude.as_ref().map_or([0.0; 2], of_points),
            ],
            max_gradient: gradient.map_or(0.0, |gradient| {
                let largest = |vector: &DVec3| {
                    let components = vector.to_array().into_iter().filter(|x| x.is_finite());
                    components.fold(0.0, |largest: f64, x| largest.max(x.abs()))
                };
                gradient.par_iter().map(largest).reduce(|| 0.0, f64::max)
            }),
        }
    }

    /// The extent of both together.
    pub fn joined(&self, other: &VolumeExtent) -> VolumeExtent {
        let wider = |[a, b]: [f64; 2], [c, d]: [f64; 2]| [a.min(c), b.max(d)];
        VolumeExtent {
            bounds: extent::joined(self.bounds, other.bounds),
            ranges: [0, 1].map(|k: usize| wider(self.ranges[k], other.ranges[k])),
            max_gradient: self.max_gradient.max(other.max_gradient),
        }
    }
}
