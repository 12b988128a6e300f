//! Volumes: a grid with the scalar that is drawn, and its gradient where a picture needs it.

use super::grid::Grid;
use glam::DVec3;
use std::sync::{Arc, Mutex, PoisonError};
use voltet_core::field::{GradientFilter, LeastSquares, Method, magnitude};
use voltet_core::grid::extent;
use voltet_core::progress::{NoProgress, Progress};
use voltet_core::volume::Volume as BuiltVolume;
use voltet_core::{Error, Result};

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
    ///
    /// # Errors
    /// - those of the gradient filter, and cancellation.
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
