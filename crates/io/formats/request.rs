//! Request to a reader: arrays, time step, conversion of cell values, the reader of a format that comes from outside.

use super::source::Source;
use std::path::{Path, PathBuf};
use voltet_core::grid::CellValues;
use voltet_core::parameters::Parameters;
use voltet_core::reading::GridReader;
use voltet_core::{Error, Result};

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

impl Request {
    /// Index of the requested step in a series of these times, ascending and at least one.
    ///
    /// Errors: the series has none such.
    pub(super) fn step_index(&self, times: &[f64]) -> Result<usize> {
        let [first, last] = [times[0], times[times.len() - 1]];
        match self.time_step {
            None => Ok(0),
            Some(TimeStep::Index(index)) if index < times.len() => Ok(index),
            Some(TimeStep::Index(index)) => Err(Error::run("the time series has no such step")
                .got(format_args!("step {index}"))
                .expected(format_args!("0 to {}", times.len() - 1))),
            Some(TimeStep::Time(time)) => {
                // The span of the series with a margin for times that were rounded when they were written.
                let margin = 1e-6 * (last - first).abs().max(last.abs());
                if !(first - margin..=last + margin).contains(&time) {
                    let error =
                        Error::run("the file has no such time: the time lies outside the series").got(time);
                    return Err(error.expected(format_args!("{first} to {last}")));
                }
                let distance = |step: &usize| (times[*step] - time).abs();
                Ok((0..times.len()).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(0))
            }
        }
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

/// The reader of a format that comes from outside, with what its parameters are set to.
#[derive(Clone)]
pub struct SelectedArrays {
    /// The reader.
    pub reader: &'static dyn GridReader,
    /// Its parameters, and maybe others.
    pub parameters: Parameters,
}

impl SelectedArrays {
    /// With its standard values, for a file of its format; the first of several. `None` where it is of none of theirs.
    ///
    /// Errors: the file cannot be read; a parameter that must be given.
    pub fn for_file(
        path: &Path,
        mut readers: impl Iterator<Item = &'static dyn GridReader>,
    ) -> Result<Option<SelectedArrays>> {
        let mut head = None;
        let meant = readers.find_map(|reader| {
            // Not opened for nobody.
            let head = head.get_or_insert_with(|| Source::open(path).and_then(|source| source.head(256)));
            match head {
                Ok(head) => reader.matches(head, path).then_some(Ok(reader)),
                Err(error) => Some(Err(error.clone())),
            }
        });
        let Some(reader) = meant.transpose()? else { return Ok(None) };
        let parameters = Parameters::from_values(reader.declaration().parameters, [])?;
        Ok(Some(SelectedArrays { reader, parameters }))
    }
}

impl PartialEq for SelectedArrays {
    fn eq(&self, other: &SelectedArrays) -> bool {
        std::ptr::addr_eq(self.reader, other.reader) && self.parameters == other.parameters
    }
}

impl std::fmt::Debug for SelectedArrays {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Chosen").field("reader", &self.reader.declaration().name).finish_non_exhaustive()
    }
}
