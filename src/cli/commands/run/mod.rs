//! `voltet run`: runs pipeline files headless, each for one picture or for the frames of a series.

mod frames;

use super::shared::{DONE, Outcome, ShortOption, open_all, show, tell, warn};
use crate::Document;
use crate::cli::arguments::Run;
use crate::cli::present::{Bar, say, summary, warnings};
use crate::core::error::ErrorKind;
use crate::core::{Error, Result};
use crate::document;
use crate::graph::{Observer, ParameterValue, Registry, RunReport, Session};
use crate::io::provenance::{run_report, whole_report};
use crate::nodes::files;
use frames::Plan;
use serde_json::Value;
use voltet_study::ExhaustiveComparison;

pub fn run(arguments: &Run, registry: &Registry) -> Outcome {
    // Every file is checked before the first one runs.
    let (documents, wrong) = open_all(&arguments.files, &shorts(arguments), registry);
    if wrong != DONE {
        return Ok(wrong);
    }
    documents.iter().try_for_each(Document::refuse_missing_data)?;
    let plans = frames::plans(&documents, arguments, registry)?;
    let report = arguments.report.as_deref().map(|path| ("--report", path));
    let first = plans.iter().map(|plan| &plan.first);
    document::refuse_conflicts(first, true, report.as_slice())?;
    arguments.report.as_deref().map_or(Ok(()), files::refuse_unwritable)?;
    let outputs = plans.iter().flat_map(|plan| &plan.outputs).chain(&arguments.report);
    let streams = outputs.into_iter().any(|path| files::is_standard_output(path));
    refuse_exhaustive(arguments, &plans, streams)?;
    let mut call = Call {
        arguments,
        registry,
        bar: Bar::new(arguments.quiet),
        session: crate::nodes::session(),
        streams,
        worst: DONE,
        reports: Vec::new(),
    };
    for plan in &plans {
        let goes_on = match &plan.frames {
            None => call.run_picture(&plan.first)?,
            Some(frames) => call.run_frames(plan, frames)?,
        };
        if !goes_on {
            return Ok(call.worst);
        }
    }
    let is_series = plans.iter().any(|plan| plan.frames.is_some());
    if let (Some(path), true) = (&arguments.report, call.worst == DONE || is_series) {
        files::write_whole(path, format!("{:#}\n", whole_report(call.reports)).as_bytes())?;
    }
    Ok(call.worst)
}

/// Options that are short for `--set`.
fn shorts(arguments: &Run) -> Vec<ShortOption> {
    let size = arguments.size.map(|size| ShortOption {
        name: "--size",
        node_type: "camera",
        parameter: "size",
        value: size.into_iter().map(|side| ParameterValue::Integer(side.into())).collect(),
    });
    let output = arguments.output.as_ref().map(|path| ShortOption {
        name: "--output",
        node_type: "image-writer",
        parameter: "path",
        value: ParameterValue::Text(path.to_string_lossy().into_owned()),
    });
    size.into_iter().chain(output).collect()
}

/// Refuses a comparison with an exhaustive run where that would be of several pictures, or of a stream.
fn refuse_exhaustive(arguments: &Run, plans: &[Plan], streams: bool) -> Result<()> {
    let is_series = plans.iter().any(|plan| plan.frames.is_some());
    let (what, expected) = match arguments.exhaustive {
        true if is_series => {
            ("--exhaustive compares runs of one picture, and the file makes several", "one step alone")
        }
        true if streams => (
            "--exhaustive writes every picture several times, and the standard output takes one",
            "the path of a file in place of \"-\"",
        ),
        _ => return Ok(()),
    };
    Err(Error::usage(what).expected(expected))
}

/// One call of the command: what its runs share.
struct Call<'a> {
    arguments: &'a Run,
    registry: &'a Registry,
    bar: Bar,
    session: Session,
    /// True if a file goes to the standard output.
    streams: bool,
    /// The exit code so far.
    worst: u8,
    reports: Vec<Value>,
}

impl Call<'_> {
    /// Runs a pipeline for its one picture; false if it was stopped.
    fn run_picture(&mut self, document: &Document) -> std::result::Result<bool, document::LocatedError> {
        if !self.arguments.quiet {
            warn(document);
        }
        let outcome = match self.arguments.exhaustive {
            true => compared(document, &self.bar),
            false => self.session.run(&document.graph, &self.bar).map(|report| (report, None)),
        };
        self.bar.clear();
        match outcome {
            Ok((report, exhaustive)) => {
                if !self.arguments.quiet {
                    say(&warnings(&report.warnings, document.graph.warnings.len()));
                    let mut text = summary(&report);
                    text.extend(exhaustive.iter().map(ExhaustiveComparison::to_text));
                    tell(&text, self.streams)?;
                }
                let path = document.path.display().to_string();
                let mut report = run_report(&path, &report, &document.graph.stated);
                if let Some(exhaustive) = exhaustive {
                    report["exhaustive"] = exhaustive.as_json();
                    // The key of former versions.
                    report["no_leave_out"] = report["exhaustive"].clone();
                }
                self.reports.push(report);
                Ok(true)
            }
            Err(error) => {
                let is_stopped = error.kind == ErrorKind::Cancelled;
                self.worst = self.worst.max(show(&document.failure(error)));
                Ok(!is_stopped)
            }
        }
    }
}

/// Modes in which a file is run in turn, true for exhaustive ones. The first run finds cold caches and is not counted.
const TURNS: [bool; 5] = [false, true, false, true, false];

/// The file's exhaustive run, compared with the usual one: the fastest of each, every run from a
/// fresh start.
fn compared(
    document: &Document,
    observer: &dyn Observer,
) -> Result<(RunReport, Option<ExhaustiveComparison>)> {
    let mut runs: [Option<RunReport>; 2] = [None, None];
    for (turn, exhaustive) in TURNS.into_iter().enumerate() {
        let session = crate::nodes::session();
        let mut session = if exhaustive { session.exhaustive() } else { session };
        let report = session.run(&document.graph, observer)?;
        let fastest = &mut runs[usize::from(exhaustive)];
        if turn > 0 && fastest.as_ref().is_none_or(|fastest| report.seconds < fastest.seconds) {
            *fastest = Some(report);
        }
    }
    match runs {
        [Some(usual), Some(exhaustive)] => {
            let comparison = ExhaustiveComparison::compare(&usual, &exhaustive);
            Ok((exhaustive, Some(comparison)))
        }
        _ => Err(Error::run("the file was not run")),
    }
}
