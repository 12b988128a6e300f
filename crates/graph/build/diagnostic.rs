//! What is wrong with the nodes that a file states, each mistake at its place.

use super::entry::NodeEntry;
use voltet_core::Error;

/// A mistake of a node.
#[derive(Debug, Clone)]
pub struct Diagnostic {
    /// The node.
    pub node: String,
    /// What of it is wrong.
    pub part: DiagnosticTarget,
    /// What is wrong, with its place in the file.
    pub error: Error,
}

/// What of a node is wrong.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum DiagnosticTarget {
    /// Its name, its type, or how its parameters go together.
    Node,
    /// A parameter, or a key that is none.
    Parameter(String),
    /// An input, or a key that is none.
    Input(String),
}

impl Diagnostic {
    /// At the place that the error has already, else at that of the node.
    pub(super) fn of(entry: &NodeEntry, part: DiagnosticTarget, error: Error) -> Diagnostic {
        let error = entry.origin.locate(error.at_node(&entry.name));
        Diagnostic { node: entry.name.clone(), part, error }
    }
}
