//! Gradient filters: the trait, and the gradient that one returns.

use crate::grid::Grid;
use crate::parameters::{Parameters, VariantSchema};
use crate::progress::Progress;
use crate::{Error, Result};
use glam::DVec3;
use std::fmt;
use std::path::PathBuf;
use std::time::SystemTime;

/// Gradients at the points, and how often the filter had to do with less than it promises.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Gradient {
    /// ∇s at every point of the grid, or at each that was asked for.
    pub vectors: Vec<DVec3>,
    /// Points at which the filter fell back, by what it did there instead; empty where it never had to.
    pub fallbacks: Vec<Fallback>,
}

/// A kind of fall-back, and at how many points it was taken.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fallback {
    /// Substitute method and its reason, a clause that can follow "at 12 points".
    pub what: String,
    /// Number of points, > 0.
    pub point_count: u64,
}

impl Fallback {
    /// Fallbacks with a count above zero.
    pub fn list(taken: impl IntoIterator<Item = (&'static str, u64)>) -> Vec<Fallback> {
        taken
            .into_iter()
            .filter(|&(_, point_count)| point_count > 0)
            .map(|(what, point_count)| Fallback { what: what.into(), point_count })
            .collect()
    }
}

/// The plug-in that a filter was loaded from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Plugin {
    /// Its own name.
    pub name: String,
    /// Its version, in any form.
    pub version: String,
    /// Its file, as it was given.
    pub path: PathBuf,
    /// The file's size when it was loaded: bytes.
    pub bytes: u64,
    /// A number made of all its bytes then: what was damaged or compiled again has another.
    pub fingerprint: u64,
    /// Modification time of the file when it was loaded.
    pub modified: Option<SystemTime>,
}

impl Plugin {
    /// The fingerprint as people are told of it: 16 hexadecimal digits.
    pub fn fingerprint_text(&self) -> String {
        format!("{:016x}", self.fingerprint)
    }
}

/// "plug-in 'name' (path)".
impl fmt::Display for Plugin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "plug-in '{}' ({})", self.name, self.path.display())
    }
}

/// Computes ∇s at the points of a grid.
pub trait GradientFilter: Send + Sync {
    /// Its name in pipeline files (`method = "least-squares"`), what it does in a sentence, and what can be set.
    fn declaration(&self) -> VariantSchema;

    /// The plug-in that it was loaded from; `None` for one that the program was built with.
    fn plugin(&self) -> Option<&Plugin> {
        None
    }

    /// Checks what single declarations cannot say (parameters that exclude each other). Touches no file.
    fn check(&self, parameters: &Parameters) -> Result<()> {
        let _ = parameters;
        Ok(())
    }

    /// Names of the point arrays that it reads with these parameters. The grid then has them.
    fn arrays(&self, parameters: &Parameters) -> Result<Vec<String>> {
        let _ = parameters;
        Ok(Vec::new())
    }

    /// ∇s at every point of `grid` for the values `scalar`, one a point. Finite at every point of a cell whose position and
    /// value are finite.
    fn gradient(
        &self,
        grid: &Grid,
        scalar: &[f64],
        parameters: &Parameters,
        progress: &dyn Progress,
    ) -> Result<Gradient>;

    /// Gradient at some points alone: a vector each, in their order, equal to [`GradientFilter::gradient`] there. `None`
    /// where this takes as long as all of them.
    fn gradient_at(
        &self,
        grid: &Grid,
        scalar: &[f64],
        points: &[u32],
        parameters: &Parameters,
        progress: &dyn Progress,
    ) -> Option<Result<Gradient>> {
        let _ = (grid, scalar, points, parameters, progress);
        None
    }
}

/// The error for a scalar whose number of values is not the grid's number of points.
pub fn check_scalar(grid: &Grid, scalar: &[f64]) -> Result<()> {
    if scalar.len() == grid.points.len() {
        return Ok(());
    }
    Err(Error::run("the scalar does not have one value a point")
        .got(scalar.len())
        .expected(grid.points.len()))
}
