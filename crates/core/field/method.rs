//! A gradient filter with its parameters, ready to run, and the check of what it gives.

use super::{Gradient, GradientFilter, Plugin, check_scalar, length};
use crate::grid::Grid;
use crate::parameters::{Parameters, VariantSchema};
use crate::progress::Progress;
use crate::{Error, Result};
use glam::DVec3;
use rayon::prelude::*;
use std::sync::Arc;

/// A gradient filter with its parameters. Whatever it gives was checked.
#[derive(Clone)]
pub struct Method {
    filter: Arc<dyn GradientFilter>,
    parameters: Parameters,
}

impl std::fmt::Debug for Method {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Method").field("name", &self.name()).field("parameters", &self.parameters).finish()
    }
}

impl Method {
    /// The filter with these parameters, which were checked against what it declares.
    ///
    /// Errors: what the filter's own check says of them.
    pub fn new(filter: Arc<dyn GradientFilter>, parameters: Parameters) -> Result<Method> {
        filter.check(&parameters)?;
        Ok(Method { filter, parameters })
    }

    /// The filter with its standard values.
    ///
    /// Errors: a parameter that must be given.
    pub fn with_defaults(filter: Arc<dyn GradientFilter>) -> Result<Method> {
        let parameters = Parameters::from_values(filter.declaration().parameters, [])?;
        Self::new(filter, parameters)
    }

    /// The filter's name.
    pub fn name(&self) -> &'static str {
        self.filter.declaration().name
    }

    /// Parameter schema of the filter.
    pub fn declaration(&self) -> VariantSchema {
        self.filter.declaration()
    }

    /// The values that it goes by.
    pub fn parameters(&self) -> &Parameters {
        &self.parameters
    }

    /// The plug-in that the filter was loaded from.
    pub fn plugin(&self) -> Option<&Plugin> {
        self.filter.plugin()
    }

    /// The filter as messages call it.
    fn describe(&self) -> String {
        let of = self.plugin().map(|plugin| format!(" of the {plugin}")).unwrap_or_default();
        format!("the gradient filter '{}'{of}", self.name())
    }

    /// Names of the point arrays that it reads.
    pub fn arrays(&self) -> Result<Vec<String>> {
        self.filter.arrays(&self.parameters)
    }

    /// ∇s at every point of `grid` for the values `scalar`, one a point.
    ///
    /// Errors: those of the filter; vectors in another number than points, or not finite where position and value are.
    pub fn gradient(&self, grid: &Grid, scalar: &[f64], progress: &dyn Progress) -> Result<Gradient> {
        check_scalar(grid, scalar)?;
        let found = self.filter.gradient(grid, scalar, &self.parameters, progress)?;
        self.check_count(grid.points.len(), &found)?;
        self.check_finite(grid, scalar, &found.vectors, |p| p)?;
        Ok(found)
    }

    /// Gradient at some points alone, a vector each, in their order; `None` where that takes as long as all of them.
    ///
    /// Errors: those of [`Method::gradient`].
    pub fn gradient_at(
        &self,
        grid: &Grid,
        scalar: &[f64],
        points: &[u32],
        progress: &dyn Progress,
    ) -> Option<Result<Gradient>> {
        let found = self.filter.gradient_at(grid, scalar, points, &self.parameters, progress)?;
        let checked = |found: Gradient| {
            self.check_count(points.len(), &found)?;
            self.check_finite(grid, scalar, &found.vectors, |place| points[place] as usize)?;
            Ok(found)
        };
        Some(found.and_then(checked))
    }

    fn check_count(&self, wanted: usize, found: &Gradient) -> Result<()> {
        match (found.vectors.len(), wanted) {
            (count, wanted) if count == wanted => Ok(()),
            (count, wanted) => {
                let what = format!("{} did not give one vector a point", self.describe());
                Err(Error::run(what).got(format!("{count} vectors")).expected(wanted))
            }
        }
    }

    /// The length counts, which overflows before the components do: it is what widgets look at. Points that no cell uses
    /// may hold anything: the reader left out what is not finite.
    fn check_finite(
        &self,
        grid: &Grid,
        scalar: &[f64],
        vectors: &[DVec3],
        point_of: impl Fn(usize) -> usize + Sync,
    ) -> Result<()> {
        let is_bad = |place: usize| {
            let p = point_of(place);
            !length(vectors[place]).is_finite() && grid.points[p].is_finite() && scalar[p].is_finite()
        };
        let places = (0..vectors.len()).into_par_iter().with_min_len(1 << 14);
        if !places.clone().any(is_bad) {
            return Ok(());
        }
        let mut used = vec![false; grid.points.len()];
        grid.tetrahedra.iter().flatten().for_each(|&p| used[p as usize] = true);
        let is_found = |&place: &usize| used[point_of(place)] && is_bad(place);
        let Some(place) = places.find_first(is_found) else { return Ok(()) };
        let p = point_of(place);
        let (v, at) = (vectors[place], grid.points[p]);
        let what = format!("{} gave a vector that is not finite", self.describe());
        let found = format!(
            "({}, {}, {}) at point {p}, which lies at ({}, {}, {}) and has the value {}",
            v.x, v.y, v.z, at.x, at.y, at.z, scalar[p]
        );
        Err(Error::run(what).got(found).expected("a finite length wherever position and value are finite"))
    }
}
