//! The document: what a file states.

use crate::{Graph, NodeEntry, Registry, ResolvedPipeline};
use std::path::PathBuf;
use voltet_core::Result;

/// The format that this program reads and writes.
pub const FORMAT: i64 = 1;

/// A pipeline file as written, unchecked.
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
        let mut graph = Graph::build(&self.nodes, registry, folder)?;
        graph.stated = Self::stated(self.to_string(), registry)?;
        Ok(graph)
    }

    /// A text that states a pipeline, with the places of its paths. Errors: it states none.
    pub fn stated(text: String, registry: &Registry) -> Result<ResolvedPipeline> {
        let pipeline = Self::parse(&text)?;
        let graph = Graph::build(&pipeline.nodes, registry, PathBuf::new())?;
        let named = graph.nodes.iter().flat_map(|node| node.parameters.paths());
        Ok(ResolvedPipeline::new(pipeline.title, text, named))
    }
}
