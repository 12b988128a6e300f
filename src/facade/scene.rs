//! Scenes: a volume with its transfer function, camera and shading.

use super::camera::Camera;
use super::transfer::TransferFunction;
use super::volume::Volume;
use std::sync::Arc;
use voltet_core::progress::Progress;
use voltet_core::{Error, Result};
use voltet_cpu::needs_gradient;
use voltet_optics::integrators::can_serve;
use voltet_optics::scene::Scene as CompiledScene;
use voltet_optics::shading::{Shading as CompiledShading, VisibilityOrder};
use voltet_optics::{WidgetBlend, shading};

pub use shading::{Integrator, Light};

/// Integration and lighting of ray segments.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Shading {
    /// The integrator. Default: closed forms.
    pub integrator: Integrator,
    /// Combination of widgets that overlap along a ray.
    pub blend: WidgetBlend,
    /// Silhouette exponent, 0 or more (Song et al. 2009, section 6.2).
    pub silhouette: Option<f64>,
    /// Diffuse light.
    pub light: Option<Light>,
}

impl Default for Shading {
    fn default() -> Self {
        let (integrator, blend) = (Integrator::ANALYTIC, WidgetBlend::Exact);
        Shading { integrator, blend, silhouette: None, light: None }
    }
}

impl Shading {
    /// Checks every number.
    fn compiled(&self) -> Result<CompiledShading> {
        let Shading { integrator, blend, silhouette, light } = *self;
        integrator.check()?;
        let not_negative = |what: &str, value: f64| match value.is_finite() && value >= 0.0 {
            true => Ok(()),
            false => Err(Error::usage(format!("{what} is out of range"))
                .got(value)
                .expected("a number of at least 0")),
        };
        silhouette.map_or(Ok(()), |exponent| not_negative("the silhouette exponent", exponent))?;
        if let Some(light) = light {
            not_negative("the ambient light", light.ambient)?;
            not_negative("the diffuse light", light.diffuse)?;
            if !light.direction.is_finite() || light.direction == glam::DVec3::ZERO {
                let error = Error::usage("the light has no direction").got(light.direction);
                return Err(error.expected("a finite vector that is not zero"));
            }
        }
        Ok(CompiledShading { integrator, overlap: blend, silhouette, light })
    }
}

/// Everything that a picture shows. Cheap to clone; scenes of one volume share it.
#[derive(Debug, Clone)]
pub struct Scene {
    volume: Arc<Volume>,
    transfer_function: Arc<TransferFunction>,
    camera: Camera,
    shading: Shading,
    order: VisibilityOrder,
}

impl Scene {
    /// A scene with default shading and exact visibility order.
    pub fn new(
        volume: impl Into<Arc<Volume>>,
        transfer_function: impl Into<Arc<TransferFunction>>,
        camera: Camera,
    ) -> Self {
        let (volume, transfer_function) = (volume.into(), transfer_function.into());
        Scene {
            volume,
            transfer_function,
            camera,
            shading: Shading::default(),
            order: VisibilityOrder::Exact,
        }
    }

    /// Sets integrator, silhouettes and light.
    pub fn shading(self, shading: Shading) -> Self {
        Scene { shading, ..self }
    }

    /// Sets the order in which a pixel's segments are composited.
    pub fn order(self, order: VisibilityOrder) -> Self {
        Scene { order, ..self }
    }

    /// Replaces the camera.
    pub fn camera(self, camera: Camera) -> Self {
        Scene { camera, ..self }
    }

    /// Replaces the transfer function.
    pub fn transfer_function(self, transfer_function: impl Into<Arc<TransferFunction>>) -> Self {
        Scene { transfer_function: transfer_function.into(), ..self }
    }

    /// The scene as engines take it, with the gradient where it is needed.
    ///
    /// # Errors
    /// - a number of camera, transfer function or shading that is out of range;
    /// - a transfer function that the integrator does not support;
    /// - those of the gradient filter, and cancellation.
    pub(super) fn compiled(&self, progress: &dyn Progress) -> Result<CompiledScene> {
        let camera = self.camera.place()?;
        let shading = self.shading.compiled()?;
        let points = self.volume.built(false, false, progress)?.grid.points.clone();
        let transfer_function = Arc::new(self.transfer_function.scaled(&points)?);
        can_serve(&shading.integrator, &transfer_function)?;
        let needs_magnitude = transfer_function.uses_gradient_magnitude();
        let volume = self.volume.built(needs_magnitude, needs_gradient(&shading), progress)?;
        Ok(CompiledScene { volume, transfer_function, camera, shading, order: self.order })
    }
}
