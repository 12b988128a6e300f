//! Pictures that are there already: drawn by this program from the same pipeline, files and plug-ins.

use crate::document::Document;
use crate::graph::{GraphNode, Session};
use crate::io::encode::{FORMATS, PictureFormat, Source, format_by_ending};
use crate::io::provenance::Provenance;
use std::path::Path;

/// True if every file that a pipeline writes is a picture that carries what it would be drawn from now.
pub(super) fn is_drawn(document: &Document, session: &Session) -> bool {
    let mut writers = writers(document).peekable();
    writers.peek().is_some() && writers.all(|place| is_written(document, place, session))
}

/// The reason for which pictures of a pipeline are drawn again whatever is there; `None` where there is none.
pub(super) fn reason_to_redraw(document: &Document) -> Option<String> {
    let graph = &document.graph;
    writers(document).find_map(|place| reason_of(&graph.nodes[place]))
}

/// Places of the nodes that write files.
fn writers(document: &Document) -> impl Iterator<Item = usize> {
    let graph = &document.graph;
    graph.order.iter().copied().filter(|&place| graph.nodes[place].node.outputs.is_empty())
}

fn reason_of(node: &GraphNode) -> Option<String> {
    let (name, parameters) = (&node.name, &node.parameters);
    if node.node.name != "image-writer" {
        return Some(format!("'{name}' writes no picture that could carry its origin"));
    }
    if !parameters.flag("provenance").unwrap_or(false) {
        return Some(format!("provenance = false at '{name}'"));
    }
    let format = format_of(node)?;
    let all = FORMATS.iter().filter(|format| format.carries_provenance()).map(|format| format.name);
    let all = all.collect::<Vec<_>>().join(", ");
    (!format.carries_provenance()).then(|| format!("{} carries no texts; {all} do", format.name))
}

fn format_of(node: &GraphNode) -> Option<&'static PictureFormat> {
    let word = node.parameters.text("format").ok()?;
    let named = FORMATS.iter().find(|format| format.name == word);
    named.or_else(|| format_by_ending(Path::new(node.parameters.text("path").ok()?)).ok())
}

fn is_written(document: &Document, place: usize, session: &Session) -> bool {
    let graph = &document.graph;
    let node = &graph.nodes[place];
    let parameters = &node.parameters;
    let (Ok(given), Ok(path)) = (parameters.text("path"), parameters.path("path", &graph.folder)) else {
        return false;
    };
    if reason_of(node).is_some() {
        return false;
    }
    let origins = session.origins_before_run(graph, place);
    let wanted = Provenance::for_picture(&origins, (&graph.stated, &graph.folder), given, &path);
    let found = Source::read(&path).ok().and_then(|source| source.embedded);
    found.is_some_and(|found| found.is_of_same_origin(&wanted))
}
