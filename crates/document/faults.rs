//! Mistakes of a document, each at the node, the parameter or the input concerned.

use crate::Document;
use crate::path::{Path, Step};
use voltet_core::Error;
use voltet_graph::{DiagnosticTarget as Stated, Graph, NodeEntry, Registry};

/// A mistake in a document.
#[derive(Debug, Clone)]
pub struct Diagnostic {
    /// The node; none where it is about the file as a whole.
    pub node: Option<String>,
    /// Part of the node concerned.
    pub target: FaultTarget,
    /// Error, with line and column.
    pub error: Error,
}

/// Part of a node that a mistake concerns.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum FaultTarget {
    /// The file, or a node as a whole: its name, its type, how its parameters go together.
    Whole,
    /// A parameter, or a part of one: `widgets.0.centre`.
    Parameter(Path),
    /// An input.
    Input(String),
}

impl Document {
    /// Every mistake that can be found without data: of the text, of types, parameters and wires.
    pub fn faults(&self, registry: &Registry) -> Vec<Diagnostic> {
        self.faults_among(&self.survey.pipeline.nodes, registry)
    }

    /// Mistakes of these nodes by themselves, with their wires cut, and of the text.
    pub fn faults_of(&self, names: &[&str], registry: &Registry) -> Vec<Diagnostic> {
        let nodes = self.survey.pipeline.nodes.iter().filter(|node| names.contains(&node.name.as_str()));
        self.faults_among(&nodes.cloned().collect::<Vec<_>>(), registry)
    }

    fn faults_among(&self, nodes: &[NodeEntry], registry: &Registry) -> Vec<Diagnostic> {
        let mut faults: Vec<Diagnostic> = Vec::new();
        for (i, error) in self.survey.faults.iter().enumerate() {
            if self.survey.faults[..i].iter().any(|known| is_same(known, error)) {
                continue;
            }
            let (place, part) = self.target(error);
            let node = error.location.node.clone().or(place);
            faults.push(Diagnostic { node, target: part, error: self.locate(error.clone()) });
        }
        for fault in Graph::faults(nodes, registry, self.folder()) {
            // What cannot be read at all is said once.
            if self.survey.faults.iter().any(|known| is_same(known, &fault.error)) {
                continue;
            }
            let (_, placed) = self.target(&fault.error);
            let part = match (fault.part, placed) {
                (Stated::Input(port), _) => FaultTarget::Input(port),
                (Stated::Parameter(name), FaultTarget::Parameter(path))
                    if path.0.first().is_some_and(|s| s.key() == name) =>
                {
                    FaultTarget::Parameter(path)
                }
                (Stated::Parameter(name), _) => FaultTarget::Parameter(Path(vec![Step::Key(name)])),
                (Stated::Node, placed) => placed,
            };
            faults.push(Diagnostic { node: Some(fault.node), target: part, error: self.locate(fault.error) });
        }
        faults
    }

    fn target(&self, error: &Error) -> (Option<String>, FaultTarget) {
        let Some(span) = &error.location.span else { return (None, FaultTarget::Whole) };
        let path = self.syntax.path_at(span.start);
        let keys: Vec<String> = path.0.iter().take(4).map(|step| step.key().into_owned()).collect();
        let keys: Vec<&str> = keys.iter().map(String::as_str).collect();
        match keys[..] {
            ["nodes", node] | ["nodes", node, "type", ..] | ["nodes", node, "inputs"] => {
                (Some(node.to_string()), FaultTarget::Whole)
            }
            ["nodes", node, "inputs", port] => (Some(node.to_string()), FaultTarget::Input(port.to_string())),
            ["nodes", node, ..] => {
                (Some(node.to_string()), FaultTarget::Parameter(Path(path.0[2..].to_vec())))
            }
            _ => (None, FaultTarget::Whole),
        }
    }
}

/// True if two mistakes are of the very same bytes.
fn is_same(one: &Error, other: &Error) -> bool {
    one.location.span.is_some() && one.location.span == other.location.span
}
