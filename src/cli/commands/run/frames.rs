//! Frames of one pipeline, drawn one after the other by one session.

use super::Call;
use crate::cli::arguments::Run;
use crate::cli::commands::shared::{FAILED, show, tell, warn};
use crate::cli::present::{counted_figures, findings, name, say};
use crate::core::error::ErrorKind;
use crate::core::{Error, Result, counted};
use crate::document::{Document, LocatedError};
use crate::graph::{Registry, RunReport};
use crate::io::provenance::run_report;
use crate::nodes::files::FileIdentity;
use crate::series::{self, Frame, FrameSelection, Steps};
use serde_json::{Value, json};
use std::collections::HashMap;
use std::path::PathBuf;

/// Failures that are named at the end.
const MAX_NAMED: usize = 12;

/// Frames of one pipeline.
pub(super) struct Plan {
    /// The pipeline of the only picture, or of the first frame.
    pub first: Document,
    /// The pipeline as the file states it, with its frames; `None`: it is run for one picture.
    pub frames: Option<Frames>,
    /// Files that are written.
    pub outputs: Vec<PathBuf>,
}

/// Frames, and the pipeline that they are changes of.
pub(super) struct Frames {
    document: Document,
    frames: Vec<Frame>,
}

/// The plans of pipelines, checked frame by frame before the first is drawn.
pub(super) fn plans(
    documents: &[Document],
    arguments: &Run,
    registry: &Registry,
) -> std::result::Result<Vec<Plan>, LocatedError> {
    let selection = selection(arguments);
    documents.iter().map(|document| plan(document, &selection, registry)).collect()
}

fn selection(arguments: &Run) -> FrameSelection {
    let options = &arguments.frames;
    let by_number = options.steps.clone().map(Steps::Numbers);
    FrameSelection { steps: by_number.or_else(|| options.times.clone().map(Steps::Times)) }
}

fn plan(
    document: &Document,
    selection: &FrameSelection,
    registry: &Registry,
) -> std::result::Result<Plan, LocatedError> {
    let frames = series::frames(document, selection).map_err(|error| document.failure(error))?;
    let mut outputs = Vec::new();
    let mut writers: HashMap<FileIdentity, usize> = HashMap::new();
    let mut first = None;
    for (number, frame) in frames.iter().enumerate() {
        let changed = document.changed(&frame.changes, registry)?;
        for path in changed.outputs() {
            let other = FileIdentity::from_path(&path).and_then(|file| writers.insert(file, number));
            if let Some(other) = other.filter(|other| *other != number) {
                let error = Error::usage("two frames would be written to one file");
                let found =
                    format!("'{}' of {} and of {}", path.display(), frames[other].label(), frame.label());
                let expected = "{frame} in the name, or another mark in which they differ";
                return Err(document.failure(error.got(found).expected(expected)));
            }
            outputs.push(path);
        }
        first.get_or_insert(changed);
    }
    let Some(first) = first else {
        return Err(Error::usage("there is no frame to draw").in_file(&document.path).into());
    };
    let is_series = frames.len() > 1;
    let document = if is_series { Some(document.changed(&[], registry)?) } else { None };
    Ok(Plan { first, frames: document.map(|document| Frames { document, frames }), outputs })
}

/// What a run said before, which is not said again.
#[derive(Default)]
struct Said {
    findings: String,
    warnings: Vec<String>,
}

impl Call<'_> {
    /// Draws the frames; false if it was stopped. A frame that fails is named at the end, and the others are drawn.
    pub(super) fn run_frames(
        &mut self,
        plan: &Plan,
        Frames { document, frames }: &Frames,
    ) -> std::result::Result<bool, LocatedError> {
        if !self.arguments.quiet {
            warn(&plan.first);
        }
        let (mut said, mut failures, mut steps) = (Said::default(), Vec::new(), Vec::new());
        let mut is_stopped = false;
        for (number, frame) in frames.iter().enumerate() {
            let changed = document.changed(&frame.changes, self.registry)?;
            let place = format!("{}/{} {}", number + 1, frames.len(), frame.label());
            let outcome = self.session.run(&changed.graph, &self.bar);
            self.bar.clear();
            match outcome {
                Ok(report) => {
                    self.tell_frame(&mut said, &place, &report, changed.graph.warnings.len())?;
                    steps.push(entry(frame, Some(&report), None, &changed));
                }
                Err(error) => {
                    is_stopped = error.kind == ErrorKind::Cancelled;
                    // A mistake of the pipeline is one of every frame.
                    let ends = is_stopped || number == 0 && error.kind == ErrorKind::Usage;
                    steps.push(entry(frame, None, Some(&error), &changed));
                    let failure = changed
                        .failure(Error { what: format!("{}: {}", frame.label(), error.what), ..error });
                    let code = show(&failure);
                    if ends {
                        self.worst = self.worst.max(code);
                        break;
                    }
                    self.worst = self.worst.max(FAILED);
                    failures.push(frame.label());
                }
            }
        }
        if !failures.is_empty() {
            say(&failed(&failures, frames.len()));
        }
        let path = document.path.display().to_string();
        self.reports.push(json!({ "file": path, "title": document.graph.stated.title, "steps": steps }));
        Ok(!is_stopped)
    }

    /// Shows a line about a frame, with findings and warnings that no frame before gave.
    fn tell_frame(&self, said: &mut Said, place: &str, report: &RunReport, shown: usize) -> Result<()> {
        if self.arguments.quiet {
            return Ok(());
        }
        for warning in report.warnings.iter().skip(shown) {
            if !said.warnings.contains(warning) {
                say(&format!("warning: {}\n", name(warning)));
                said.warnings.push(warning.clone());
            }
        }
        let found = findings(report);
        if found != said.findings {
            tell(&found, self.streams)?;
            said.findings = found;
        }
        tell(&format!("{place}: {}", counted_figures(report)), self.streams)
    }
}

/// A line that names the frames that failed.
fn failed(labels: &[String], count: usize) -> String {
    let shown = labels[..labels.len().min(MAX_NAMED)].join("; ");
    let more = match labels.len().saturating_sub(MAX_NAMED) {
        0 => String::new(),
        more => format!("; and {more} more"),
    };
    format!("{} of {} failed: {shown}{more}\n", labels.len(), counted(count, "frame"))
}

/// A frame in the report.
fn entry(frame: &Frame, report: Option<&RunReport>, error: Option<&Error>, document: &Document) -> Value {
    let marks = &frame.marks;
    let path = document.path.display().to_string();
    json!({
        "step": marks.step,
        "time": marks.time,
        "stem": marks.stem,
        "run": report.map(|report| run_report(&path, report, &document.graph.stated)),
        "error": error.map(Error::to_string),
    })
}
