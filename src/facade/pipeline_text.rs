//! The nodes of a pipeline, and the texts that state them.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use voltet_core::{Error, Result};
use voltet_graph::pipeline::{Pipeline as Nodes, locate};
use voltet_graph::{NodeEntry, unknown_node};

/// Nodes of a pipeline, which may be changed, with the texts that errors point at.
#[derive(Clone, Default)]
pub struct PipelineText {
    pub(super) nodes: Nodes,
    pub(super) folder: PathBuf,
    pub(super) text: String,
    /// Name of the text in errors.
    pub(super) path: PathBuf,
    /// True once the nodes are others than the text states.
    pub(super) is_changed: bool,
    /// Texts of the nodes whose parameters were set by one.
    pub(super) node_texts: BTreeMap<String, String>,
}

impl PipelineText {
    /// Nodes that a text states. `path`: its file, or a name for reports; `folder`: that which paths are relative to.
    pub fn new(nodes: Nodes, text: String, path: PathBuf, folder: PathBuf) -> Self {
        PipelineText { nodes, folder, text, path, ..Self::default() }
    }

    pub(super) fn node(&mut self, name: &str) -> Result<&mut NodeEntry> {
        let names: Vec<String> = self.nodes.nodes.iter().map(|node| node.name.clone()).collect();
        self.is_changed = true;
        let unknown = || unknown_node(name, names.iter().map(String::as_str));
        self.nodes.nodes.iter_mut().find(|node| node.name == name).ok_or_else(unknown)
    }

    /// A text that states the nodes, for reports.
    pub(super) fn text(&self) -> String {
        if self.is_changed { self.nodes.to_string() } else { self.text.clone() }
    }

    /// Completes an error with file, line and column.
    pub fn locate(&self, error: Error) -> Error {
        let of_node = error.location.node.as_ref().and_then(|name| self.node_texts.get_key_value(name));
        match of_node {
            Some((name, text)) if error.location.span.is_some() => locate(error, text, Path::new(name)),
            _ => locate(error, &self.text, &self.path),
        }
    }
}
