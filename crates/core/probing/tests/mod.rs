//! Probes and histograms against integrals worked by hand, and against each other.

mod distributions;
mod hostile;
mod moments;
mod percentiles;

use crate::grid::Grid;
use crate::grid::generate::box_of_tetrahedra;
use glam::DVec3;

/// The unit cube in some hundred irregular tetrahedra.
fn cube() -> Grid {
    box_of_tetrahedra([4, 3, 5], [DVec3::ZERO, DVec3::ONE], 0.2)
}

/// Numbers between 0 and 1, always the same.
fn numbers() -> impl FnMut() -> f64 {
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1_u64 << 53) as f64
    }
}

#[track_caller]
fn close(found: f64, wanted: f64, tolerance: f64) {
    assert!((found - wanted).abs() <= tolerance, "{found} is not {wanted} to {tolerance:e}");
}
