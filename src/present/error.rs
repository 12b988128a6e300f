//! Errors for a person: what, found, the line with a caret, what would be right.

use super::streams;
use crate::core::Error;
use miette::{
    Diagnostic, GraphicalReportHandler, GraphicalTheme, LabeledSpan, NamedSource, Severity, SourceCode,
    ThemeCharacters, ThemeStyles,
};
use std::fmt;
use std::io::IsTerminal;

/// The error as shown. `text`: the pipeline file that its span points into.
pub fn error(error: &Error, text: Option<&str>) -> String {
    shown(error, text, Severity::Error)
}

/// A warning as shown.
pub fn warning(warning: &Error, text: Option<&str>) -> String {
    shown(warning, text, Severity::Warning)
}

fn shown(error: &Error, text: Option<&str>, severity: Severity) -> String {
    let pointed = error.place.span.clone().zip(text);
    let source = pointed.as_ref().map(|(_, text)| {
        let name = error.place.file.clone().unwrap_or_else(|| "pipeline".into());
        NamedSource::new(streams::name(&name), streams::pointed(text))
    });
    let span = pointed.map(|(span, text)| span.start.min(text.len())..span.end.min(text.len()));
    let diagnostic = Shown { error, severity, source, span };
    let terminal = std::io::stderr().is_terminal();
    let plain = std::env::var_os("NO_COLOR").is_some_and(|v| !v.is_empty());
    let mut theme = match (terminal, plain) {
        (true, false) => GraphicalTheme::unicode(),
        (true, true) => GraphicalTheme::unicode_nocolor(),
        (false, _) => GraphicalTheme { characters: ThemeCharacters::ascii(), styles: ThemeStyles::none() },
    };
    theme.characters.error = "error:".into();
    theme.characters.warning = "warning:".into();
    // Where nobody looks at a terminal, lines stay whole, so that they can be searched.
    let mut handler = GraphicalReportHandler::new_themed(theme).with_context_lines(1).with_links(false);
    if !terminal {
        handler = handler.with_width(10_000);
    }
    let mut rendered = String::new();
    match handler.render_report(&mut rendered, &diagnostic) {
        Ok(()) => rendered.trim_end().to_string(),
        // The handler writes to memory; should it fail all the same, the message is what matters.
        Err(_) => error.to_string(),
    }
}

/// An error with the source that it points into.
#[derive(Debug)]
struct Shown<'a> {
    error: &'a Error,
    severity: Severity,
    source: Option<NamedSource<String>>,
    span: Option<std::ops::Range<usize>>,
}

impl fmt::Display for Shown<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Error { what, found, place, .. } = self.error;
        f.write_str(&streams::printable(what))?;
        if let Some(found) = found {
            write!(f, ": found {}", streams::printable(found))?;
        }
        let mut places: Vec<String> = Vec::new();
        if self.source.is_none() {
            places.extend(place.file.as_ref().map(|file| match place.line_column {
                Some((line, column)) => format!("{file}:{line}:{column}"),
                None => file.clone(),
            }));
        }
        places.extend(place.node.as_ref().map(|node| format!("node '{node}'")));
        places.extend(place.item.as_ref().map(|item| format!("'{item}'")));
        if !places.is_empty() {
            write!(f, " ({})", streams::name(&places.join(", ")))?;
        }
        Ok(())
    }
}

impl std::error::Error for Shown<'_> {}

impl Diagnostic for Shown<'_> {
    fn severity(&self) -> Option<Severity> {
        Some(self.severity)
    }

    fn help<'b>(&'b self) -> Option<Box<dyn fmt::Display + 'b>> {
        let accepted = self.error.accepted.as_ref()?;
        Some(Box::new(format!("expected {}", streams::printable(accepted))))
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.source.as_ref().map(|source| source as &dyn SourceCode)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let span = self.span.clone()?;
        Some(Box::new(std::iter::once(LabeledSpan::new_primary_with_span(None, span))))
    }
}
