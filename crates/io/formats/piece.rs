//! The table of contents of a data set: what lies in which file, before anything is decoded.

use super::added::ExternalFormat;
use super::source::Source;
use super::stored::Stored;
use glam::{DMat3, DVec3};
use std::sync::Arc;

/// Everything that one reading may decode.
#[derive(Debug, Default)]
pub(super) struct Dataset {
    /// Format and encoding, for people: "VTK XML UnstructuredGrid, appended raw, zlib, little-endian".
    pub format: String,
    /// The parts, whose cells are put together.
    pub pieces: Vec<Piece>,
    /// Times of a series' steps; empty where there is no series.
    pub time_steps: Vec<f64>,
    /// Name of the array that the file marks as its scalars.
    pub active_scalars: Option<String>,
    /// Sentences for the user.
    pub warnings: Vec<String>,
}

/// One part: its own points and cells.
#[derive(Debug)]
pub(super) struct Piece {
    pub point_count: u64,
    pub cell_count: u64,
    pub geometry: Geometry,
    pub arrays: Vec<PieceArray>,
}

/// An array of a piece.
#[derive(Debug)]
pub(super) struct PieceArray {
    /// True: one tuple a cell; false: one a point.
    pub per_cell: bool,
    pub stored: Stored,
}

/// Points and cells.
#[derive(Debug)]
pub(super) enum Geometry {
    /// Points and cells of any type.
    Unstructured { points: Stored, cells: Box<StoredCells> },
    /// A box of hexahedra; `dimensions` counts points. `points`: first coordinate fastest.
    Curvilinear { dimensions: [u64; 3], points: Stored },
    /// Grid of a reader from outside, from that file.
    Added(Arc<ExternalFormat>, Arc<Source>),
    /// Axis-parallel boxes between coordinates.
    Rectilinear { dimensions: [u64; 3], axes: Box<[Stored; 3]> },
    /// Equal boxes: point (i, j, k) lies at `origin + direction · (spacing · (first + (i, j, k)))`.
    Uniform { dimensions: [u64; 3], first: DVec3, origin: DVec3, spacing: DVec3, direction: DMat3 },
}

/// Cells as a file stores them.
#[derive(Debug)]
pub(super) enum StoredCells {
    /// Connectivity with the end (or the bounds) of every cell's part; faces of polyhedra.
    Offsets { connectivity: Stored, offsets: Stored, types: Stored, faces: StoredFaces },
    /// The list of legacy files before 5.0: a count before each cell's points.
    Counted { list: Stored, types: Stored },
}

/// Faces of polyhedra as a file stores them.
#[derive(Debug)]
pub(super) enum StoredFaces {
    /// There are none.
    None,
    /// `faces`: for each polyhedron the number of faces, then each face's count and points; `offsets`: for each cell
    /// the end of its part, -1 where it is none.
    Stream { faces: Box<Stored>, offsets: Box<Stored> },
    /// Faces once, by number: points of all faces and their bounds; faces of all cells and their bounds.
    Indexed { points: Box<Stored>, point_offsets: Box<Stored>, faces: Box<Stored>, face_offsets: Box<Stored> },
    /// The connectivity of a polyhedron is its stream (legacy files).
    InConnectivity,
}

impl Piece {
    /// The arrays of points (`per_cell` false) or cells.
    pub fn arrays_of(&self, per_cell: bool) -> impl Iterator<Item = &PieceArray> {
        self.arrays.iter().filter(move |array| array.per_cell == per_cell)
    }
}

/// Points and cells of a structured extent, by its numbers of points; `None` on overflow.
pub(super) fn structured_counts(dimensions: [u64; 3]) -> Option<(u64, u64)> {
    let product = |n: [u64; 3]| n[0].checked_mul(n[1])?.checked_mul(n[2]);
    let points = product(dimensions)?;
    // As in VTK, an axis with one point gives cells of a lower dimension.
    let cells = if points == 0 { 0 } else { product(dimensions.map(|n| (n - 1).max(1)))? };
    Some((points, cells))
}

/// Dimensions from an extent (first and last index of each axis).
pub(super) fn extent_dimensions(extent: [i64; 6]) -> [u64; 3] {
    std::array::from_fn(|axis| {
        let span = i128::from(extent[2 * axis + 1]) - i128::from(extent[2 * axis]) + 1;
        u64::try_from(span.max(0)).unwrap_or(u64::MAX)
    })
}
