//! Measurements and pictures of scenes: one pixel cell by cell, gradient filters by manufactured fields, error against run time as
//! `voltet study` measures it, and pictures of rays that end at opaque surfaces of other renderers.

use crate::background::run_long;
use crate::error::guarded;
use crate::filter::registry;
use crate::value::settings;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;
use std::time::Duration;
use voltet::render_to_depth;
use voltet_core::picture::Picture;
use voltet_core::{Error, Result};
use voltet_graph::{Graph, NodeProgress, Observer, Session, suggest};
use voltet_nodes::drawing::ENGINES;
use voltet_optics::integrators::Integrator;
use voltet_study::gradient_test::{
    RequirementKind, TestOptions, gradient_test as measure, methods, page, plot, text,
};
use voltet_study::pixel::{self, Pixel};
use voltet_study::work_precision::{
    Benches, Engines, Frames, Measure, StudyOptions as Options, Subject, cache_folder, json, reference,
    study, write,
};

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

/// Options of a measure_study, as on the command line.
pub struct StudyOptions {
    pub node: Option<String>,
    pub only: Vec<String>,
    /// "cpu", "gpu" or "all".
    pub engine: String,
    pub adapter: Option<String>,
    pub frames: usize,
    /// Seconds.
    pub patience: f64,
    pub max_error: Option<f64>,
    /// Folder of its files; `None`: none are written.
    pub output: Option<PathBuf>,
}

impl StudyOptions {
    fn request(&self, studied: &[Integrator]) -> Result<Options> {
        let known = || studied.iter().map(|integrator| integrator.name());
        if let Some(name) = self.only.iter().find(|name| !known().any(|known| known == name.as_str())) {
            let error = Error::usage("'only' names no integrator that can be studied").got(name);
            return Err(error.expected(suggest(name, known())));
        }
        let engines = match self.engine.as_str() {
            "all" => Engines::All,
            name => {
                let found = ENGINES.iter().find(|engine| engine.name == name).map(Engines::One);
                let names = || ENGINES.iter().map(|engine| engine.name).chain(["all"]);
                found.ok_or_else(|| {
                    let error = Error::usage("'engine' names no engine").got(name);
                    error.expected(suggest(name, names()))
                })?
            }
        };
        let wrong = |what: &str, found: f64| {
            let error = Error::usage(format!("'{what}' is out of range")).got(found);
            Err(error.expected("a number of at least 0"))
        };
        for (name, value) in [("patience", self.patience), ("max_error", self.max_error.unwrap_or(0.0))] {
            if !(value.is_finite() && value >= 0.0) {
                return wrong(name, value);
            }
        }
        if self.frames == 0 {
            return Err(Error::usage("'frames' is out of range").got(0).expected("1 or more"));
        }
        Ok(Options {
            only: self.only.clone(),
            engines,
            adapter: self.adapter.clone(),
            // A year is longer than any patience, and does not overflow.
            frames: Frames {
                count: self.frames,
                patience: Duration::from_secs_f64(self.patience.min(3e7)),
                turn: 0.0,
                in_flight: 1,
            },
            study: Measure::default(),
            max_error: self.max_error,
            refine: 0,
        })
    }
}

/// Measures: the measure_study as JSON, and the reference picture.
pub fn measure_study(
    graph: &Graph,
    title: &str,
    options: &StudyOptions,
    observer: &dyn Observer,
) -> Result<(String, Picture)> {
    let progress = NodeProgress { observer, node: "measure_study" };
    let mut session = voltet_nodes::session();
    let subject = Subject::gather(graph, options.node.as_deref(), false, &mut session, observer)?;
    let request = options.request(&subject.studied())?;
    let benches = Benches::open(&subject, &request)?;
    let reference = reference(&subject, &cache_folder(), &progress)?;
    let measure_study = study(subject, request, benches, reference, &progress)?;
    if measure_study.stopped() && observer.cancelled() {
        return Err(Error::cancelled());
    }
    if let Some(folder) = &options.output {
        write(&measure_study, title, folder)?;
    }
    Ok((json(&measure_study, title).to_string(), measure_study.reference.picture))
}

/// Renders the picture of a node, each ray up to its depth.
pub fn render_to_depths(
    graph: &Graph,
    session: &mut Session,
    node: &str,
    ends: &[f32],
    observer: &dyn Observer,
) -> Result<Picture> {
    let scene = Subject::gather(graph, Some(node), false, session, observer)?.scene;
    render_to_depth(&scene, ends, &NodeProgress { observer, node })
}
