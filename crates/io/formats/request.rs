//! Request to a reader: arrays, time step, conversion of cell values.

use super::chosen::SelectedArrays;
use std::path::PathBuf;
use voltet_core::grid::CellValues;

/// Location of an array's values: points, cells, or whichever has the array.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Association {
    /// The point array of that name, or, if there is none, the cell array.
    #[default]
    Auto,
    /// One tuple a point.
    Point,
    /// One tuple a cell.
    Cell,
}

/// A step of a time series.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum TimeStep {
    /// The step's number in the series, from 0.
    Index(usize),
    /// The step whose time is nearest; must lie within the series.
    Time(f64),
}

/// Request to a reader. [`Request::default`] reads the only array (or the one the file marks as its scalars).
#[derive(Debug, Clone, PartialEq)]
pub struct Request {
    /// The scalar: an array's name (`density`), or for arrays of several components `NAME:magnitude` or `NAME:0`.
    /// `None`: the only array of the file, or the one that the file marks as its scalars.
    pub scalar: Option<String>,
    /// Location to search for the scalar.
    pub association: Association,
    /// Conversion of a scalar per cell.
    pub cell_values: CellValues,
    /// Further arrays, per point (cell arrays are averaged); all components, or one as in `scalar`.
    pub point_arrays: Vec<String>,
    /// Cell arrays that are wanted as they are; all components, or one as in `scalar`.
    pub cell_arrays: Vec<String>,
    /// True if the grid keeps the file's cells as they are.
    pub keep_cells: bool,
    /// The step of a time series (.pvd); `None`: the first.
    pub time_step: Option<TimeStep>,
    /// Pieces between two neighbouring nodes of a curved cell's edge, 1 to 64: 1 goes straight from node to node
    /// (through the mid-edge nodes).
    pub subdivision: u32,
    /// The PLOT3D solution (q) file that belongs to the grid file; `None`: the grid's name with the ending `.q`, if
    /// there is such a file.
    pub solution: Option<PathBuf>,
    /// The reader of a format that comes from outside, if the file is of one.
    pub chosen: Option<SelectedArrays>,
    /// Every other array is decoded too, though nobody looks at it: to show what not doing so saves.
    pub every_array: bool,
}

impl Request {
    /// The type of the node that reads such a file.
    pub fn node_type(&self) -> &'static str {
        self.chosen.as_ref().map_or("reader", |chosen| chosen.reader.declaration().name)
    }
}

impl Default for Request {
    fn default() -> Self {
        Request {
            scalar: None,
            association: Association::Auto,
            cell_values: CellValues::Average,
            point_arrays: Vec::new(),
            cell_arrays: Vec::new(),
            keep_cells: false,
            time_step: None,
            subdivision: 1,
            solution: None,
            chosen: None,
            every_array: false,
        }
    }
}
