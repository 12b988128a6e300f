//! Messages for errors: what is wrong, what was found, the line with a caret, what would be right.

use super::streams;
use crate::core::Error;
use annotate_snippets::renderer::DecorStyle;
use annotate_snippets::{AnnotationKind, Group, Level, Renderer, Snippet};
use std::io::IsTerminal;

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
    let name = streams::name(error.location.file.as_deref().unwrap_or("pipeline"));
    let mut report = Group::with_title(level.primary_title(title));
    if let Some((span, text)) = pointed {
        let span = span.start.min(text.len())..span.end.min(text.len());
        let source = Snippet::source(streams::pointed(text)).path(name);
        report = report.element(source.annotation(AnnotationKind::Primary.span(span)));
    }
    if let Some(accepted) = &error.expected {
        report = report.element(Level::HELP.message(format!("expected {}", streams::printable(accepted))));
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
    let mut title = streams::printable(what);
    if let Some(found) = found {
        title += &format!(": found {}", streams::printable(found));
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
        title += &format!(" ({})", streams::name(&places.join(", ")));
    }
    title
}
