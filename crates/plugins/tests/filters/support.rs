//! Libraries of test sources, and a grid to run their filters on.

use std::path::PathBuf;
use std::sync::Arc;
use voltet_core::Result;
use voltet_core::field::{Gradient, GradientFilter, Method};
use voltet_core::glam::DVec3;
use voltet_core::grid::{Array, Grid, generate};
use voltet_core::parameters::{ParameterValue, Parameters};
use voltet_core::progress::{NoProgress, Progress};
use voltet_testing::compilers;

/// A library in a folder of its own.
pub struct Built {
    /// Goes away with this.
    _folder: tempfile::TempDir,
    pub path: PathBuf,
}

/// The library of these sources, by their paths in the repository; `None` where there is no compiler.
#[track_caller]
pub fn built(sources: &[&str], options: &[&str]) -> Option<Built> {
    let folder = tempfile::tempdir().unwrap();
    let sources: Vec<PathBuf> = sources.iter().map(|path| compilers::source(path)).collect();
    let path = compilers::library(folder.path(), "filter.so", &sources, options)?;
    Some(Built { _folder: folder, path })
}

/// A box of some thousand tetrahedra, no two of them alike, with a smooth scalar and an array `trust` of ones.
pub fn grid() -> Grid {
    let bounds = [DVec3::new(-1.0, 0.0, 2.0), DVec3::new(1.0, 3.0, 3.0)];
    let grid = generate::box_of_tetrahedra([9, 8, 7], bounds, 0.2);
    let mut grid = generate::with_scalar(grid, "s", |p| (2.0 * p.x).sin() + p.y * p.z);
    let ones = Array { component_count: 1, values: vec![1.0; grid.points.len()].into() };
    grid.point_arrays.insert("trust".into(), Arc::new(ones));
    grid
}

/// The filter of that name, with some parameters set.
pub fn method(
    filters: &[Arc<dyn GradientFilter>],
    name: &str,
    values: impl IntoIterator<Item = (&'static str, ParameterValue)>,
) -> Result<Method> {
    let filter = filters.iter().find(|filter| filter.declaration().name == name).unwrap();
    Method::new(filter.clone(), Parameters::from_values(filter.declaration().parameters, values)?)
}

/// Gradient of the filter on the grid.
pub fn gradient(method: &Method, progress: &dyn Progress) -> Result<Gradient> {
    let grid = grid();
    let scalar = grid.scalar.clone().unwrap();
    method.gradient(&grid, &scalar, progress)
}

/// The largest difference from the filter that ships, in parts of the largest gradient.
pub fn difference_from(name: &str, found: &Gradient) -> f64 {
    let own = method(&voltet_core::field::filters(), name, []).unwrap();
    let own = gradient(&own, &NoProgress).unwrap();
    let largest = own.vectors.iter().map(|v| v.length()).fold(0.0, f64::max);
    let pairs = own.vectors.iter().zip(&found.vectors);
    assert_eq!(own.vectors.len(), found.vectors.len());
    pairs.map(|(a, b)| (*a - *b).length()).fold(0.0, f64::max) / largest
}
