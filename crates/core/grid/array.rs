//! Values of points or cells.

use crate::SharedSlice;

/// An array with one tuple a point (or cell), components of a tuple side by side.
#[derive(Debug, Clone, PartialEq)]
pub struct Array {
    /// Components of a tuple, at least 1.
    pub component_count: usize,
    /// `tuples × component_count` values.
    pub values: SharedSlice<f64>,
}

impl From<SharedSlice<f64>> for Array {
    fn from(values: SharedSlice<f64>) -> Self {
        Array { component_count: 1, values }
    }
}

impl From<Vec<f64>> for Array {
    fn from(values: Vec<f64>) -> Self {
        SharedSlice::from(values).into()
    }
}

impl From<&[f64]> for Array {
    fn from(values: &[f64]) -> Self {
        values.to_vec().into()
    }
}

impl From<Vec<f32>> for Array {
    fn from(values: Vec<f32>) -> Self {
        values.into_iter().map(f64::from).collect::<Vec<f64>>().into()
    }
}

impl From<Vec<[f64; 3]>> for Array {
    fn from(vectors: Vec<[f64; 3]>) -> Self {
        Array { component_count: 3, values: vectors.into_flattened().into() }
    }
}
