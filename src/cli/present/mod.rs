//! Output for people: errors with their location, summaries of runs, progress bars, the reference of nodes; all safe to show on a
//! terminal.

mod progress;

pub use progress::{Bar, Estimate};

use crate::core::{Error, Result};
use crate::graph::{DataFinding, RunReport};
use crate::nodes::files;
use annotate_snippets::renderer::DecorStyle;
use annotate_snippets::{AnnotationKind, Group, Level, Renderer, Snippet};
use std::io::{IsTerminal, Write};

/// The error as shown. `text`: the pipeline file that its span points into.
pub fn error(error: &Error, text: Option<&str>) -> String {
    shown(error, text, Level::ERROR)
}

/// A warning as shown.
pub fn warning(warning: &Error, text: Option<&str>) -> String {
    shown(warning, text, Level::WARNING)
}

fn shown(error: &Error, text: Option<&str>, level: Level) -> String {
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
    let plain = std::env::var_os("NO_COLOR").is_some_and(|v| !v.is_empty());
    let renderer = if terminal && !plain { Renderer::styled() } else { Renderer::plain() };
    let decor = if terminal { DecorStyle::Unicode } else { DecorStyle::Ascii };
    // Lines stay whole, so that they can be searched; a terminal breaks them.
    renderer.decor_style(decor).term_width(10_000).render(&[report])
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
pub fn warnings(report: &RunReport, shown: usize) -> String {
    report.warnings.iter().skip(shown).map(|warning| format!("warning: {}\n", name(warning))).collect()
}

/// Findings, and a line for the written files.
pub fn summary(report: &RunReport) -> String {
    let text = findings(report);
    let mut figures = Vec::new();
    let count = |name: &str| report.counts.get(name).copied();
    if let Some(total) = count("cells_total") {
        let culled = count("cells_culled").filter(|&n| n > 0);
        let culled = culled.map(|n| format!(" ({} culled)", number(n))).unwrap_or_default();
        figures.push(format!("{} cells{culled}", number(total)));
    }
    figures.extend(count("segments").map(|n| format!("{} segments", number(n))));
    figures.extend(report.engine.as_ref().map(|(engine, _)| format!("engine {engine}")));
    figures.push(format!("{:.2} s", report.seconds));
    text + &format!("{}: {}\n", report.files.join(", "), figures.join(", "))
}

/// Findings of the nodes about the data, each under the node's name.
pub fn findings(report: &RunReport) -> String {
    let line = |found: &DataFinding| format!("{}: {}\n", found.node, found.what.replace('\n', "\n  "));
    report.findings.iter().map(line).collect()
}

/// A whole number with commas.
pub fn number(n: u64) -> String {
    let digits = n.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// Writes text to the standard output; false if it was closed, which is no error.
pub fn print(text: &str) -> Result<bool> {
    files::standard_output(printable(text).as_bytes())
}

/// Writes lines to standard error. A failure is ignored.
pub fn say(lines: &str) {
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
}
