//! Requirements of a filter.

use super::options::{RequirementKind, TestOptions};
use super::report::{FilterReport, Requirement};

/// Requirements with their results.
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
    let share = |one: &super::report::Invariance| one.difference / one.rounding;
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
