//! Output for people: errors with their location, summaries of runs, progress bars, all safe to show on a terminal; and stopping at a
//! signal.

use crate::cli::process::end_now;
use crate::core::{Error, Result, noun_of, with_commas};
use crate::graph::{DataFinding, Observer, RunReport};
use crate::io::memory;
use crate::nodes::files;
pub use annotate_snippets::Level;
use annotate_snippets::renderer::DecorStyle;
use annotate_snippets::{AnnotationKind, Group, Renderer, Snippet};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::{IsTerminal, Write};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, OnceLock, PoisonError};
use std::time::{Duration, Instant};
use voltet_plugins::EndRequest;

/// An error or a warning as shown, by its level. `text`: the pipeline file that its span points into.
pub fn shown(error: &Error, text: Option<&str>, level: Level) -> String {
    let pointed = error.location.span.clone().zip(text);
    let title = title(error, pointed.is_some());
    let name = name(error.location.file.as_deref().unwrap_or("pipeline"));
    let mut report = Group::with_title(level.primary_title(title));
    if let Some((span, text)) = pointed {
        let span = span.start.min(text.len())..span.end.min(text.len());
        let source = Snippet::source(without_controls(text)).path(name);
        report = report.element(source.annotation(AnnotationKind::Primary.span(span)));
    }
    if let Some(accepted) = &error.expected {
        report = report.element(Level::HELP.message(format!("expected {}", printable(accepted))));
    }
    let terminal = std::io::stderr().is_terminal();
    let renderer = if terminal && !is_plain() { Renderer::styled() } else { Renderer::plain() };
    let decor = if terminal { DecorStyle::Unicode } else { DecorStyle::Ascii };
    // Lines stay whole, so that they can be searched; a terminal breaks them.
    renderer.decor_style(decor).term_width(10_000).render(&[report])
}

/// True if the environment asks for messages without colours, when this is first called.
pub fn is_plain() -> bool {
    static PLAIN: OnceLock<bool> = OnceLock::new();
    *PLAIN.get_or_init(|| std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty()))
}

/// Title of the message: what is wrong, what was found, and where unless a caret shows it.
fn title(error: &Error, is_pointed: bool) -> String {
    let Error { what, got: found, location: place, .. } = error;
    let mut title = printable(what);
    if let Some(found) = found {
        title += &format!(": found {}", printable(found));
    }
    let mut places: Vec<String> = Vec::new();
    if !is_pointed {
        places.extend(place.file.as_ref().map(|file| match place.line_column {
            Some((line, column)) => format!("{file}:{line}:{column}"),
            None => file.clone(),
        }));
    }
    places.extend(place.node.as_ref().map(|node| format!("node '{node}'")));
    places.extend(place.item.as_ref().map(|item| format!("'{item}'")));
    if !places.is_empty() {
        title += &format!(" ({})", name(&places.join(", ")));
    }
    title
}

/// Warnings, a line each, but for the first `shown` of them: those of the graph are shown with their location before the run.
pub fn warnings(all: &[String], shown: usize) -> String {
    all.iter().skip(shown).map(|warning| format!("warning: {}\n", name(warning))).collect()
}

/// Findings, and a line for the written files.
pub fn summary(report: &RunReport) -> String {
    findings(report) + &counted_figures(report)
}

/// A line for the written files: counts, engine and time.
pub fn counted_figures(report: &RunReport) -> String {
    let mut figures = Vec::new();
    let count = |name: &str| report.counts.get(name).copied();
    if let Some(total) = count("cells_total") {
        let culled = count("cells_culled").filter(|&n| n > 0);
        let culled = culled.map(|n| format!(" ({} culled)", with_commas(n))).unwrap_or_default();
        figures.push(format!("{}{culled}", grouped(total, "cell")));
    }
    figures.extend(count("segments").map(|n| grouped(n, "segment")));
    figures.extend(report.engine.as_ref().map(|(engine, _)| format!("engine {engine}")));
    figures.push(format!("{:.2} s", report.seconds));
    format!("{}: {}\n", report.files.join(", "), figures.join(", "))
}

/// Findings of the nodes about the data, each under the node's name.
pub fn findings(report: &RunReport) -> String {
    let line = |found: &DataFinding| format!("{}: {}\n", found.node, found.what.replace('\n', "\n  "));
    report.findings.iter().map(line).collect()
}

/// A count with commas and its noun, which is given in the singular.
pub fn grouped(count: u64, noun: &str) -> String {
    format!("{} {}", with_commas(count), noun_of(&count, noun))
}

/// True where nothing is shown: in one of several processes of which another speaks.
static HELD_BACK: AtomicBool = AtomicBool::new(false);

/// Shows nothing from here on, or shows again.
pub fn hold_back(held_back: bool) {
    HELD_BACK.store(held_back, Ordering::Relaxed);
}

/// Writes text to the standard output; false if it was closed, which is no error.
pub fn print(text: &str) -> Result<bool> {
    if HELD_BACK.load(Ordering::Relaxed) {
        return Ok(true);
    }
    files::standard_output(printable(text).as_bytes())
}

/// Writes lines to standard error. A failure is ignored.
pub fn say(lines: &str) {
    if HELD_BACK.load(Ordering::Relaxed) {
        return;
    }
    let ended = lines.is_empty() || lines.ends_with('\n');
    let _ = write!(std::io::stderr().lock(), "{lines}{}", if ended { "" } else { "\n" });
}

/// A name on one line: control characters, and those that turn the direction of writing, as Rust writes them.
pub fn name(text: &str) -> String {
    escaped(text, |_| false)
}

/// Text of several lines, otherwise like [`name`].
pub fn printable(text: &str) -> String {
    escaped(text, |c| c == '\n')
}

fn escaped(text: &str, is_kept: impl Fn(char) -> bool) -> String {
    let mut shown = String::with_capacity(text.len());
    for c in text.chars() {
        match is_unsafe(c) && !is_kept(c) {
            true => shown.extend(c.escape_default()),
            false => shown.push(c),
        }
    }
    shown
}

/// The text of a file for a message that points into it: what a terminal would act on becomes dots of as many bytes.
pub fn without_controls(text: &str) -> String {
    let dot = |c: char| match c.len_utf8() {
        1 => ".",
        2 => "·",
        _ => "‥",
    };
    let safe = |c: char| !is_unsafe(c) || matches!(c, '\n' | '\r' | '\t');
    let mut shown = String::with_capacity(text.len());
    for c in text.chars() {
        if safe(c) { shown.push(c) } else { shown.push_str(dot(c)) }
    }
    shown
}

/// Control characters (a terminal acts on them), marks of direction and line separators (they hide what is written).
fn is_unsafe(c: char) -> bool {
    c.is_control() || matches!(c, '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// Time before a bar is shown.
const BAR_DELAY: Duration = Duration::from_secs(1);

/// True after Ctrl-C, or after the system's request to end.
static STOP: AtomicBool = AtomicBool::new(false);

/// Estimate of the remaining time of a piece of work, from the time of the completed part.
#[derive(Debug, Clone, Copy)]
pub struct Estimate {
    start: Instant,
    fraction: f64,
}

impl Estimate {
    /// An estimate for work that begins now.
    pub fn begin() -> Self {
        Estimate { start: Instant::now(), fraction: 0.0 }
    }

    /// Remaining time (seconds) once `fraction` is done; `None` while too little is done. A fraction that falls starts another piece
    /// of work.
    pub fn remaining(&mut self, fraction: f64) -> Option<f64> {
        // Threads report in no order, so a little less is no beginning.
        if fraction + 0.1 < self.fraction {
            *self = Estimate::begin();
        }
        self.fraction = self.fraction.max(fraction);
        let left = self.start.elapsed().as_secs_f64() * (1.0 - fraction) / fraction;
        (fraction > 0.02 && left.is_finite()).then_some(left)
    }
}

/// Progress bar of a run.
pub struct Bar {
    bar: ProgressBar,
    visible: bool,
    start: Instant,
    shown: AtomicBool,
    place: Mutex<String>,
    /// Estimate of the current stage.
    estimate: Mutex<Estimate>,
}

impl Bar {
    /// A bar, shown only on a terminal and where not `quiet`.
    pub fn new(quiet: bool) -> Self {
        // The first Ctrl-C or request to end stops the run cleanly; the second one, should that take long, the program, and
        // so does the first where the run waits for a reader.
        let mut direct_count = 0;
        let _ = ctrlc::set_handler(move || {
            let request = voltet_plugins::take_end_request();
            direct_count += u32::from(request == EndRequest::Direct);
            STOP.store(true, Ordering::Relaxed);
            if direct_count > 1 || request == EndRequest::ForwardedAgain || files::is_waiting() {
                end_now();
            }
        });
        let bar = ProgressBar::with_draw_target(Some(1000), ProgressDrawTarget::hidden());
        if let Ok(style) = ProgressStyle::with_template("{msg:40} {bar:30} {percent:>3} %  {elapsed}") {
            bar.set_style(style);
        }
        let visible = !quiet && std::io::stderr().is_terminal();
        let (start, shown) = (Instant::now(), AtomicBool::new(false));
        let estimate = Mutex::new(Estimate::begin());
        Bar { bar, visible, start, shown, place: Mutex::default(), estimate }
    }

    /// Removes the bar from the screen.
    pub fn clear(&self) {
        self.bar.finish_and_clear();
    }
}

impl Observer for Bar {
    fn started(&self, node: &str, place: usize, count: usize) {
        let mut shown = self.place.lock().unwrap_or_else(PoisonError::into_inner);
        *shown = format!("{}/{count} {node}", place + 1);
    }

    fn progress(&self, node: &str, stage: &str, fraction: f64) {
        if !self.visible {
            return;
        }
        let left = self.estimate.lock().unwrap_or_else(PoisonError::into_inner).remaining(fraction);
        if self.start.elapsed() < BAR_DELAY {
            return;
        }
        if !self.shown.swap(true, Ordering::Relaxed) {
            self.bar.set_draw_target(ProgressDrawTarget::stderr());
        }
        let place = self.place.lock().unwrap_or_else(PoisonError::into_inner).clone();
        let what = if node.is_empty() { stage.to_string() } else { format!("{place}: {stage}") };
        // Less than a second says nothing to a person.
        let left = left.filter(|left| *left >= 1.0).map(|left| format!(", about {left:.0} s left"));
        self.bar.set_message(format!("{what}{}", left.unwrap_or_default()));
        self.bar.set_position((fraction.clamp(0.0, 1.0) * 1000.0) as u64);
    }

    fn cancelled(&self) -> bool {
        STOP.load(Ordering::Relaxed)
    }

    fn memory_left(&self) -> Option<u64> {
        memory::available()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_terminal_would_act_on_is_shown_instead() {
        let text = "a\u{1b}[31m\u{9b}1m\u{7f}\r\tb\u{202e}ü\n";
        assert_eq!(name(text), "a\\u{1b}[31m\\u{9b}1m\\u{7f}\\r\\tb\\u{202e}ü\\n");
        assert_eq!(printable("a\u{7}\nb"), "a\\u{7}\nb");
        assert_eq!(without_controls(text).len(), text.len(), "places in the text stay");
        assert_eq!(without_controls(text), "a.[31m·1m.\r\tb‥ü\n");
    }

    #[test]
    fn what_is_left_follows_from_what_is_done_and_begins_anew() {
        let ago = |seconds: u64| Instant::now().checked_sub(Duration::from_secs(seconds)).unwrap();
        let mut estimate = Estimate { start: ago(30), fraction: 0.0 };
        assert_eq!(estimate.remaining(0.01), None, "too little to tell");
        // The test itself takes some of the time, on a busy machine seconds.
        let least = 3.0 * estimate.start.elapsed().as_secs_f64();
        let left = estimate.remaining(0.25).unwrap();
        assert!((least..=3.0 * estimate.start.elapsed().as_secs_f64()).contains(&left), "{left}");
        assert!(least >= 90.0, "{least}");
        assert!(estimate.remaining(1.0).unwrap() < 1.0);
        assert!(estimate.remaining(0.5).unwrap() < 25.0, "another piece of work began just now");
    }
}
