//! The native engine: cull, sort, project and composite on all cores with vector units.

pub mod lanes;

use crate::Result;
use crate::camera::Camera;
use crate::optics::Overlap;
use crate::picture::Picture;
use crate::progress::Progress;
use crate::transfer::TransferFunction;
use crate::volume::Volume;
use std::sync::Arc;

/// Order in which a pixel's segments are composited.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Order {
    /// By entry distance at every pixel: exact for disjoint cells.
    #[default]
    Exact,
    /// By the distance of the cells' centroids: an approximation.
    Centroid,
    /// As the cells come.
    None,
    /// `None` where the scene needs no order, else `Exact`.
    Auto,
}

/// Lighting of a segment: colour × (ambient + diffuse |ĝ·direction|).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Light {
    /// Direction in world space; normalised on use.
    pub direction: glam::DVec3,
    /// k_a.
    pub ambient: f64,
    /// k_d.
    pub diffuse: f64,
}

/// How segments are integrated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shading {
    /// The integrator.
    pub integrator: Integrator,
    /// Several widgets on one stretch.
    pub overlap: Overlap,
    /// Silhouette exponent p (Song et al. 2009, section 6.2).
    pub silhouette: Option<f64>,
    /// Diffuse lighting.
    pub light: Option<Light>,
}

/// The integrators (optics specification, section 5).
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Integrator {
    /// Closed forms; quadrature with closed-form optical depth where widgets overlap.
    Analytic,
    /// 64-bit adaptive quadrature.
    Reference,
}

/// Cells that can contribute. Made by [`cull`], given an order by [`sort`].
#[derive(Debug, Clone)]
pub struct Cells {
    /// The volume they belong to.
    pub volume: Arc<Volume>,
    /// Numbers of the tetrahedra kept, ascending (grid order).
    pub kept: Arc<Vec<u32>>,
    /// Order that the compositor carries out.
    pub order: Order,
    /// Tetrahedra left out because no widget touches their values.
    pub culled_by_transfer_function: u64,
    /// Tetrahedra left out because they are outside the view.
    pub culled_by_frustum: u64,
}

/// Counts of a composited picture.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Counts {
    /// Ray segments integrated.
    pub segments: u64,
    /// Pixels whose segments were composited in an order that was not exact.
    pub pixels_disordered: u64,
    /// Cells that were projected.
    pub cells_projected: u64,
}

/// Keeps each tetrahedron that could contribute to the picture.
pub fn cull(
    _volume: &Arc<Volume>,
    _transfer_function: &TransferFunction,
    _camera: &Camera,
    _progress: &dyn Progress,
) -> Result<Cells> {
    Err(crate::Error::run("the native engine is in work"))
}

/// Draws the kept cells: project, bin, integrate, sort, composite.
pub fn draw(
    _cells: &Cells,
    _transfer_function: &TransferFunction,
    _camera: &Camera,
    _shading: &Shading,
    _progress: &dyn Progress,
) -> Result<(Picture, Counts)> {
    Err(crate::Error::run("the native engine is in work"))
}
