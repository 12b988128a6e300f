//! How a volume is drawn, whatever engine draws it: integrator, light, order (docs/optics.md, sections 6 and 7).

use crate::optics::Overlap;

pub use crate::optics::integrators::Integrator;

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

/// v / |v| for any magnitude of v; zero where v is, or is not finite.
pub fn unit_vector(v: glam::DVec3) -> glam::DVec3 {
    let largest = v.abs().max_element();
    if largest > 0.0 && largest.is_finite() { (v / largest).normalize() } else { glam::DVec3::ZERO }
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
