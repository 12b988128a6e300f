//! What a filter is held to, and what users are warned of.

use super::report::{Convergence, FilterReport, Invariance, Series, TestOptions};
use serde::Serialize;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RequirementKind {
    /// A finite vector at every point, on every grid.
    Finite,
    /// Exact on linear fields, on every grid.
    Linear,
    /// Its order of convergence inside, on every family of grids.
    Order,
    /// Its order of convergence on the boundary, on every family of grids.
    Boundary,
    /// Equal gradients wherever the grid stands and however it is numbered.
    Invariance,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Requirement {
    /// In words, with the bound.
    pub what: String,
    pub found: String,
    pub holds: bool,
}

pub(super) fn requirements(found: &FilterReport, wish: &TestOptions) -> Vec<Requirement> {
    let of = |hold: &RequirementKind| match hold {
        RequirementKind::Finite => finite(found),
        RequirementKind::Linear => linear(found, wish.linear_error),
        RequirementKind::Order => order(found, wish.order),
        RequirementKind::Boundary => boundary(found, wish.boundary_order),
        RequirementKind::Invariance => invariance(found),
    };
    wish.hold_to.iter().map(of).collect()
}

/// What the filter is not held to and users find out all the same: errors on the boundary.
pub(super) fn warnings(found: &FilterReport, wish: &TestOptions) -> Vec<Requirement> {
    let is_held_to = wish.hold_to.contains(&RequirementKind::Boundary);
    let boundary = (!is_held_to).then(|| boundary(found, wish.boundary_order));
    // A filter that failed is reported as such.
    boundary.into_iter().filter(|one| !one.holds && one.found != NOTHING).collect()
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
    let timed = found.cost.iter().map(|cost| (cost.linear_error, "timed"));
    let data = found.data.iter().map(|data| (data.linear, "given"));
    let all = found.exactness.iter().map(|one| (one.linear, one.mesh)).chain(timed).chain(data);
    // Where it failed on every small grid, large ones show little.
    let worst = all.max_by(|a, b| a.0.total_cmp(&b.0)).filter(|_| !found.exactness.is_empty());
    let said = worst.map(|(error, mesh)| format!("{error:.1e} on the {mesh} grid"));
    let holds = worst.is_some_and(|(error, _)| error <= bound);
    Requirement { what, found: said.unwrap_or_else(|| NOTHING.into()), holds }
}

fn order(found: &FilterReport, least: f64) -> Requirement {
    let what = format!("converges inside on every family of grids: order {least} or more");
    convergence(found, what, least, |one| &one.inside)
}

fn boundary(found: &FilterReport, least: f64) -> Requirement {
    let what = format!("converges on the boundary of every family of grids: order {least} or more");
    convergence(found, what, least, |one| &one.boundary)
}

/// The least order of the series that `part` gives.
fn convergence(
    found: &FilterReport,
    what: String,
    least: f64,
    part: fn(&Convergence) -> &Series,
) -> Requirement {
    // Where only rounding is left there is nothing to converge.
    let orders = found.convergence.iter().filter_map(|one| Some((part(one).order?, one)));
    let worst = orders.min_by(|a, b| a.0.total_cmp(&b.0));
    let (said, holds) = match worst {
        Some((order, one)) => {
            let error = part(one).root_mean_square.last().copied().unwrap_or(f64::NAN);
            let (field, mesh) = (one.field, one.mesh);
            (
                format!(
                    "{order:.2} for {field} on the {mesh} grid, and an error of {error:.1e} on the finest"
                ),
                order >= least,
            )
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
