//! Values at the points of a grid, in the caller's order.

use crate::memory::array;
use glam::DVec3;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use voltet_core::volume::Volume;

/// The scalar, and g and ∇s where they are requested and available; NaN at points of no cell.
pub fn in_caller_order<'py>(
    py: Python<'py>,
    volume: &Volume,
    magnitude: bool,
    gradient: bool,
) -> PyResult<Bound<'py, PyDict>> {
    let grid = &*volume.grid;
    let grid_point = |point: usize| match &grid.file_cells {
        Some(cells) => cells.grid_point(point),
        None => Some(point),
    };
    let count = grid.file_cells.as_ref().map_or(grid.points.len(), |cells| cells.points.len());
    let numbers = |values: &[f64]| -> Vec<f64> {
        (0..count).map(|point| grid_point(point).map_or(f64::NAN, |p| values[p])).collect()
    };
    let arrays = PyDict::new(py);
    arrays.set_item("scalar", array(py, "f8", &numbers(&volume.scalar), &[count])?)?;
    if let Some(g) = volume.gradient_magnitude.as_ref().filter(|_| magnitude) {
        arrays.set_item("gradient_magnitude", array(py, "f8", &numbers(g), &[count])?)?;
    }
    if let Some(vectors) = volume.gradient.as_ref().filter(|_| gradient) {
        let all: Vec<DVec3> =
            (0..count).map(|point| grid_point(point).map_or(DVec3::NAN, |p| vectors[p])).collect();
        arrays.set_item("gradient", array(py, "f8", &all, &[count, 3])?)?;
    }
    Ok(arrays)
}
