//! Error against run time, as `voltet study` measures it.

use std::path::PathBuf;
use std::time::Duration;
use voltet_core::picture::Picture;
use voltet_core::{Error, Result};
use voltet_graph::NodeProgress;
use voltet_graph::{Graph, Observer, suggest};
use voltet_nodes::drawing::ENGINES;
use voltet_optics::integrators::Integrator;
use voltet_study::work_precision::{
    Benches, Engines, Frames, Measure, StudyOptions as Options, Subject, cache_folder, json, reference,
    study as measure, write,
};

/// Options of a study, as on the command line.
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
            measure: Measure::default(),
            max_error: self.max_error,
            refine: 0,
        })
    }
}

/// Measures: the study as JSON, and the reference picture.
pub fn study(
    graph: &Graph,
    title: &str,
    options: &StudyOptions,
    observer: &dyn Observer,
) -> Result<(String, Picture)> {
    let progress = NodeProgress { observer, node: "study" };
    let mut session = voltet_nodes::session();
    let subject = Subject::gather(graph, options.node.as_deref(), false, &mut session, observer)?;
    let request = options.request(&subject.studied())?;
    let benches = Benches::open(&subject, &request)?;
    let reference = reference(&subject, &cache_folder(), &progress)?;
    let study = measure(subject, request, benches, reference, &progress)?;
    if study.stopped() && observer.cancelled() {
        return Err(Error::cancelled());
    }
    if let Some(folder) = &options.output {
        write(&study, title, folder)?;
    }
    Ok((json(&study, title).to_string(), study.reference.picture))
}
