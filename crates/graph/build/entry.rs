//! Nodes and wires as a pipeline file or a program states them, unchecked.

use voltet_core::Result;
use voltet_core::parameters::{Field, LocatedValue, SourceSpan};

/// A node as a pipeline file or a program states it, not checked yet.
#[derive(Debug, Clone, PartialEq)]
pub struct NodeEntry {
    /// Its name.
    pub name: String,
    /// Its source span.
    pub origin: SourceSpan,
    /// The name of its type.
    pub node_type: LocatedValue,
    /// Its parameters.
    pub settings: Vec<Field>,
    /// Its wires.
    pub inputs: Vec<LinkEntry>,
}

impl NodeEntry {
    /// A parameter as stated.
    pub fn setting(&self, name: &str) -> Option<&LocatedValue> {
        voltet_core::parameters::find_setting(&self.settings, name)
    }

    /// Sets a parameter, or the part of it that `path` leads to.
    pub fn set(&mut self, name: &str, path: &[&str], setting: LocatedValue) -> Result<()> {
        voltet_core::parameters::replace_field(&mut self.settings, name, path, setting)
    }
}

/// A wire as stated: an input port and the node (or `"node.port"`) that feeds it.
#[derive(Debug, Clone, PartialEq)]
pub struct LinkEntry {
    /// The input port.
    pub port: String,
    /// Source span of the port.
    pub origin: SourceSpan,
    /// The output that feeds it.
    pub source: LocatedValue,
}
