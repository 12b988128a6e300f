//! Values of points or cells.

use crate::SharedSlice;

/// Values of one array, one tuple a point (or cell), components of a tuple side by side.
#[derive(Debug, Clone, PartialEq)]
pub struct Array {
    /// Components of a tuple, at least 1.
    pub component_count: usize,
    /// `tuples × component_count` values.
    pub values: SharedSlice<f64>,
}
