//! Ports of nodes, the wires between them, and the values at them: shared, never modified.

use glam::DVec3;
use std::any::Any;
use std::collections::BTreeMap;
use std::sync::Arc;
use voltet_core::camera::Camera;
use voltet_core::field::Method;
use voltet_core::grid::{Grid, extent};
use voltet_core::parameters::SourceSpan;
use voltet_core::picture::Picture;
use voltet_core::picture_parts::PictureParts;
use voltet_core::surface::Surface;
use voltet_core::transfer::TransferFunction;
use voltet_core::volume::Volume;
use voltet_core::{Error, Result};

/// Number of an output's content: equal revisions mean equal content, within one session.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Revision(pub(crate) u64);

/// Data of an engine for its own next stage; opaque to the graph.
pub type StagePayload = Arc<dyn Any + Send + Sync>;

/// A value at a port, of the type of its name in [`PortType`]. A report is JSON text; picture parts are an image with more than its pixels.
#[allow(missing_docs)]
#[derive(Debug, Clone)]
pub enum Value {
    Grid(Arc<Grid>),
    Volume(Arc<Volume>),
    TransferFunction(Arc<TransferFunctionSpec>),
    Camera(Arc<Camera>),
    Cells(StagePayload),
    Projection(StagePayload),
    Image(Arc<Picture>),
    PictureParts(Arc<PictureParts>),
    Report(Arc<str>),
    CellValues(Arc<CellValues>),
    Surface(Arc<Surface>),
    /// A value of a type that there is for each part of a grid, and not for the whole.
    InParts(PortType),
}

impl Value {
    /// The type of port that it belongs to.
    pub fn port_type(&self) -> PortType {
        match self {
            Value::Grid(_) => PortType::Grid,
            Value::Volume(_) => PortType::Volume,
            Value::TransferFunction(_) => PortType::TransferFunction,
            Value::Camera(_) => PortType::Camera,
            Value::Cells(_) => PortType::Cells,
            Value::Projection(_) => PortType::Projection,
            Value::Image(_) | Value::PictureParts(_) => PortType::Image,
            Value::Report(_) => PortType::Report,
            Value::CellValues(_) => PortType::CellValues,
            Value::Surface(_) => PortType::Surface,
            Value::InParts(port_type) => *port_type,
        }
    }

    /// The picture; `None` for values of other types.
    pub fn picture(&self) -> Option<&Arc<Picture>> {
        match self {
            Value::Image(picture) => Some(picture),
            Value::PictureParts(parts) => Some(&parts.picture),
            _ => None,
        }
    }

    /// The volume; a grid counts as one without gradient. `None` for values of other types.
    pub fn volume(&self) -> Option<Result<Arc<Volume>>> {
        match self {
            Value::Volume(volume) => Some(Ok(volume.clone())),
            Value::Grid(grid) => Some(match grid.scalar.clone() {
                Some(scalar) => {
                    let (grid, gradient, gradient_magnitude) = (grid.clone(), None, None);
                    Ok(Arc::new(Volume { grid, scalar, gradient, gradient_magnitude }))
                }
                None => Err(Error::usage("the grid carries no scalar to draw")
                    .expected("scalar = \"…\" at the reader")),
            }),
            _ => None,
        }
    }
}

/// Numbers of tetrahedra, by name: one a tetrahedron in the order of [`Grid::tetrahedra`]. A cell of the file has the largest
/// of its tetrahedra's.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CellValues {
    /// The arrays; none where nobody asked for them.
    pub arrays: BTreeMap<String, Vec<f32>>,
}

/// A transfer function as a pipeline states it: its unit distance may be left to the data.
#[derive(Debug, Clone, PartialEq)]
pub struct TransferFunctionSpec {
    /// The transfer function; its unit distance is 1 where `auto_unit_distance` is set.
    pub transfer_function: TransferFunction,
    /// `unit_distance = "auto"`: a hundredth of the diagonal of the data's bounding box.
    pub auto_unit_distance: bool,
    /// Diagonal of the bounding box of a time series, in place of that of the data at hand.
    pub series_diagonal: Option<f64>,
}

impl TransferFunctionSpec {
    /// A transfer function whose unit distance is stated, or left to the data at hand.
    pub fn new(transfer_function: TransferFunction, auto_unit_distance: bool) -> TransferFunctionSpec {
        TransferFunctionSpec { transfer_function, auto_unit_distance, series_diagonal: None }
    }

    /// The transfer function for data whose bounding box has this [`diagonal`].
    pub fn for_diagonal(&self, diagonal: f64) -> TransferFunction {
        let mut transfer_function = self.transfer_function.clone();
        if self.auto_unit_distance {
            transfer_function.unit_distance = self.series_diagonal.unwrap_or(diagonal) / 100.0;
        }
        transfer_function
    }
}

/// Diagonal of the bounding box of a grid's points, [`Grid::bounds`]; 100 where it has no extent, which no picture shows.
pub fn diagonal(bounds: Option<[DVec3; 2]>) -> f64 {
    let diagonal = bounds.map_or(0.0, extent::diagonal);
    if diagonal > 0.0 && diagonal.is_finite() { diagonal } else { 100.0 }
}

/// An input or an output of a node.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
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
    /// Triangles that are drawn in the volume.
    Surface,
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
            PortType::Surface => "surface",
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
    pub node: &'a str,
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

#[cfg(test)]
mod tests {
    use super::*;
    use voltet_core::transfer::OpticalModel;

    #[test]
    fn an_automatic_unit_distance_is_a_hundredth_of_the_diagonal_at_any_scale() {
        let transfer_function = TransferFunction {
            model: OpticalModel::DensityEmitter,
            unit_distance: 1.0,
            widgets: Vec::new(),
            axes: Default::default(),
        };
        let look = TransferFunctionSpec::new(transfer_function, true);
        for scale in [1.0, 1e-200, 1e200] {
            let bounds = [DVec3::new(1.0, 1.0, 1.0) * scale, DVec3::new(4.0, 5.0, 13.0) * scale];
            let unit = look.for_diagonal(diagonal(Some(bounds))).unit_distance;
            // Two roundings of the scaling and one of the root.
            assert!((unit / (0.13 * scale) - 1.0).abs() < 1e-14, "{unit} at {scale}");
        }
    }
}
