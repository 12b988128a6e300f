//! Raw grid: a file's points, cells and arrays, as a reader returns them.

use super::Array;
use super::cells::CellSet;
use crate::SharedSlice;
use glam::DVec3;
use std::collections::BTreeMap;

/// Location of an array's values: points or cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Association {
    /// One tuple a point.
    Point,
    /// One tuple a cell of the file.
    Cell,
}

/// Conversion of cell values to point values.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum CellValues {
    /// Mean over the cells that use the point, weighted by their volume.
    #[default]
    Average,
    /// Every cell keeps its own value: it gets points of its own, so that neighbours share none.
    Constant,
}

/// The cells of a file.
#[derive(Debug, Clone, PartialEq)]
pub enum Cells {
    /// Linear tetrahedra only, four point numbers each.
    Tetrahedra(Vec<[u32; 4]>),
    /// Any cells.
    Mixed(CellSet),
    /// The hexahedra of a structured grid: number of points along each axis, the first running fastest.
    Structured([usize; 3]),
}

impl Cells {
    /// Number of cells, of any dimension. (Of a structured grid: saturating; `build` checks it.)
    pub fn count(&self) -> usize {
        match self {
            Cells::Tetrahedra(t) => t.len(),
            Cells::Mixed(cells) => cells.types.len(),
            Cells::Structured(points) => {
                points.iter().map(|&n| n.saturating_sub(1)).fold(1, usize::saturating_mul)
            }
        }
    }
}

/// The scalar that is to be drawn.
#[derive(Debug, Clone, PartialEq)]
pub struct Scalar {
    /// Its name as the user wrote it.
    pub name: String,
    /// Location of the values.
    pub association: Association,
    /// One value a point or cell of the file.
    pub values: SharedSlice<f64>,
}

/// Result of a reader, in the file's own numbering.
#[derive(Debug, Clone)]
pub struct RawGrid {
    /// Positions, world units. May hold points that no cell uses.
    pub points: SharedSlice<DVec3>,
    /// The cells.
    pub cells: Cells,
    /// One flag a cell: true leaves it out as a ghost (it is drawn by another piece) or a blanked cell.
    pub ghost: Option<Vec<bool>>,
    /// The scalar asked for.
    pub scalar: Option<Scalar>,
    /// Further arrays that sit on points; they keep their names.
    pub point_arrays: BTreeMap<String, Array>,
    /// Further arrays that sit on cells; they become point arrays as [`Options::cell_values`] says.
    pub cell_arrays: BTreeMap<String, Array>,
    /// Arrays that stay on the cells: [`super::Grid::cell_arrays`].
    pub kept_cell_arrays: BTreeMap<String, Array>,
    /// Degrees along the three axes of every cell, for Lagrange and Bezier cells whose degrees differ between axes;
    /// `None`: the same along all, found from the number of points.
    pub degrees: Option<Vec<[u8; 3]>>,
    /// Names of arrays of the file that nobody asked for.
    pub arrays_unread: Vec<String>,
    /// Numbers that they hold.
    pub values_unread: u64,
    /// Arrays that were decoded.
    pub arrays_decoded: u64,
    /// Warnings of the reader, each a sentence.
    pub warnings: Vec<String>,
}

impl RawGrid {
    /// Points and cells, without any values.
    pub fn new(points: impl Into<SharedSlice<DVec3>>, cells: Cells) -> Self {
        RawGrid {
            points: points.into(),
            cells,
            ghost: None,
            scalar: None,
            point_arrays: BTreeMap::new(),
            cell_arrays: BTreeMap::new(),
            kept_cell_arrays: BTreeMap::new(),
            degrees: None,
            arrays_unread: Vec::new(),
            values_unread: 0,
            arrays_decoded: 0,
            warnings: Vec::new(),
        }
    }
}

/// Choices of [`super::build()`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Options {
    /// Pieces between two neighbouring nodes of a curved cell's edge, at least 1: 1 goes straight from node to
    /// node (through the mid-edge nodes), n cuts each such stretch into n along the curve.
    pub subdivision: u32,
    /// Conversion of cell values to point values.
    pub cell_values: CellValues,
    /// True if the grid keeps the file's cells, to write them back: [`super::Grid::file_cells`].
    pub keep_cells: bool,
}

impl Default for Options {
    fn default() -> Self {
        Options { subdivision: 1, cell_values: CellValues::Average, keep_cells: false }
    }
}
