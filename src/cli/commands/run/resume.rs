//! Pictures that are there already: drawn by this program from the same pipeline, step and data.

use crate::document::Document;
use crate::graph::{GraphNode, Session};
use crate::io::encode::Source;
use crate::io::provenance::Provenance;
use crate::nodes::relative::{DataScope, RELATIVE_TO};
use std::path::Path;
use std::time::SystemTime;

/// True if every file that a pipeline writes is a picture that carries what it would be drawn from now.
pub(super) fn is_drawn(document: &Document, session: &Session) -> bool {
    let graph = &document.graph;
    let mut writers =
        graph.order.iter().filter(|&&place| graph.nodes[place].node.outputs.is_empty()).peekable();
    writers.peek().is_some() && writers.all(|&place| is_written(document, place, session))
}

fn is_written(document: &Document, place: usize, session: &Session) -> bool {
    let graph = &document.graph;
    let node = &graph.nodes[place];
    let parameters = &node.parameters;
    let (Ok(given), Ok(path)) = (parameters.text("path"), parameters.path("path", &graph.folder)) else {
        return false;
    };
    let carries = parameters.flag("provenance").unwrap_or(false);
    if node.node.name != "image-writer" || !carries {
        return false;
    }
    let origins = session.origins_before_run(graph, place);
    let wanted = Provenance::for_picture(&origins, (&graph.stated, &graph.folder), given, &path);
    let found = Source::read(&path).ok().and_then(|source| source.embedded);
    found.is_some_and(|found| found.is_of_same_origin(&wanted)) && is_newer_than_series(document, &path)
}

/// True if a picture whose numbers are relative to a series is newer than all its files.
fn is_newer_than_series(document: &Document, picture: &Path) -> bool {
    let of_series = |node: &GraphNode| {
        node.parameters
            .optional(RELATIVE_TO.name)
            .and_then(|word| word.text())
            .is_some_and(|word| DataScope::from_word(word) != DataScope::Step)
    };
    if !document.graph.nodes.iter().any(of_series) {
        return true;
    }
    let modified = |path: &Path| std::fs::metadata(path).and_then(|metadata| metadata.modified()).ok();
    let Some(drawn) = modified(picture) else { return false };
    let is_older = |time: Option<SystemTime>| time.is_none_or(|time| time <= drawn);
    document.data_files().all(|path| is_older(modified(&path)))
}
