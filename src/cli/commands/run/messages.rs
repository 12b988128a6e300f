//! Messages and the report of a call: what is said of its pictures, in their order.

use super::film::{self, DrawnFrame, Making};
use super::plan::Frames;
use super::report::ReportSpool;
use super::task::{Attempt, Task};
use super::{resume, sheet};
use crate::cli::arguments::Run;
use crate::cli::commands::shared::{FAILED, show, tell, warn};
use crate::cli::present::{Bar, counted_figures, findings, name, say, summary, warnings};
use crate::cli::process::command_line;
use crate::core::error::ErrorKind;
use crate::core::{Error, Result, counted};
use crate::document::Document;
use crate::graph::RunReport;
use crate::io::provenance::run_report;
use crate::series::Frame;
use serde_json::{Value, json};
use voltet_study::ExhaustiveComparison;

/// Failures that are named at the end.
const MAX_NAMED: usize = 12;

/// State of what is said and reported.
pub(super) struct Messages<'a> {
    arguments: &'a Run,
    /// True if a file goes to the standard output.
    streams: bool,
    /// True in the first of several processes, which writes.
    is_first: bool,
    /// True once it is said that pictures are drawn again.
    says_redrawn: bool,
    /// Report of each run, where one is asked for.
    report: Option<ReportSpool>,
    /// The files of pipelines that failed.
    failures: Vec<String>,
    series: SeriesMessages,
    /// The exit code so far.
    worst: u8,
}

/// State of what is said of the frames of one pipeline.
#[derive(Default)]
struct SeriesMessages {
    shown: ShownMessages,
    said: SaidErrors,
    failures: Vec<String>,
    pictures: Vec<DrawnFrame>,
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

impl<'a> Messages<'a> {
    /// Nothing said yet. `streams`: a file goes to the standard output; `worst`: the exit code so far; `failures`: the files that
    /// failed; `is_first`: this is the first of several processes.
    pub fn new(
        arguments: &'a Run,
        streams: bool,
        (worst, failures): (u8, Vec<String>),
        is_first: bool,
    ) -> Result<Self> {
        let report = (arguments.report.is_some() && is_first).then(ReportSpool::new).transpose()?;
        let series = SeriesMessages::default();
        Ok(Messages { arguments, streams, is_first, says_redrawn: false, report, failures, series, worst })
    }

    /// Shows what is known before a picture is drawn.
    pub fn begin(&mut self, task: Task) -> Result<()> {
        let Task { plan, frame } = task;
        if !matches!(frame, None | Some((_, 0))) {
            return Ok(());
        }
        if !self.arguments.quiet {
            warn(&plan.first);
        }
        let Some((frames, _)) = frame else { return Ok(()) };
        self.say_what_is_redrawn(&plan.first);
        self.series = SeriesMessages::default();
        let path = frames.document.path.display().to_string();
        let title = frames.document.graph.stated.title.as_deref();
        self.report.as_mut().map_or(Ok(()), |report| report.begin_series(&path, title))
    }

    /// Shows and reports a picture that was drawn, or was not; false if the run was stopped. After the last of several their film
    /// and their sheet are made.
    pub fn take(&mut self, task: Task, attempt: Attempt, bar: &Bar) -> Result<bool> {
        let Some((frames, number)) = task.frame else { return self.take_picture(&task.plan.first, attempt) };
        let goes_on = self.take_frame(frames, number, attempt)?;
        if !goes_on || number + 1 == frames.frames.len() {
            self.end_series(frames, goes_on, bar)?;
        }
        Ok(goes_on)
    }

    fn take_picture(&mut self, document: &Document, attempt: Attempt) -> Result<bool> {
        let report = match attempt.outcome {
            Ok(Some(report)) => report,
            Ok(None) => return Ok(true),
            Err(error) => {
                let is_stopped = error.kind == ErrorKind::Cancelled;
                self.worst = self.worst.max(show(&document.failure(error)));
                self.failures.push(document.path.display().to_string());
                return Ok(!is_stopped);
            }
        };
        let exhaustive = attempt.exhaustive;
        if !self.arguments.quiet {
            say(&warnings(&report.warnings, document.graph.warnings.len()));
            let mut text = summary(&report);
            text.extend(exhaustive.iter().map(ExhaustiveComparison::to_text));
            tell(&text, self.streams)?;
        }
        let Some(spool) = &mut self.report else { return Ok(true) };
        let mut report = run_report(&document.path.display().to_string(), &report, &document.graph.stated);
        if let Some(exhaustive) = exhaustive {
            report["exhaustive"] = exhaustive.as_json();
            // The key of former versions.
            report["no_leave_out"] = report["exhaustive"].clone();
        }
        spool.add_run(&report)?;
        Ok(true)
    }

    fn take_frame(&mut self, frames: &Frames, number: usize, attempt: Attempt) -> Result<bool> {
        let (count, frame) = (frames.frames.len(), &frames.frames[number]);
        let changed = attempt.document.as_ref().unwrap_or(&frames.document);
        let place = format!("{}/{count} {}", number + 1, frame.label());
        let place = place.trim_end();
        if let Some(report) = &mut self.report {
            report.add_step(&entry(frame, changed, &attempt.outcome))?;
        }
        match attempt.outcome {
            Ok(report) => {
                match &report {
                    None => self.tell(&format!("{place}: there already, as it would be drawn\n"))?,
                    Some(report) => self.tell_frame(place, report, changed.graph.warnings.len())?,
                }
                let drawn = film::picture_path(changed).map(|path| DrawnFrame { path, label: frame.label() });
                self.series.pictures.extend(drawn);
                Ok(true)
            }
            Err(error) if error.kind == ErrorKind::Cancelled => {
                self.worst = self.worst.max(show(&changed.failure(error)));
                Ok(false)
            }
            Err(error) => {
                self.series.failures.push(frame.label());
                let code = self.series.said.show(changed, frame.label(), error, count);
                self.worst = self.worst.max(if count == 1 { code } else { FAILED });
                Ok(true)
            }
        }
    }

    /// Names the frames that failed, makes film and sheet, and ends the series in the report.
    fn end_series(&mut self, frames: &Frames, goes_on: bool, bar: &Bar) -> Result<()> {
        let SeriesMessages { failures, pictures, .. } = std::mem::take(&mut self.series);
        let count = frames.frames.len();
        if !failures.is_empty() {
            self.failures.push(frames.document.path.display().to_string());
        }
        if !failures.is_empty() && count > 1 {
            say(&failed(&failures, &counted(count, "frame")));
        }
        if goes_on && self.is_first {
            self.join(frames, &pictures, failures.len(), bar);
        }
        if frames.is_part_of_sweep && !self.arguments.quiet {
            say(
                "no sheet is made of a part of the pictures; without --part, and with --resume, it is made of all\n",
            );
        }
        self.report.as_mut().map_or(Ok(()), ReportSpool::end_series)
    }

    /// Names the pipelines that failed, and writes the report unless the run was stopped; gives the exit code.
    pub fn finish(self, goes_on: bool) -> Result<u8> {
        let count = self.arguments.files.files.len();
        if !goes_on {
            return Ok(self.worst);
        }
        if count > 1 && !self.failures.is_empty() {
            say(&failed(&self.failures, &counted(count, "pipeline")));
        }
        if let (Some(path), Some(report)) = (&self.arguments.report, self.report)
            && report.run_count > 0
        {
            report.finish(path)?;
        }
        Ok(self.worst)
    }

    /// Makes the sheet and the film of the pictures; no film where `failed` of the frames are missing.
    fn join(&mut self, frames: &Frames, pictures: &[DrawnFrame], failed: usize, bar: &Bar) {
        let background = film::background(&frames.document);
        let given = command_line().iter().skip(1).map(|word| word.to_string_lossy().into_owned());
        let rate = self.arguments.frames.fps;
        let making = Making { rate, background, command: given.collect(), observer: bar };
        let mut made = Vec::new();
        if let (Some(path), 2..) = (&frames.sheet, pictures.len()) {
            made.push(sheet::write(path, pictures, background));
        }
        match self.arguments.frames.film.as_deref() {
            Some(path) if failed == 0 && !pictures.is_empty() => {
                made.push(film::write(path, pictures, &making));
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

    /// Says, once in a call, that pictures are drawn again though --resume is given, and why.
    fn say_what_is_redrawn(&mut self, first: &Document) {
        if !self.arguments.frames.resume || self.arguments.quiet || self.says_redrawn {
            return;
        }
        if let Some(reason) = resume::reason_to_redraw(first) {
            say(&format!(
                "--resume draws every picture again, for none can be told to be up to date: {reason}\n"
            ));
            self.says_redrawn = true;
        }
    }

    fn tell(&self, text: &str) -> Result<()> {
        if self.arguments.quiet { Ok(()) } else { tell(text, self.streams) }
    }

    /// Shows a line about a frame, with findings and warnings that no frame before gave.
    fn tell_frame(&mut self, place: &str, report: &RunReport, of_graph: usize) -> Result<()> {
        if self.arguments.quiet {
            return Ok(());
        }
        for warning in report.warnings.iter().skip(of_graph) {
            if !self.series.shown.warnings.contains(warning) {
                say(&format!("warning: {}\n", name(warning)));
                self.series.shown.warnings.push(warning.clone());
            }
        }
        let found = findings(report);
        if found != self.series.shown.findings {
            self.tell(&found)?;
            self.series.shown.findings = found;
        }
        self.tell(&format!("{place}: {}", counted_figures(report)))
    }
}

/// A line that names what failed. `of`: all of them, "4 frames".
fn failed(labels: &[String], of: &str) -> String {
    let shown = labels[..labels.len().min(MAX_NAMED)].join("; ");
    let more = match labels.len().saturating_sub(MAX_NAMED) {
        0 => String::new(),
        more => format!("; and {more} more"),
    };
    format!("{} of {of} failed: {shown}{more}\n", labels.len())
}

fn entry(frame: &Frame, document: &Document, outcome: &Result<Option<RunReport>>) -> Value {
    let marks = &frame.marks;
    let path = document.path.display().to_string();
    let (word, run, error) = match outcome {
        Ok(Some(report)) => ("drawn", Some(run_report(&path, report, &document.graph.stated)), None),
        Ok(None) => ("kept", None, None),
        Err(error) => ("failed", None, Some(error.to_string())),
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
