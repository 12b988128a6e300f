//! Gradients of a scalar at the points of a grid: the trait that built-in filters and plug-ins fulfil, and the
//! built-in ones.
//!
//! Symbols: s the scalar, ∇s its gradient (units of s per world unit), g = |∇s| the gradient magnitude.

mod array;
mod cell_mean;
mod dense;
mod frame;
mod least_squares;
mod quadratic_fit;
mod registry;

pub use array::FromArray;
pub use cell_mean::{CellAverage, VolumeWeighted};
pub use least_squares::LeastSquares;
pub use quadratic_fit::QuadraticFit;
pub use registry::Registry;

use crate::grid::Grid;
use crate::progress::Progress;
use crate::{Error, Result};
use glam::DVec3;
use rayon::prelude::*;
use std::collections::BTreeMap;

/// What a gradient filter is called, and what can be set.
#[derive(Debug, Clone, PartialEq)]
pub struct Declaration {
    /// The name that pipeline files use (`method = "least-squares"`).
    pub name: String,
    /// One sentence for the user.
    pub help: String,
    /// What can be set.
    pub parameters: Vec<Parameter>,
}

/// One parameter of a filter.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameter {
    /// The key in pipeline files.
    pub name: String,
    /// One sentence for the user.
    pub help: String,
    /// Its type, default and range.
    pub kind: ParameterKind,
}

/// Type, default and range of a parameter.
#[derive(Debug, Clone, PartialEq)]
pub enum ParameterKind {
    /// The name of a point array; required.
    PointArray,
    /// A number.
    Number {
        /// Value when nothing is set.
        default: f64,
        /// Lowest and highest value allowed.
        range: [f64; 2],
        /// Unit, empty for a pure number.
        unit: String,
    },
}

/// Values of parameters, by name; what is not set takes its default.
pub type Settings = BTreeMap<String, Setting>;

/// The value of one parameter.
#[derive(Debug, Clone, PartialEq)]
pub enum Setting {
    /// Text, such as the name of an array.
    Text(String),
    /// A number.
    Number(f64),
}

/// Gradients at the points, and how often the filter had to do with less than it promises.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Gradient {
    /// ∇s at every point of the grid.
    pub vectors: Vec<DVec3>,
    /// Points at which the filter fell back, by what it did there instead; empty where it never had to.
    pub fallbacks: Vec<Fallback>,
}

/// A kind of fall-back, and at how many points it was taken.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fallback {
    /// What was done and why, a clause that can follow "at 12 points".
    pub what: String,
    /// Number of points, > 0.
    pub point_count: u64,
}

impl Fallback {
    /// Those that were taken at all.
    pub fn list(taken: impl IntoIterator<Item = (&'static str, u64)>) -> Vec<Fallback> {
        taken
            .into_iter()
            .filter(|&(_, point_count)| point_count > 0)
            .map(|(what, point_count)| Fallback { what: what.into(), point_count })
            .collect()
    }
}

/// Computes ∇s at the points of a grid.
pub trait GradientFilter: Send + Sync {
    /// Name, help and parameters.
    fn declaration(&self) -> Declaration;

    /// Names of the point arrays that it reads with these settings.
    fn arrays(&self, settings: &Settings) -> Vec<String> {
        let _ = settings;
        Vec::new()
    }

    /// ∇s at every point of `grid` for the values `scalar`, one a point. Finite wherever the input is.
    fn gradient(
        &self,
        grid: &Grid,
        scalar: &[f64],
        settings: &Settings,
        progress: &dyn Progress,
    ) -> Result<Gradient>;
}

/// g = |∇s| at every point.
pub fn magnitude(vectors: &[DVec3]) -> Vec<f64> {
    vectors.par_iter().with_min_len(1 << 14).map(|&v| length(v)).collect()
}

/// |v| without overflow or underflow on the way.
#[inline]
pub fn length(v: DVec3) -> f64 {
    let plain = v.length_squared();
    // Outside this range a square may have left the normal numbers.
    if (1e-280..=1e280).contains(&plain) {
        return plain.sqrt();
    }
    let largest = v.abs().max_element();
    if largest == 0.0 || !largest.is_finite() {
        return largest;
    }
    largest * (v / largest).length()
}

/// The error for a scalar whose number of values is not the grid's number of points.
pub fn check_scalar(grid: &Grid, scalar: &[f64]) -> Result<()> {
    if scalar.len() == grid.points.len() {
        return Ok(());
    }
    Err(Error::run("the scalar does not have one value a point")
        .found(scalar.len())
        .accepted(grid.points.len()))
}

#[cfg(test)]
mod tests;
