//! A volume: a grid of tetrahedra with the scalar that is drawn and, where asked for, its gradient.

use crate::SharedSlice;
use crate::grid::{Grid, Subset};
use glam::DVec3;
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
