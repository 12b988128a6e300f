//! A volume: a grid of tetrahedra with the scalar that is drawn and, where asked for, its gradient.

use crate::SharedSlice;
use crate::grid::Grid;
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
