//! Measurements: gradient filters by manufactured fields, and error against run time as `voltet study` measures it.

use crate::background::run_long;
use crate::error::guarded;
use crate::filter::registry;
use crate::value::settings;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use voltet_core::{Error, Result};
use voltet_graph::NodeProgress;
use voltet_nodes::drawing::ENGINES;
use voltet_optics::integrators::Integrator;
use voltet_study::gradient_test::{
    RequirementKind, TestOptions, gradient_test as measure, methods, page, plot, text,
};
use voltet_study::work_precision::{self, Engines, Frames, StudyOptions};

/// Findings as JSON, as a table for people, and as a plot (SVG).
pub type Rendition = (String, String, String);

/// Measures a gradient filter beside others: the findings, and the page.
#[pyfunction]
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
        let boundary_order = TestOptions::default().boundary_order;
        let wish = TestOptions { levels, timed, rounds, hold_to, order, boundary_order, linear_error };
        wish.check(|name| format!("'{name}'"))?;
        Ok((methods(&name, &set, beside.as_deref(), &registry()?)?, wish))
    })?;
    run_long(py, progress.as_ref(), |observer| {
        let found = measure(&methods, &wish, None, &NodeProgress { observer, node: "gradient-test" })?;
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
        "boundary" => Ok(RequirementKind::Boundary),
        "invariance" => Ok(RequirementKind::Invariance),
        other => {
            let error = Error::usage("'hold_to' names nothing that a filter can be held to").got(other);
            Err(error.expected("finite, linear, order, boundary, invariance"))
        }
    }
}

/// Options of a study, as on the command line. `engine`: "cpu", "gpu" or "all"; `patience`: seconds.
pub fn study_options(
    only: Vec<String>,
    engine: &str,
    adapter: Option<String>,
    frames: usize,
    patience: f64,
    max_error: Option<f64>,
) -> Result<StudyOptions> {
    let engines = match ENGINES.iter().find(|known| known.name == engine) {
        Some(found) => Engines::One(found),
        None if engine == "all" => Engines::All,
        None => {
            let names = ENGINES.iter().map(|known| known.name).chain(["all"]);
            let error = Error::usage("'engine' names no engine").got(engine);
            return Err(error.not_among(engine, names));
        }
    };
    let patience = work_precision::patience(patience, "'patience'")?;
    let frames = Frames { count: frames, patience, turn: 0.0, in_flight: 1 };
    let options = StudyOptions { only, engines, adapter, frames, max_error, ..StudyOptions::default() };
    let studied = work_precision::studied(&registry()?);
    let names: Vec<&str> = studied.iter().map(Integrator::name).collect();
    options.check(&names, |name| format!("'{name}'"))?;
    Ok(options)
}
