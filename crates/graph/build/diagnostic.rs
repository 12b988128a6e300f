//! Diagnostics of the nodes of a pipeline file, each with its source span.

use super::entry::NodeEntry;
use voltet_core::Error;

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
