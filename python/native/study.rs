//! Error against run time, as `voltet study` measures it.

use std::path::PathBuf;
use voltet_core::picture::Picture;
use voltet_core::{Error, Result};
use voltet_graph::NodeProgress;
use voltet_graph::{Graph, Observer, suggest};
use voltet_nodes::drawing::ENGINES;
use voltet_optics::integrators::Integrator;
use voltet_study::work_precision::{
    Benches, Engines, Frames, StudyOptions as Options, Subject, cache_folder, json, patience, reference,
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
        let request = Options {
            only: self.only.clone(),
            engines,
            adapter: self.adapter.clone(),
            frames: Frames {
                count: self.frames,
                patience: patience(self.patience, "'patience'")?,
                turn: 0.0,
                in_flight: 1,
            },
            max_error: self.max_error,
            ..Options::default()
        };
        let names: Vec<&str> = studied.iter().map(Integrator::name).collect();
        request.check(&names, |name| format!("'{name}'"))?;
        Ok(request)
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
