//! Grids for a program: built from arrays in the program's own numbering, or read from a file.

use super::grid_arrays::{CellArrays, NamedArray, PointNumbers, add_array, raw_cells};
use glam::DVec3;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use voltet_core::grid::{self, Array, CellValues, Cells, Grid as BuiltGrid, Options, RawGrid};
use voltet_core::progress::Progress;
use voltet_core::{Error, Result, SharedSlice};
use voltet_io::formats::{self, Request, TimeStep};
use voltet_nodes::in_memory_grid;

/// An unstructured or structured grid with its arrays, which stay in the numbering in which they are given: unused points, ghost
/// cells and cells that cannot be drawn are left out inside.
///
/// ```
/// # fn main() -> voltet::Result<()> {
/// use voltet::Grid;
/// let points = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// let grid = Grid::from_tetrahedra(points, vec![[0, 1, 2, 3]])?.point_data("T", vec![0.0, 1.0, 2.0, 3.0])?;
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone)]
pub struct Grid {
    source: Source,
}

#[derive(Debug, Clone)]
enum Source {
    /// Arrays of the program.
    Arrays(Box<RawGrid>, Options),
    /// A file, of which a volume reads its scalar alone.
    File(PathBuf, Box<Request>),
    /// A grid that was built before.
    Built(Arc<BuiltGrid>),
}

/// Integer types of point numbers and offsets.
pub trait GridIndex: Copy {
    /// The number in 64 bits; numbers beyond them become the largest, which is refused.
    fn to_i64(self) -> i64;
}

macro_rules! grid_index {
    ($($integer:ty),*) => { $(impl GridIndex for $integer {
        fn to_i64(self) -> i64 {
            i64::try_from(self).unwrap_or(i64::MAX)
        }
    })* };
}
grid_index!(i32, u32, i64, u64, usize);

impl Grid {
    /// Builds a grid from the arrays of a `vtkUnstructuredGrid`: the VTK type of every cell, `types.len() + 1` offsets, and point
    /// numbers in VTK's vertex order. For polyhedra see [`Grid::from_cells`].
    ///
    /// # Errors
    /// - counts that do not fit together;
    /// - offsets that descend or leave the connectivity;
    /// - numbers of points that do not exist.
    pub fn from_vtk_arrays(
        points: impl Into<SharedSlice<DVec3>>,
        types: &[u8],
        offsets: &[impl GridIndex],
        connectivity: &[impl GridIndex],
    ) -> Result<Grid> {
        let offsets: Vec<i64> = offsets.iter().map(|&offset| offset.to_i64()).collect();
        let connectivity: Vec<i64> = connectivity.iter().map(|&number| number.to_i64()).collect();
        let connectivity = PointNumbers::I64(&connectivity);
        let cells =
            CellArrays::Mixed { types, offsets: &offsets, connectivity, faces: &[], face_locations: &[] };
        Self::from_cells(points, raw_cells(cells)?)
    }

    /// Builds a grid from linear tetrahedra, four point numbers each.
    ///
    /// # Errors
    /// - numbers of points that do not exist.
    pub fn from_tetrahedra(
        points: impl Into<SharedSlice<DVec3>>,
        tetrahedra: impl Into<Vec<[u32; 4]>>,
    ) -> Result<Grid> {
        Self::from_cells(points, Cells::Tetrahedra(tetrahedra.into()))
    }

    /// Builds a grid from cells of any form: mixed with polyhedra, or structured.
    ///
    /// # Errors
    /// - numbers of points that do not exist.
    pub fn from_cells(points: impl Into<SharedSlice<DVec3>>, cells: Cells) -> Result<Grid> {
        let points = points.into();
        let largest = match &cells {
            Cells::Tetrahedra(tetrahedra) => tetrahedra.as_flattened().iter().max(),
            Cells::Mixed(cells) => cells.connectivity.iter().max(),
            Cells::Structured(_) => None,
        };
        if let Some(largest) = largest.filter(|&&largest| largest as usize >= points.len()) {
            let error =
                Error::usage("a cell uses a point that does not exist").got(format!("point {largest}"));
            return Err(error.expected(format!("a point number below {}", points.len())));
        }
        let source = Source::Arrays(Box::new(RawGrid::new(points, cells)), Options::default());
        Ok(Grid { source })
    }

    /// Opens a data file (.vtu, .pvtu, .vtk, .pvd, PLOT3D, …). A volume reads its scalar from it.
    ///
    /// # Errors
    /// - a file that cannot be read, or is of no known format.
    pub fn read(path: impl AsRef<Path>) -> Result<Grid> {
        let (path, request) = (path.as_ref().to_path_buf(), Request::default());
        // Damage of the headers is found here, that of arrays when they are read.
        formats::arrays(&path, &request)?;
        Ok(Grid { source: Source::File(path, Box::new(request)) })
    }

    /// Adds an array with a tuple a point.
    ///
    /// # Errors
    /// - another number of tuples than points;
    /// - a name that another array has;
    /// - a grid that is no program's.
    pub fn point_data(self, name: &str, values: impl Into<Array>) -> Result<Grid> {
        self.add(name, values.into(), false)
    }

    /// Adds an array with a tuple a cell, of which points get the mean of their cells (see [`Grid::constant_cell_data`]).
    ///
    /// # Errors
    /// As of [`Grid::point_data`], for cells.
    pub fn cell_data(self, name: &str, values: impl Into<Array>) -> Result<Grid> {
        self.add(name, values.into(), true)
    }

    fn add(mut self, name: &str, array: Array, on_cells: bool) -> Result<Grid> {
        let (raw, _) = self.raw("arrays are added")?;
        let (tuples, kind) =
            if on_cells { (raw.cells.count(), "cells") } else { (raw.points.len(), "points") };
        let Array { component_count, values } = array;
        if component_count == 0 || Some(values.len()) != tuples.checked_mul(component_count) {
            return Err(Error::usage("an array has the wrong number of values")
                .got(format!("{} values of {component_count} components", values.len()))
                .expected(format!("{component_count} for each of {tuples} {kind}"))
                .at_item(name));
        }
        add_array(raw, NamedArray { name: name.into(), values, component_count, on_cells })?;
        Ok(self)
    }

    /// Leaves out the cells whose flag is set: ghosts of other pieces, blanked cells.
    ///
    /// # Errors
    /// - another number of flags than cells;
    /// - a grid that is no program's.
    pub fn ghost_cells(mut self, flags: Vec<bool>) -> Result<Grid> {
        let (raw, _) = self.raw("cells are marked as ghosts")?;
        if flags.len() != raw.cells.count() {
            let error = Error::usage("the ghost flags have the wrong number").got(flags.len());
            return Err(error.expected(format!("{}, one a cell", raw.cells.count())));
        }
        raw.ghost = Some(flags);
        Ok(self)
    }

    /// Number of straight pieces between two nodes of a curved cell's edge, 1 … 64.
    ///
    /// # Errors
    /// - a number out of range.
    pub fn subdivision(mut self, pieces: u32) -> Result<Grid> {
        if !(1..=64).contains(&pieces) {
            let error = Error::usage("the subdivision of curved cells is out of range").got(pieces);
            return Err(error.expected("a whole number from 1 to 64"));
        }
        match &mut self.source {
            Source::Arrays(_, options) => options.subdivision = pieces,
            Source::File(_, request) => request.subdivision = pieces,
            Source::Built(_) => {}
        }
        Ok(self)
    }

    /// Keeps cell data constant within each cell.
    pub fn constant_cell_data(mut self) -> Grid {
        match &mut self.source {
            Source::Arrays(_, options) => options.cell_values = CellValues::Constant,
            Source::File(_, request) => request.cell_values = CellValues::Constant,
            Source::Built(_) => {}
        }
        self
    }

    /// Selects a step of a file's time series; grids of arrays have one.
    pub fn time_step(mut self, step: TimeStep) -> Grid {
        if let Source::File(_, request) = &mut self.source {
            request.time_step = Some(step);
        }
        self
    }

    /// Reads further arrays of a file, for widgets over several fields; grids of arrays have all of theirs.
    pub fn with_fields(mut self, names: &[&str]) -> Grid {
        if let Source::File(_, request) = &mut self.source {
            request.point_arrays.extend(names.iter().map(|name| name.to_string()));
        }
        self
    }

    /// Names of its arrays.
    ///
    /// # Errors
    /// - a file that cannot be read.
    pub fn array_names(&self) -> Result<Vec<String>> {
        let names = |arrays: &mut dyn Iterator<Item = &String>| arrays.cloned().collect();
        Ok(match &self.source {
            Source::Arrays(raw, _) => names(&mut raw.point_arrays.keys().chain(raw.cell_arrays.keys())),
            Source::File(path, request) => {
                formats::arrays(path, request)?.into_iter().map(|array| array.name).collect()
            }
            Source::Built(grid) => names(&mut grid.point_arrays.keys()),
        })
    }

    fn raw(&mut self, action: &str) -> Result<(&mut RawGrid, &mut Options)> {
        match &mut self.source {
            Source::Arrays(raw, options) => Ok((raw, options)),
            Source::File(..) | Source::Built(_) => {
                let error = Error::usage(format!("{action} to a grid that was not made from arrays"));
                Err(error.expected("Grid::from_vtk_arrays, from_tetrahedra or from_cells"))
            }
        }
    }

    /// Builds the tetrahedra. `scalar`: the array that becomes the grid's scalar, as `NAME`, `NAME:magnitude` or `NAME:0`.
    ///
    /// # Errors
    /// - those of the file;
    /// - a scalar that does not exist, or has several components;
    /// - a grid without a cell that can be drawn.
    pub fn build(self, scalar: Option<&str>, progress: &dyn Progress) -> Result<Arc<BuiltGrid>> {
        let grid = match self.source {
            Source::File(path, mut request) => {
                request.scalar = scalar.map(str::to_string).or(request.scalar);
                return formats::read(&path, &request, progress).map(Arc::new);
            }
            Source::Arrays(raw, options) => Arc::new(grid::build(*raw, &options, progress)?),
            Source::Built(grid) => grid,
        };
        let Some(name) = scalar.filter(|name| grid.scalar.is_none() || grid.scalar_name != *name) else {
            return Ok(grid);
        };
        let array = in_memory_grid::point_array(&grid, name)?;
        if array.component_count != 1 {
            let found = format!("'{name}' of {} components", array.component_count);
            let error = Error::usage("the array is not a scalar").got(found);
            return Err(error.expected(format!("'{name}:magnitude', or '{name}:0' for a component")));
        }
        let mut grid = Arc::unwrap_or_clone(grid);
        (grid.scalar, grid.scalar_name) = (Some(array.values.clone()), name.to_string());
        Ok(Arc::new(grid))
    }
}

impl From<Arc<BuiltGrid>> for Grid {
    fn from(grid: Arc<BuiltGrid>) -> Self {
        Grid { source: Source::Built(grid) }
    }
}

impl From<&Grid> for Grid {
    fn from(grid: &Grid) -> Self {
        grid.clone()
    }
}
