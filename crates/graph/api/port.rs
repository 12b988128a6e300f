//! Typed ports of nodes.

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
