//! The document: what a file states.

use crate::Result;
use crate::graph::{Graph, NodeEntry, Registry};
use std::path::PathBuf;

/// The format that this program reads and writes.
pub const FORMAT: i64 = 1;

/// What a pipeline file states.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Pipeline {
    /// Title, for people.
    pub title: Option<String>,
    /// The nodes, in the order of the file.
    pub nodes: Vec<NodeEntry>,
}

impl Pipeline {
    /// Checks the document and builds the graph. `folder`: what paths are relative to.
    pub fn graph(&self, registry: &Registry, folder: PathBuf) -> Result<Graph> {
        Graph::build(&self.nodes, registry, folder)
    }
}
