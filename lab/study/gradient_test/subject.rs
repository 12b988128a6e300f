//! A filter that is measured: its gradients, and what it said meanwhile.

use super::report::{Fault, FilterReport};
use glam::DVec3;
use voltet_core::Result;
use voltet_core::error::ErrorKind;
use voltet_core::field::Method;
use voltet_core::grid::Grid;
use voltet_core::parameters::{LocatedValue, Parameter};
use voltet_core::progress::{CancelOnly, Progress};

/// A filter that is measured.
pub(super) struct Subject<'a> {
    pub method: &'a Method,
    pub found: FilterReport,
}

impl<'a> Subject<'a> {
    /// Nothing is found of it yet.
    pub fn new(method: &'a Method) -> Subject<'a> {
        let kind = method.declaration();
        let value = |(parameter, setting): (&Parameter, Option<&LocatedValue>)| {
            let value =
                setting.map_or_else(|| parameter.default.to_string(), |setting| setting.datum.to_string());
            (parameter.name.to_string(), value)
        };
        let parameters = method.parameters().iter().map(|(p, setting, _)| value((p, setting))).collect();
        let found = FilterReport {
            name: kind.name.into(),
            summary: kind.summary.into(),
            parameters,
            convergence: Vec::new(),
            exactness: Vec::new(),
            materials: None,
            invariance: Vec::new(),
            noise: Vec::new(),
            cost: None,
            picture: None,
            faults: Vec::new(),
        };
        Subject { method, found }
    }

    /// ∇s at the points; `None` where the filter fails, which is noted. `at`: while what is measured.
    ///
    /// Errors: a stopped run.
    pub fn gradient(
        &mut self,
        at: impl FnOnce() -> String,
        grid: &Grid,
        scalar: &[f64],
        progress: &dyn Progress,
    ) -> Result<Option<Vec<DVec3>>> {
        let gradient = match self.method.gradient(grid, scalar, &CancelOnly(progress)) {
            Ok(gradient) => gradient,
            Err(error) if error.kind == ErrorKind::Cancelled => return Err(error),
            Err(error) => {
                self.found.faults.push(Fault { at: at(), what: error.to_string(), failed: true });
                return Ok(None);
            }
        };
        if !gradient.fallbacks.is_empty() {
            let each =
                gradient.fallbacks.iter().map(|one| format!("{} at {} points", one.what, one.point_count));
            let what = each.collect::<Vec<_>>().join("; ");
            self.found.faults.push(Fault { at: at(), what, failed: false });
        }
        Ok(Some(gradient.vectors))
    }
}

/// Root of the mean square of lengths and the largest of them.
pub(super) fn sizes(lengths: impl Iterator<Item = f64>) -> [f64; 2] {
    let (mut sum, mut most, mut count) = (0.0, 0.0f64, 0usize);
    for length in lengths {
        (sum, most, count) = (sum + length * length, most.max(length), count + 1);
    }
    [(sum / count.max(1) as f64).sqrt(), most]
}

/// log(e₁/e₂) / log(n₂/n₁) of the two finest; `None` below what rounding leaves.
pub(super) fn order(errors: &[f64], levels: &[usize]) -> Option<f64> {
    let [.., coarse, fine] = *errors else { return None };
    let [.., few, many] = *levels else { return None };
    (coarse.min(fine) > ROUNDING).then(|| (coarse / fine).ln() / (many as f64 / few as f64).ln())
}

/// Relative errors of gradients below this are rounding: of differences of values, over short edges.
const ROUNDING: f64 = 1e-10;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn orders_are_those_of_power_laws() {
        let levels = [4, 8, 16];
        let errors = |p: i32| levels.map(|n| 3.0 * f64::from(n as i32).powi(-p));
        for p in [1, 2, 3] {
            let found = order(&errors(p), &levels).unwrap_or(f64::NAN);
            assert!((found - f64::from(p)).abs() < 1e-12, "{found} for {p}");
        }
        assert_eq!(order(&[1e-3, 1e-14], &[4, 8]), None);
        assert_eq!(order(&[1e-3], &[4]), None);
    }

    #[test]
    fn sizes_of_nothing_are_zero() {
        assert_eq!(sizes(std::iter::empty()), [0.0; 2]);
        assert_eq!(sizes([3.0, 4.0].into_iter()), [12.5f64.sqrt(), 4.0]);
    }
}
