//! Wires of one node: the edges that feed its input ports.

use super::port::Port;
use voltet_core::field::Method;
use voltet_core::parameters::SourceSpan;
use voltet_core::{Error, Result};

/// A wire into an input port.
#[derive(Debug, Clone)]
pub struct Edge {
    /// The input port, by its index in `Node::all_inputs`.
    pub port: usize,
    /// Its name.
    pub name: &'static str,
    /// The node, by its index in `Graph::nodes`.
    pub node: usize,
    /// The output of that node.
    pub output: usize,
    /// Source span of the wire.
    pub origin: SourceSpan,
}

/// Wires and gradient filter of one node, as its functions see them.
#[derive(Clone, Copy)]
pub(crate) struct Wiring<'a> {
    /// Name of the node.
    pub node: &'a str,
    /// Name of its type.
    pub node_type: &'static str,
    /// Required input ports, then optional ones.
    pub ports: [&'static [Port]; 2],
    /// Edges of the node, in the order of its inputs.
    pub edges: &'a [Edge],
    /// The gradient filter that a parameter names.
    pub method: Option<&'a Method>,
}

impl<'a> Wiring<'a> {
    /// Indices of the edges that feed a port. Errors: the node type does not declare it.
    pub fn edges(self, port: &str) -> Result<impl Iterator<Item = usize> + use<'a>> {
        let index = self.ports.into_iter().flatten().position(|p| p.name == port).ok_or_else(|| {
            Error::run(format!(
                "the node type '{}' asks for an input '{port}' it does not declare",
                self.node_type
            ))
        })?;
        Ok((0..self.edges.len()).filter(move |&i| self.edges[i].port == index))
    }

    /// The gradient filter that one of the node's parameters names.
    pub fn method(self) -> Result<&'a Method> {
        self.method.ok_or_else(|| {
            Error::run(format!(
                "the node type '{}' asks for a gradient filter and names none",
                self.node_type
            ))
        })
    }
}
