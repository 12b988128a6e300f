//! Results of gradient filters.

use super::options::{RequirementKind, TestOptions};
use serde::Serialize;

/// Filters measured side by side: the first is the one that was asked about.
#[derive(Debug, Clone, Serialize)]
pub struct GradientTest {
    pub filters: Vec<FilterReport>,
    pub requirements: Vec<Requirement>,
    /// Boxes along a side of each grid, coarse to fine.
    pub levels: Vec<usize>,
    /// Threads that filters may use.
    pub threads: usize,
    pub engine: String,
    /// The picture with the exact gradient, PNG.
    #[serde(skip)]
    pub exact_png: Vec<u8>,
}

#[derive(Debug, Clone, Default, Serialize)]
pub struct FilterReport {
    pub name: String,
    pub summary: String,
    /// Its parameters with their values, as a pipeline file would write them.
    pub parameters: Vec<(String, String)>,
    /// Errors on finer and finer grids: one entry a family of grids and field.
    pub convergence: Vec<Convergence>,
    /// Errors where a filter may be exact: one entry a family of grids.
    pub exactness: Vec<Exactness>,
    /// Two materials that meet in a plane of the grid.
    pub materials: Option<Materials>,
    /// Differences by changes that should have no effect.
    pub invariance: Vec<Invariance>,
    /// Gradients of noise: one entry a family of grids.
    pub noise: Vec<Noise>,
    pub cost: Option<Cost>,
    pub picture: Option<PictureError>,
    /// Places at which the filter failed or fell back, with its words.
    pub faults: Vec<Fault>,
}

/// Errors of one field on one family of grids.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Convergence {
    pub mesh: &'static str,
    pub field: &'static str,
    pub inside: Series,
    pub boundary: Series,
}

/// Errors from coarse to fine.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Series {
    /// Root of the mean square of |found − exact|, by that of |exact| over all points.
    pub root_mean_square: Vec<f64>,
    /// The largest |found − exact|, by the same.
    pub maximum: Vec<f64>,
    /// log(e₁/e₂) / log(n₂/n₁) of the two finest root mean squares; `None` where there is only rounding left to compare.
    pub order: Option<f64>,
}

/// Largest errors on a field that a filter may get exactly, relative to the largest gradient.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Exactness {
    pub mesh: &'static str,
    pub linear: f64,
    pub quadratic_inside: f64,
    pub quadratic_boundary: f64,
}

/// Two materials that meet in a plane of the grid: the slope across jumps there.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Materials {
    /// The largest error beyond two cells from the plane, by the jump, from coarse to fine.
    pub beyond: Vec<f64>,
    /// Its order; `None` where rounding is all that is left.
    pub order: Option<f64>,
    /// Cells from the plane, on the finest grid, within which errors are above a hundredth of the jump.
    pub reach: usize,
    /// The largest overshoot of ∂s/∂x beyond both of its values, by the jump, on the finest grid.
    pub overshoot: f64,
}

/// Difference by a change that moves a gradient in space alone.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Invariance {
    /// Change of the grid or the scalar.
    pub under: &'static str,
    /// The largest difference, by the largest gradient.
    pub difference: f64,
    /// Differences that rounding alone may make.
    pub rounding: f64,
}

/// Gradients of independent noise of variance 1 at the points.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Noise {
    pub mesh: &'static str,
    /// Root of the mean square of |∇noise| × spacing, inside.
    pub inside: f64,
    /// Root of the mean square of |∇noise| × spacing, on the boundary.
    pub boundary: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Cost {
    pub points: usize,
    pub tetrahedra: usize,
    /// Median of the seconds, filters taking turns.
    pub median_s: f64,
    pub fastest_s: f64,
    pub slowest_s: f64,
    /// Bytes that the process held at most beyond those before; `None` where the system does not tell.
    pub memory_bytes: Option<u64>,
}

/// A picture with its gradient magnitude, against the same with the exact one.
#[derive(Debug, Clone, Serialize)]
pub struct PictureError {
    pub size: [u32; 2],
    pub maximum: f64,
    pub root_mean_square: f64,
    /// Pixels that differ by more than 1/255.
    pub pixels_over_step: u64,
    #[serde(skip)]
    pub png: Vec<u8>,
}

/// A filter that failed, or did with less than it promises.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Fault {
    /// While what was measured.
    pub at: String,
    /// Message of the filter, or of the check of its vectors.
    pub what: String,
    /// True if it gave nothing; else it fell back at some points.
    pub failed: bool,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Requirement {
    /// In words, with the bound.
    pub what: String,
    pub found: String,
    pub holds: bool,
}

impl GradientTest {
    /// True if the first filter keeps all that it is held to.
    pub fn passed(&self) -> bool {
        self.requirements.iter().all(|requirement| requirement.holds)
    }
}

pub(super) fn requirements(found: &FilterReport, wish: &TestOptions) -> Vec<Requirement> {
    let of = |hold: &RequirementKind| match hold {
        RequirementKind::Finite => finite(found),
        RequirementKind::Linear => linear(found, wish.linear_error),
        RequirementKind::Order => order(found, wish.order),
        RequirementKind::Invariance => invariance(found),
    };
    wish.hold_to.iter().map(of).collect()
}

/// Result of the other requirements for a filter that failed.
const NOTHING: &str = "nothing: the filter failed";

fn finite(found: &FilterReport) -> Requirement {
    let failed: Vec<_> = found.faults.iter().filter(|fault| fault.failed).collect();
    let said = match failed.as_slice() {
        [] => "one wherever it was asked".to_string(),
        [first, ..] => format!("{} failures, the first at {}: {}", failed.len(), first.at, first.what),
    };
    Requirement { what: "gives a finite vector at every point".into(), found: said, holds: failed.is_empty() }
}

fn linear(found: &FilterReport, bound: f64) -> Requirement {
    let what = format!("is exact on linear fields: errors of at most {bound:e}");
    let worst = found.exactness.iter().max_by(|a, b| a.linear.total_cmp(&b.linear));
    let said = worst.map(|worst| format!("{:.1e} on the {} grid", worst.linear, worst.mesh));
    let holds = worst.is_some_and(|worst| worst.linear <= bound);
    Requirement { what, found: said.unwrap_or_else(|| NOTHING.into()), holds }
}

fn order(found: &FilterReport, least: f64) -> Requirement {
    let what = format!("converges inside on every family of grids: order {least} or more");
    // Where only rounding is left there is nothing to converge.
    let orders = found.convergence.iter().filter_map(|one| Some((one.inside.order?, one)));
    let worst = orders.min_by(|a, b| a.0.total_cmp(&b.0));
    let (said, holds) = match worst {
        Some((order, one)) => {
            (format!("{order:.2} for {} on the {} grid", one.field, one.mesh), order >= least)
        }
        None if found.convergence.is_empty() => (NOTHING.into(), false),
        None => ("rounding alone".into(), true),
    };
    Requirement { what, found: said, holds }
}

fn invariance(found: &FilterReport) -> Requirement {
    let what = "changes by rounding alone where the grid is moved, turned, scaled or numbered otherwise, and with the \
                scalar's units"
        .into();
    let share = |one: &Invariance| one.difference / one.rounding;
    let worst = found.invariance.iter().max_by(|a, b| share(a).total_cmp(&share(b)));
    let said = worst.map(|worst| {
        format!(
            "{:.1e} under {}, where rounding may make {:.1e}",
            worst.difference, worst.under, worst.rounding
        )
    });
    let holds = worst.is_some_and(|worst| share(worst) <= 1.0);
    Requirement { what, found: said.unwrap_or_else(|| NOTHING.into()), holds }
}
