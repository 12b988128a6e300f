//! Nodes and wires as a pipeline file or a program states them, unchecked, and their mistakes.

use crate::api::node::Node;
use std::collections::BTreeMap;
use voltet_core::parameters::{Field, LocatedValue, ParameterValue, SourceSpan};
use voltet_core::{Error, Result};

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
    /// A node of a program's own, which has the name of its type. `fed`: its inputs, each with an output (`"node"` or `"node.port"`)
    /// that feeds it; several may feed one.
    pub fn of_program<'a>(
        node: &Node,
        settings: Vec<Field>,
        fed: impl IntoIterator<Item = (&'a str, String)>,
    ) -> NodeEntry {
        let mut sources: BTreeMap<&str, Vec<LocatedValue>> = BTreeMap::new();
        fed.into_iter().for_each(|(port, source)| sources.entry(port).or_default().push(source.into()));
        let inputs = sources.into_iter().map(|(port, sources)| LinkEntry {
            port: port.into(),
            origin: SourceSpan::Nowhere,
            source: ParameterValue::List(sources).into(),
        });
        let (name, origin, node_type) = (node.name.into(), SourceSpan::Nowhere, node.name.into());
        NodeEntry { name, origin, node_type, settings, inputs: inputs.collect() }
    }

    /// A parameter as stated.
    pub fn setting(&self, name: &str) -> Option<&LocatedValue> {
        voltet_core::parameters::find_setting(&self.settings, name)
    }

    /// Sets a parameter, or the part of it that `path` leads to.
    pub fn set(&mut self, name: &str, path: &[&str], setting: LocatedValue) -> Result<()> {
        voltet_core::parameters::replace_field(&mut self.settings, name, path, setting)
    }
}

/// The error for a name that none of the nodes has.
pub fn unknown_node<'a>(name: &str, names: impl IntoIterator<Item = &'a str>) -> Error {
    Error::usage(format!("there is no node '{name}'")).not_among(name, names)
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

/// A mistake of a node.
#[derive(Debug, Clone)]
pub struct Diagnostic {
    /// The node.
    pub node: String,
    /// The part of it that is wrong.
    pub part: DiagnosticTarget,
    /// The error, with its source span.
    pub error: Error,
}

/// Part of a node that is wrong.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum DiagnosticTarget {
    /// Its name, its type, or the combination of its parameters.
    Node,
    /// A parameter, or a key that is none.
    Parameter(String),
    /// An input, or a key that is none.
    Input(String),
}

impl Diagnostic {
    /// Makes a diagnostic at the error's own source span, else at the node's.
    pub(super) fn new(entry: &NodeEntry, part: DiagnosticTarget, error: Error) -> Diagnostic {
        let error = entry.origin.locate(error.at_node(&entry.name));
        Diagnostic { node: entry.name.clone(), part, error }
    }
}
