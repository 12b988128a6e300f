//! Scenes: a volume (a grid with the scalar that is drawn, and its gradient where a picture needs it) with its transfer function, camera
//! and shading.

pub use shading::{Integrator, Light};

use super::camera::Camera;
use super::grid::Grid;
use super::transfer::TransferFunction;
use glam::DVec3;
use std::sync::{Arc, Mutex, PoisonError};
use voltet_core::clip::Clip;
use voltet_core::field::{GradientFilter, LeastSquares, Method, magnitude};
use voltet_core::grid::extent;
use voltet_core::progress::{NoProgress, Progress};
use voltet_core::surface::Surface;
use voltet_core::volume::Volume as BuiltVolume;
use voltet_core::{Error, Result};
use voltet_cpu::needs_gradient;
use voltet_optics::integrators::can_serve;
use voltet_optics::scene::Scene as CompiledScene;
use voltet_optics::shading::{Shading as CompiledShading, VisibilityOrder};
use voltet_optics::{WidgetBlend, shading};

/// Integration and lighting of ray segments.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
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

impl Shading {
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
            if !light.direction.is_finite() || light.direction == DVec3::ZERO {
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
    surfaces: Vec<Arc<Surface>>,
    clips: Vec<Clip>,
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
            surfaces: Vec::new(),
            clips: Vec::new(),
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

    /// Adds a surface, which is drawn in its place along each ray.
    pub fn surface(mut self, surface: impl Into<Arc<Surface>>) -> Self {
        self.surfaces.push(surface.into());
        self
    }

    /// Adds a clip: the volume is drawn where all clips keep it.
    pub fn clip(mut self, clip: Clip) -> Self {
        self.clips.push(clip);
        self
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
        let bounds = self.volume.built(false, false, progress)?.grid.bounds();
        let transfer_function = Arc::new(self.transfer_function.scaled(bounds)?);
        can_serve(&shading.integrator, &transfer_function)?;
        let needs_magnitude = transfer_function.uses_gradient_magnitude();
        let volume = self.volume.built(needs_magnitude, needs_gradient(&shading), progress)?;
        let (surfaces, clips) = (self.surfaces.clone(), self.clips.clone());
        Ok(CompiledScene { volume, transfer_function, camera, shading, order: self.order, surfaces, clips })
    }
}

/// A grid with the scalar that is drawn. The gradient is computed at the first picture that needs it, by least squares unless
/// another filter is set.
#[derive(Debug)]
pub struct Volume {
    method: Method,
    range: [f64; 2],
    bounds: [DVec3; 2],
    /// Grid and scalar, and of the gradient as much as pictures needed so far.
    built: Mutex<Arc<BuiltVolume>>,
}

impl Volume {
    /// Builds the volume of an array: `"T"`, `"U:magnitude"` or `"U:0"`.
    ///
    /// # Errors
    /// - those of [`Grid::build`];
    /// - an array without a finite value.
    pub fn new(grid: impl Into<Grid>, scalar: &str) -> Result<Volume> {
        Self::with_progress(grid, scalar, &NoProgress)
    }

    /// Like [`Volume::new`], with progress of the import, which can be cancelled.
    ///
    /// # Errors
    /// As of [`Volume::new`], and cancellation.
    pub fn with_progress(grid: impl Into<Grid>, scalar: &str, progress: &dyn Progress) -> Result<Volume> {
        let grid = grid.into().build(Some(scalar), progress)?;
        let none = || Error::run("the grid has no finite values").at_item(scalar);
        let values = grid.scalar.clone().ok_or_else(none)?;
        let range = extent::range(&values).ok_or_else(none)?;
        let bounds = extent::bounds(&grid.points).ok_or_else(none)?;
        let built = BuiltVolume { grid, scalar: values, gradient: None, gradient_magnitude: None };
        let method = Method::with_defaults(Arc::new(LeastSquares))?;
        Ok(Volume { method, range, bounds, built: Mutex::new(Arc::new(built)) })
    }

    /// Sets the gradient filter, at its default parameters.
    ///
    /// # Errors
    /// - a filter with a parameter that has no default.
    pub fn with_gradient(self, filter: impl GradientFilter + 'static) -> Result<Volume> {
        let method = Method::with_defaults(Arc::new(filter))?;
        let built = self.built.into_inner().unwrap_or_else(PoisonError::into_inner);
        let built = BuiltVolume { gradient: None, gradient_magnitude: None, ..BuiltVolume::clone(&built) };
        Ok(Volume { method, built: Mutex::new(Arc::new(built)), ..self })
    }

    /// Smallest and largest value of the scalar.
    pub fn range(&self) -> [f64; 2] {
        self.range
    }

    /// Lowest and highest coordinates of the points (world units).
    pub fn bounds(&self) -> [DVec3; 2] {
        self.bounds
    }

    /// The volume as engines take it, with gradient magnitude and gradient vectors where they are needed.
    /// Errors: those of the gradient filter, and cancellation.
    pub(super) fn built(
        &self,
        needs_magnitude: bool,
        needs_vectors: bool,
        progress: &dyn Progress,
    ) -> Result<Arc<BuiltVolume>> {
        let mut built = self.built.lock().unwrap_or_else(PoisonError::into_inner);
        let has_magnitude = built.gradient_magnitude.is_some() || !needs_magnitude;
        let has_vectors = built.gradient.is_some() || !needs_vectors;
        if !(has_magnitude && has_vectors) {
            let vectors = match &built.gradient {
                Some(vectors) => vectors.clone(),
                None => self.method.gradient(&built.grid, &built.scalar, progress)?.vectors.into(),
            };
            let needs_magnitude = needs_magnitude || built.gradient_magnitude.is_some();
            *built = Arc::new(BuiltVolume {
                gradient_magnitude: needs_magnitude.then(|| magnitude(&vectors).into()),
                gradient: (needs_vectors || built.gradient.is_some()).then_some(vectors),
                ..BuiltVolume::clone(&built)
            });
        }
        Ok(built.clone())
    }
}
