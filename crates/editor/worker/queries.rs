//! Queries to the worker besides pictures, and their results.

use super::request::RenderRequest;
use super::scales::DataScales;
use glam::DVec3;
use std::path::PathBuf;
use voltet_core::probing::Histogram;
use voltet_graph::{ArrayRef, NodeEntry};

/// The distribution of the data that is wanted.
#[derive(Debug, Clone, PartialEq)]
pub struct DistributionQuery {
    /// As of [`Wanted`](super::Wanted).
    pub nodes: Vec<NodeEntry>,
    /// As of [`Wanted`](super::Wanted).
    pub folder: PathBuf,
    /// The output that gives the volume.
    pub node: String,
    /// Along which quantities: "s", "g", or arrays.
    pub axes: [ArrayRef; 2],
    /// Further arrays whose ranges are wanted.
    pub fields: Vec<String>,
    /// True if numbers are relative to all steps of a time series together.
    pub of_series: bool,
    /// Identity of the query.
    pub key: u64,
}

/// Distribution of the data.
#[derive(Debug, Clone, PartialEq)]
pub struct Distribution {
    /// The volume in each bin.
    pub histogram: Histogram,
    /// Ranges, and the volume below each value of the axes: of this volume, or of all steps of its series.
    pub known: DataScales,
}

/// A place of the picture that is asked about.
#[derive(Debug, Clone, PartialEq)]
pub struct ProbeQuery {
    /// As of [`Wanted`](super::Wanted).
    pub nodes: Vec<NodeEntry>,
    /// As of [`Wanted`](super::Wanted).
    pub folder: PathBuf,
    /// The outputs that give the volume, the transfer function and the camera.
    pub sources: [String; 3],
    /// Places, in heights of the picture from its middle, to the right and up.
    pub places: Vec<[f64; 2]>,
    /// Identity of the query.
    pub key: u64,
}

/// Values on the probed rays.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PixelProbe {
    /// As of [`Probing`].
    pub key: u64,
    /// Rays that were walked; 0 where the values are those of a section.
    pub rays: usize,
    /// Values [s, g] with their shares of what is seen (or of the way, where nothing is).
    pub values: Vec<([f64; 2], f64)>,
    /// The point where the most is seen, world units; `None` where no ray meets a cell.
    pub point: Option<DVec3>,
    /// Opacity of the rays, mean.
    pub opacity: f64,
}

/// A section that is wanted.
#[derive(Debug, Clone, PartialEq)]
pub struct SectionQuery {
    /// As of [`Wanted`](super::Wanted).
    pub nodes: Vec<NodeEntry>,
    /// As of [`Wanted`](super::Wanted).
    pub folder: PathBuf,
    /// The output that gives the volume.
    pub node: String,
    /// The point in the middle, world units.
    pub centre: DVec3,
    /// Unit vectors in the plane: to the right and up in its picture.
    pub axes: [DVec3; 2],
    /// Half of its height, world units.
    pub half: f64,
    /// Pixels of its picture.
    pub size: [usize; 2],
    /// Identity of the query.
    pub key: u64,
}

/// Section of the data by a plane.
#[derive(Debug, Clone, PartialEq)]
pub struct Section {
    /// As it was asked for.
    pub of: SectionQuery,
    /// [s, g] at the middle of each pixel, rows from the top; none outside of all cells.
    pub values: Vec<Option<[f64; 2]>>,
    /// Cells that the plane cuts.
    pub cells: usize,
}

/// A widget that is asked about.
#[derive(Debug, Clone, PartialEq)]
pub struct ShareQuery {
    /// The picture that is shown.
    pub wanted: RenderRequest,
    /// The transfer function.
    pub look: String,
    /// The widget's place in that picture's list.
    pub widget: usize,
    /// Identity of the query.
    pub key: u64,
}

/// Contribution of a widget to the picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Share {
    /// Fraction of the picture's opacity that is gone without the widget, 0 to 1; parts that it hides come to light
    /// instead.
    pub opacity: f64,
    /// Fraction of the picture's light that changes without the widget; above 1 where more comes to light than it gave.
    pub light: f64,
    /// Pixels that were compared.
    pub pixels: usize,
    /// Cells that it may contribute in, of all; none where no engine counts them.
    pub cells: Option<[u64; 2]>,
}
