//! Tests of the gradient filters: orders of convergence, exactness, values worked by hand, hostile input.

mod convergence;
mod exact;
mod hostile;
mod method;
mod several;

use super::*;
use crate::Result;
use crate::SharedSlice;
use crate::grid::generate::{Random, box_of_tetrahedra, sample};
use crate::grid::{Grid, tetrahedron_volume};
use crate::parameters::{Parameters, VariantSchema};
use crate::progress::{NoProgress, Progress};

pub(super) const UNIT: [DVec3; 2] = [DVec3::ZERO, DVec3::ONE];

/// The methods that compute something.
pub(super) const METHODS: [&str; 4] = ["least-squares", "quadratic-fit", "volume-weighted", "cell-average"];

pub(super) fn filter(name: &str) -> Arc<dyn GradientFilter> {
    filters().into_iter().find(|filter| filter.declaration().name == name).unwrap()
}

pub(super) fn gradient(method: &str, grid: &Grid, scalar: &[f64]) -> Gradient {
    let result = Method::with_defaults(filter(method)).unwrap().gradient(grid, scalar, &NoProgress).unwrap();
    assert_eq!(result.vectors.len(), grid.points.len());
    assert!(result.vectors.iter().all(|v| v.is_finite()), "{method}: all finite");
    result
}

/// A grid of tetrahedra over these points.
pub(super) fn grid_of(points: Vec<DVec3>, tetrahedra: Vec<[u32; 4]>) -> Grid {
    Grid { points: SharedSlice::from(points), tetrahedra: SharedSlice::from(tetrahedra), ..Grid::default() }
}

/// Grid with every point moved by `f`.
pub(super) fn moved(grid: &Grid, f: impl Fn(DVec3) -> DVec3) -> Grid {
    Grid { points: SharedSlice::from(sample(grid, f)), ..grid.clone() }
}
