//! Probes and histograms against integrals worked by hand, and against each other.

mod distributions;
mod hostile;
mod moments;
mod percentiles;

use crate::grid::Grid;
use crate::grid::generate::box_of_tetrahedra;
use crate::progress::Progress;
use glam::DVec3;
use std::sync::Mutex;

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

/// Shares of a stage that were reported; from one of them on the user has stopped it.
struct Shares {
    stage: &'static str,
    found: Mutex<Vec<f64>>,
    stops_at: f64,
}

impl Shares {
    fn of(stage: &'static str, stops_at: f64) -> Shares {
        Shares { stage, found: Mutex::default(), stops_at }
    }

    /// The largest share.
    fn last(&self) -> f64 {
        self.found.lock().unwrap().iter().copied().fold(0.0, f64::max)
    }

    fn count(&self) -> usize {
        self.found.lock().unwrap().len()
    }
}

impl Progress for Shares {
    fn report(&self, stage: &str, fraction: f64) {
        assert_eq!(stage, self.stage);
        self.found.lock().unwrap().push(fraction);
    }

    fn cancelled(&self) -> bool {
        self.last() >= self.stops_at
    }
}
