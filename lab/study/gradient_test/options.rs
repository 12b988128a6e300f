//! Options of a test of gradient filters.

use voltet_core::field::Method;
use voltet_core::{Error, Result};
use voltet_graph::{Field, Parameters, Registry, SourceSpan};

#[derive(Debug, Clone)]
pub struct TestOptions {
    /// Boxes along a side of each grid, coarse to fine, two at least.
    pub levels: Vec<usize>,
    /// Boxes along a side of the grid that is timed.
    pub timed: usize,
    /// Number of times each filter is timed, after once that warms up.
    pub rounds: usize,
    pub hold_to: Vec<RequirementKind>,
    /// The least order of convergence inside.
    pub order: f64,
    /// The largest error on linear fields, by the largest gradient.
    pub linear_error: f64,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RequirementKind {
    /// A finite vector at every point, on every grid.
    Finite,
    /// Exact on linear fields, on every grid.
    Linear,
    /// Its order of convergence inside, on every family of grids.
    Order,
    /// Equal gradients wherever the grid stands and however it is numbered.
    Invariance,
}

impl TestOptions {
    /// Refuses what cannot be measured. `named`: what a number is called where it was given.
    pub fn check(&self, named: impl Fn(&str) -> String) -> Result<()> {
        let wrong = |what: &str, found: String, accepted: &str| {
            let error = Error::usage(format!("{} is out of range", named(what)));
            Err(error.got(found).expected(accepted))
        };
        let rising = self.levels.windows(2).all(|pair| pair[0] < pair[1]);
        if self.levels.len() < 2 || !rising || self.levels.iter().any(|n| !(2..=128).contains(n)) {
            let accepted = "two or more rising numbers from 2 to 128, such as 4,8,16";
            return wrong("levels", format!("{:?}", self.levels), accepted);
        }
        if !(2..=200).contains(&self.timed) {
            return wrong("timed", self.timed.to_string(), "2 to 200 boxes along a side");
        }
        if self.rounds == 0 {
            return wrong("rounds", "0".into(), "1 or more");
        }
        if !self.order.is_finite() {
            return wrong("order", self.order.to_string(), "a number");
        }
        if self.linear_error.is_nan() || self.linear_error < 0.0 {
            return wrong("linear_error", self.linear_error.to_string(), "a number of at least 0");
        }
        Ok(())
    }
}

impl Default for TestOptions {
    fn default() -> TestOptions {
        TestOptions {
            levels: vec![4, 8, 16, 24],
            timed: 40,
            rounds: 5,
            hold_to: vec![
                RequirementKind::Finite,
                RequirementKind::Linear,
                RequirementKind::Order,
                RequirementKind::Invariance,
            ],
            order: 0.8,
            linear_error: 1e-9,
        }
    }
}

/// The filter of this name with what is set of its parameters, then those `beside` it with their standard values: all others that can
/// be tested, without names.
///
/// Errors: no such filter or parameter; a filter that reads arrays, of which manufactured grids carry none.
pub fn methods(
    name: &str,
    set: &[Field],
    beside: Option<&[String]>,
    registry: &Registry,
) -> Result<Vec<Method>> {
    let testable = |method: Method| match method.arrays()?.first() {
        None => Ok(method),
        Some(array) => Err(Error::usage("the filter reads a point array, and manufactured grids carry none")
            .got(format!("'{array}'"))
            .expected("a filter that computes gradients")),
    };
    let filter = registry.find_filter(name)?.clone();
    let declared = filter.declaration().parameters;
    let parameters = Parameters::check(declared, set, &SourceSpan::Nowhere, &[])?;
    let method = testable(Method::new(filter, parameters)?).map_err(|error| error.at_item(name))?;
    let mut methods = vec![method];
    let others: Vec<String> = match beside {
        Some(names) => names.to_vec(),
        None => registry.filters().map(|filter| filter.declaration().name.to_string()).collect(),
    };
    for name in others.iter().filter(|other| *other != name && !other.is_empty()) {
        // Those that cannot go without parameters or arrays are left out, unless they were asked for.
        match Method::with_defaults(registry.find_filter(name)?.clone()).and_then(testable) {
            Ok(other) => methods.push(other),
            Err(error) if beside.is_some() => return Err(error.at_item(name)),
            Err(_) => {}
        }
    }
    Ok(methods)
}
