//! A pipeline file as a document: what it states, and its text, which read back is equal, node by node.

use crate::{Field, Graph, NodeEntry, ParameterValue, Registry, ResolvedPipeline};
use std::fmt;
use std::path::PathBuf;
use voltet_core::Result;
use voltet_core::parameters::key_text;

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

impl fmt::Display for Pipeline {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "[pipeline]\nformat = {FORMAT}")?;
        if let Some(title) = &self.title {
            writeln!(f, "title = {}", ParameterValue::Text(title.clone()))?;
        }
        self.nodes.iter().try_for_each(|node| write_node(f, node))
    }
}

fn write_node(f: &mut fmt::Formatter<'_>, node: &NodeEntry) -> fmt::Result {
    let name = key_text(&node.name);
    writeln!(f, "\n[nodes.{name}]\ntype = {}", node.node_type.datum)?;
    // Lists of tables follow as tables of their own, after the plain keys, as TOML asks.
    let (tables, plain): (Vec<&Field>, Vec<&Field>) =
        node.settings.iter().partition(|s| is_tables(&s.setting.datum));
    for field in plain {
        writeln!(f, "{} = {}", key_text(&field.name), field.setting.datum)?;
    }
    if !node.inputs.is_empty() {
        let links: Vec<String> = node
            .inputs
            .iter()
            .map(|link| format!("{} = {}", key_text(&link.port), link.source.datum))
            .collect();
        writeln!(f, "inputs = {{ {} }}", links.join(", "))?;
    }
    for field in tables {
        for entry in field.setting.list().unwrap_or_default() {
            writeln!(f, "\n[[nodes.{name}.{}]]", key_text(&field.name))?;
            for key in entry.table().unwrap_or_default() {
                writeln!(f, "{} = {}", key_text(&key.name), key.setting.datum)?;
            }
        }
    }
    Ok(())
}

/// True if a value is a list of tables.
fn is_tables(datum: &ParameterValue) -> bool {
    match datum {
        ParameterValue::List(list) => !list.is_empty() && list.iter().all(|part| part.table().is_some()),
        _ => false,
    }
}
