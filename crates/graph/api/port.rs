//! Typed ports of nodes, and the wires between them.

use voltet_core::field::Method;
use voltet_core::parameters::SourceSpan;
use voltet_core::{Error, Result};

/// An input or an output of a node.
#[derive(Debug, Clone, Copy)]
pub struct Port {
    /// Its name.
    pub name: &'static str,
    /// Type of its values.
    pub port_type: PortType,
    /// One sentence.
    pub summary: &'static str,
}

/// Type of the values at a port.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum PortType {
    /// Points, tetrahedra, arrays.
    Grid,
    /// A grid with its scalar and, where asked for, the gradient.
    Volume,
    /// Widgets and an optical model.
    TransferFunction,
    /// The view of the picture.
    Camera,
    /// Cells that can contribute.
    Cells,
    /// Cells projected to the picture.
    Projection,
    /// A picture: premultiplied linear colour and opacity.
    Image,
    /// Figures about a run.
    Report,
    /// Numbers of tetrahedra.
    CellValues,
}

impl PortType {
    /// The name in help and messages.
    pub fn name(self) -> &'static str {
        match self {
            PortType::Grid => "grid",
            PortType::Volume => "volume",
            PortType::TransferFunction => "transfer-function",
            PortType::Camera => "camera",
            PortType::Cells => "cells",
            PortType::Projection => "projection",
            PortType::Image => "image",
            PortType::Report => "report",
            PortType::CellValues => "cell-values",
        }
    }

    /// The name with its article, for messages.
    pub fn with_article(self) -> String {
        let article = if self == PortType::Image { "an" } else { "a" };
        format!("{article} {}", self.name())
    }

    /// True if an output of this type can be wired to an input of type `input`. A grid serves as a volume without
    /// gradient.
    pub fn serves(self, input: PortType) -> bool {
        self == input || (self == PortType::Grid && input == PortType::Volume)
    }
}

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
