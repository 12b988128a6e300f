//! How a volume is drawn, whatever engine draws it: integrator, light, order (docs/optics.md, sections 6 and 7).

use crate::WidgetBlend;
use voltet_core::transfer::TransferFunction;

pub use crate::integrators::Integrator;

/// Order in which a pixel's segments are composited.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum VisibilityOrder {
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
    pub overlap: WidgetBlend,
    /// Silhouette exponent p (Song et al. 2009, section 6.2).
    pub silhouette: Option<f64>,
    /// Diffuse lighting.
    pub light: Option<Light>,
}

impl Shading {
    /// The factor of every colour, if the light gives all segments the same.
    pub fn even_light(&self) -> Option<f64> {
        match self.light {
            None => Some(1.0),
            Some(light) => (light.diffuse == 0.0).then_some(light.ambient),
        }
    }

    /// The one colour of all that is seen, if there is one: then a pixel's colour is that times its opacity, and no order
    /// is needed. `None` under the constant-emitter, where several colours are drawn, and where light falls at an angle.
    pub fn one_color(&self, transfer_function: &TransferFunction) -> Option<[f64; 3]> {
        let light = self.even_light()?;
        transfer_function.uniform_color().map(|color| color.map(|c| c * light))
    }
}
