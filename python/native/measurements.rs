//! Measurements: one pixel cell by cell, gradient filters by manufactured fields.

use crate::background::run_long;
use crate::error::guarded;
use crate::filter::registry;
use crate::value::settings;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use voltet_core::{Error, Result};
use voltet_graph::NodeProgress;
use voltet_study::gradient_test::{
    RequirementKind, TestOptions, gradient_test as measure, methods, page, plot, text,
};
use voltet_study::pixel::{self, Pixel};

/// Findings as JSON, as a table for people, and as a plot (SVG).
pub type Rendition = (String, String, String);

/// Output for a pixel; `all` is true if the table has every cell.
pub fn rendition(pixel: &Pixel, all: bool) -> Rendition {
    (pixel::json(pixel).to_string(), pixel::text(pixel, all), pixel::plot(pixel).svg())
}

/// Measures a gradient filter beside others: the findings, and the page.
#[pyfunction]
#[pyo3(signature = (name, set, beside, hold_to, order, linear_error, levels, timed, rounds, progress))]
#[allow(clippy::too_many_arguments)]
pub fn gradient_test(
    py: Python<'_>,
    name: String,
    set: &Bound<'_, PyDict>,
    beside: Option<Vec<String>>,
    hold_to: Vec<String>,
    order: f64,
    linear_error: f64,
    levels: Vec<usize>,
    timed: usize,
    rounds: usize,
    progress: Option<Py<PyAny>>,
) -> PyResult<(Rendition, bool, String)> {
    let set = settings(set)?;
    let (methods, wish) = guarded(py, || {
        let hold_to = hold_to.iter().map(|what| hold(what)).collect::<Result<Vec<RequirementKind>>>()?;
        let wish = TestOptions { levels, timed, rounds, hold_to, order, linear_error };
        wish.check(|name| format!("'{name}'"))?;
        Ok((methods(&name, &set, beside.as_deref(), &registry()?)?, wish))
    })?;
    run_long(py, progress.as_ref(), |observer| {
        let found = measure(&methods, &wish, &NodeProgress { observer, node: "gradient-test" })?;
        let words = serde_json::to_string(&found).map_err(|error| Error::run(error.to_string()))?;
        let plot = plot(&found).svg();
        let page = page(&found, &plot);
        Ok(((words, text(&found), plot), found.passed(), page))
    })
}

fn hold(what: &str) -> Result<RequirementKind> {
    match what {
        "finite" => Ok(RequirementKind::Finite),
        "linear" => Ok(RequirementKind::Linear),
        "order" => Ok(RequirementKind::Order),
        "invariance" => Ok(RequirementKind::Invariance),
        other => {
            let error = Error::usage("'hold_to' names nothing that a filter can be held to").got(other);
            Err(error.expected("finite, linear, order, invariance"))
        }
    }
}
