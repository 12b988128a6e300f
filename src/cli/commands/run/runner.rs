//! Runs of pipelines, each for one picture or for frames, one after the other by one session.

use super::film::{self, DrawnFrame};
use super::plan::{Frames, Plan};
use super::{resume, sheet};
use crate::cli::arguments::Run;
use crate::cli::commands::shared::{DONE, FAILED, show, tell, warn};
use crate::cli::present::{Bar, counted_figures, findings, name, say, summary, warnings};
use crate::cli::ranks::Launch;
use crate::core::error::ErrorKind;
use crate::core::{Error, Result, counted};
use crate::document::{Document, LocatedError};
use crate::graph::{Observer, Registry, RunReport, Session};
use crate::io::provenance::run_report;
use crate::series::Frame;
use serde_json::{Value, json};
use voltet_study::ExhaustiveComparison;

/// Failures that are named at the end.
const MAX_NAMED: usize = 12;

/// One call of the command: state that its runs share.
pub(super) struct Runner<'a> {
    arguments: &'a Run,
    registry: &'a Registry,
    bar: Bar,
    session: Session,
    /// The processes that run together.
    launch: &'a Launch,
    /// True if a file goes to the standard output.
    streams: bool,
    /// The exit code so far.
    pub worst: u8,
    /// Report of each run.
    pub reports: Vec<Value>,
}

impl<'a> Runner<'a> {
    /// A call before its first run.
    pub fn new(arguments: &'a Run, registry: &'a Registry, streams: bool, launch: &'a Launch) -> Self {
        let quiet = arguments.quiet || launch.ranks.rank() > 0;
        let (bar, session) = (Bar::new(quiet), crate::nodes::session().with_ranks(launch.ranks.clone()));
        let session = match arguments.memory {
            Some(bytes) => session.with_memory(bytes),
            None => session,
        };
        Runner { arguments, registry, bar, session, launch, streams, worst: DONE, reports: Vec::new() }
    }

    /// Runs a pipeline for its one picture; false if it was stopped.
    pub fn run_picture(&mut self, document: &Document) -> std::result::Result<bool, LocatedError> {
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
                self.launch.announce_failure();
                self.worst = self.worst.max(show(&document.failure(error)));
                self.launch.end_all(self.worst);
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

/// Findings and warnings of the frames so far, which are not shown again.
#[derive(Default)]
struct ShownMessages {
    findings: String,
    warnings: Vec<String>,
}

/// The error of the last frame that failed, which is not shown in full again.
#[derive(Default)]
struct SaidErrors {
    text: String,
    label: String,
}

impl SaidErrors {
    /// Shows the error of a frame; gives its exit code.
    fn show(&mut self, document: &Document, label: String, error: Error, count: usize) -> u8 {
        let text = error.to_string();
        if text == self.text {
            say(&format!("{label}: fails as {}\n", self.label));
            return FAILED;
        }
        let what = match count {
            1 => error.what.clone(),
            _ => format!("{label}: {}", error.what),
        };
        (self.text, self.label) = (text, label);
        show(&document.failure(Error { what, ..error }))
    }
}

impl Runner<'_> {
    /// Draws the frames; false if it was stopped. A frame that fails is named at the end, and the others are drawn.
    pub fn run_frames(&mut self, plan: &Plan, frames: &Frames) -> std::result::Result<bool, LocatedError> {
        if !self.arguments.quiet {
            warn(&plan.first);
        }
        let count = frames.frames.len();
        let (mut shown, mut failures, mut steps) = (ShownMessages::default(), Vec::new(), Vec::new());
        let mut pictures: Vec<DrawnFrame> = Vec::new();
        let (mut goes_on, mut said) = (true, SaidErrors::default());
        for (number, frame) in frames.frames.iter().enumerate() {
            let changed = frames.document.changed(&frame.changes, self.registry);
            let changed = changed.map_err(|error| frames.document.failure(error))?;
            let place = format!("{}/{count} {}", number + 1, frame.label());
            let drawn = || film::picture_path(&changed).map(|path| DrawnFrame { path, label: frame.label() });
            if self.arguments.frames.resume && resume::is_drawn(&changed, &self.session) {
                self.tell(&format!("{}: there already, as it would be drawn\n", place.trim_end()))?;
                steps.push(entry(frame, &changed, FrameOutcome::Kept));
                pictures.extend(drawn());
                continue;
            }
            let outcome = self.session.run(&changed.graph, &self.bar);
            self.bar.clear();
            match outcome {
                Ok(report) => {
                    self.tell_frame(&mut shown, place.trim_end(), &report, changed.graph.warnings.len())?;
                    steps.push(entry(frame, &changed, FrameOutcome::Drawn(&report)));
                    pictures.extend(drawn());
                }
                Err(error) => {
                    steps.push(entry(frame, &changed, FrameOutcome::Failed(&error)));
                    if error.kind == ErrorKind::Cancelled {
                        self.worst = self.worst.max(show(&changed.failure(error)));
                        goes_on = false;
                        break;
                    }
                    failures.push(frame.label());
                    self.launch.announce_failure();
                    let code = said.show(&changed, frame.label(), error, count);
                    self.worst = self.worst.max(if count == 1 { code } else { FAILED });
                    self.launch.end_all(self.worst);
                }
            }
        }
        if !failures.is_empty() && count > 1 {
            say(&failed(&failures, count));
        }
        if goes_on && self.launch.ranks.rank() == 0 {
            self.join(frames, &pictures, failures.len());
        }
        if frames.is_part_of_sweep && !self.arguments.quiet {
            say(
                "no sheet is made of a part of the pictures; without --part, and with --resume, it is made of all\n",
            );
        }
        let path = frames.document.path.display().to_string();
        let title = &frames.document.graph.stated.title;
        self.reports.push(json!({ "file": path, "title": title, "steps": steps }));
        Ok(goes_on)
    }

    /// Makes the sheet and the film of the pictures; no film where `failed` of the frames are missing.
    fn join(&mut self, frames: &Frames, pictures: &[DrawnFrame], failed: usize) {
        let background = film::background(&frames.document);
        let mut made = Vec::new();
        if let (Some(path), 2..) = (&frames.sheet, pictures.len()) {
            made.push(sheet::write(path, pictures, background));
        }
        let rate = self.arguments.frames.fps;
        match self.arguments.frames.film.as_deref() {
            Some(path) if failed == 0 && !pictures.is_empty() => {
                made.push(film::write(path, pictures, rate, background, &self.bar));
            }
            Some(path) => say(&format!(
                "the film is not made: {failed} of {} failed; when they can be drawn, the same command with --resume --film {} \
                 draws those alone and makes it\n",
                counted(frames.frames.len(), "frame"),
                path.display()
            )),
            None => {}
        }
        for outcome in made {
            match outcome.and_then(|text| self.tell(&text)) {
                Ok(()) => {}
                Err(error) => self.worst = self.worst.max(show(&error.into())),
            }
        }
    }

    fn tell(&self, text: &str) -> Result<()> {
        if self.arguments.quiet { Ok(()) } else { tell(text, self.streams) }
    }

    /// Shows a line about a frame, with findings and warnings that no frame before gave.
    fn tell_frame(
        &self,
        shown: &mut ShownMessages,
        place: &str,
        report: &RunReport,
        of_graph: usize,
    ) -> Result<()> {
        if self.arguments.quiet {
            return Ok(());
        }
        for warning in report.warnings.iter().skip(of_graph) {
            if !shown.warnings.contains(warning) {
                say(&format!("warning: {}\n", name(warning)));
                shown.warnings.push(warning.clone());
            }
        }
        let found = findings(report);
        if found != shown.findings {
            self.tell(&found)?;
            shown.findings = found;
        }
        self.tell(&format!("{place}: {}", counted_figures(report)))
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

/// Outcome of a frame.
enum FrameOutcome<'a> {
    Drawn(&'a RunReport),
    Kept,
    Failed(&'a Error),
}

/// A frame in the report.
fn entry(frame: &Frame, document: &Document, outcome: FrameOutcome) -> Value {
    let marks = &frame.marks;
    let path = document.path.display().to_string();
    let (word, run, error) = match outcome {
        FrameOutcome::Drawn(report) => {
            ("drawn", Some(run_report(&path, report, &document.graph.stated)), None)
        }
        FrameOutcome::Kept => ("kept", None, None),
        FrameOutcome::Failed(error) => ("failed", None, Some(error.to_string())),
    };
    json!({
        "frame": marks.frame,
        "step": marks.step,
        "time": marks.time,
        "stem": marks.stem,
        "values": frame.values,
        "outcome": word,
        "run": run,
        "error": error,
    })
}
