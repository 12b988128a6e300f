//! The examples: least squares in each language.

use crate::support::{built, difference_from, gradient, method};
use voltet_core::parameters::ParameterValue;
use voltet_core::progress::NoProgress;

/// Sums in another order, without the built-in's step of refinement, over matrices whose condition is some tens.
const ROUNDING: f64 = 1e-12;

fn is_least_squares(sources: &[&str], options: &[&str], name: &str) {
    let Some(built) = built(sources, options) else { return };
    let filters = voltet_plugins::load(&built.path).unwrap().filters;
    let found = gradient(&method(&filters, name, []).unwrap(), &NoProgress).unwrap();
    let difference = difference_from("least-squares", &found);
    assert!(difference < ROUNDING, "{name}: {difference:e}");
    // The power is heard.
    let other = method(&filters, name, [("power", ParameterValue::Number(2.0))]).unwrap();
    let difference = difference_from("least-squares", &gradient(&other, &NoProgress).unwrap());
    assert!(difference > 1e-4, "{name}: {difference:e}");
}

#[test]
fn least_squares_in_c_is_the_one_that_ships() {
    is_least_squares(&["examples/plugin_c/least_squares.c"], &[], "c-least-squares");
}

#[test]
fn least_squares_in_cpp_is_the_one_that_ships() {
    is_least_squares(&["examples/plugin_cpp/least_squares.cpp"], &[], "cpp-least-squares");
}

#[test]
fn least_squares_in_fortran_is_the_one_that_ships() {
    let sources = [
        "include/voltet_plugin.f90",
        "examples/plugin_fortran/least_squares.f90",
        "include/voltet_plugin_fortran.c",
    ];
    is_least_squares(&sources, &[], "fortran-least-squares");
}
