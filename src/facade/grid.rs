//! Grids for a program: built from arrays in the program's own numbering, without a copy where the layout allows, or read from a file.

use crate::core::counted;
use crate::core::parameters::nearest_first;
use glam::DVec3;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use voltet_core::grid::{
    Array, CellSet, CellValues, Cells, Grid as BuiltGrid, Options, Polyhedron, RawGrid, code,
};
use voltet_core::progress::{NoProgress, Progress};
use voltet_core::{Error, Result, SharedSlice, grid};
use voltet_io::formats::{self, Request, TimeStep, face_stream};
use voltet_nodes::in_memory_grid::{self, HostGrid};

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
    /// Arrays of the program, of the whole grid or of its pieces.
    Arrays(Vec<RawGrid>, Options),
    /// A file, of which a volume reads its scalar alone.
    File(PathBuf, Box<Request>),
    /// A grid that was built before.
    Built(Arc<BuiltGrid>),
}

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
        offsets: &[impl Copy + TryInto<i64>],
        connectivity: &[impl Copy + TryInto<i64>],
    ) -> Result<Grid> {
        // Numbers beyond 64 bits become the largest, which is refused.
        let offsets: Vec<i64> = offsets.iter().map(|&offset| offset.try_into().unwrap_or(i64::MAX)).collect();
        let connectivity: Vec<i64> =
            connectivity.iter().map(|&number| number.try_into().unwrap_or(i64::MAX)).collect();
        let connectivity = PointNumbers::I64(&connectivity);
        let cells =
            CellArrays::Mixed { types, offsets: &offsets, connectivity, faces: &[], face_locations: &[] };
        Self::from_cells(points, raw_cells(cells, |own| own.to_vec().into())?)
    }

    /// Builds a grid from linear tetrahedra, four point numbers each.
    ///
    /// # Errors
    /// - numbers of points that do not exist.
    pub fn from_tetrahedra(
        points: impl Into<SharedSlice<DVec3>>,
        tetrahedra: impl Into<Vec<[u32; 4]>>,
    ) -> Result<Grid> {
        Self::from_cells(points, Cells::Tetrahedra(tetrahedra.into().into()))
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
        let source = Source::Arrays(vec![RawGrid::new(points, cells)], Options::default());
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
        let raw = self.raw("arrays are added")?;
        let (tuples, kind) = if on_cells { (raw.cells.count(), "cell") } else { (raw.points.len(), "point") };
        let Array { component_count, ref values } = array;
        if component_count == 0 || Some(values.len()) != tuples.checked_mul(component_count) {
            return Err(Error::usage("an array has the wrong number of values")
                .got(format!(
                    "{} of {}",
                    counted(values.len(), "value"),
                    counted(component_count, "component")
                ))
                .expected(format!("{component_count} for each of {}", counted(tuples, kind)))
                .at_item(name));
        }
        add_array(raw, name, array, on_cells)?;
        Ok(self)
    }

    /// Marks cells by VTK's `vtkGhostType`: with bit 1 a ghost of another piece, which serves gradients and means of cell data and is
    /// not drawn; with bits 8 or 32 a cell that is left out.
    ///
    /// # Errors
    /// - another number of flags than cells;
    /// - a grid that is no program's.
    pub fn ghost_cells(mut self, flags: Vec<u8>) -> Result<Grid> {
        let raw = self.raw("cells are marked as ghosts")?;
        if flags.len() != raw.cells.count() {
            let error = Error::usage("the ghost flags have the wrong number").got(flags.len());
            return Err(error.expected(format!("{}, one a cell", raw.cells.count())));
        }
        raw.ghost = Some(flags);
        Ok(self)
    }

    /// Gives each point a number that the same point has in other pieces: [`Grid::from_pieces`].
    ///
    /// # Errors
    /// - another number of ids than points;
    /// - a grid that is no program's.
    pub fn global_ids(mut self, ids: Vec<i64>) -> Result<Grid> {
        let raw = self.raw("points are given global ids")?;
        if ids.len() != raw.points.len() {
            let error = Error::usage("the global ids have the wrong number").got(ids.len());
            return Err(error.expected(format!("{}, one a point", raw.points.len())));
        }
        raw.global_ids = Some(ids);
        Ok(self)
    }

    /// Puts pieces of one grid together: points of different pieces become one where their global ids are equal, or without ids at
    /// equal positions with equal values: of the arrays that a pipeline requests ([`crate::Pipeline::with_grid`]), of all arrays in a
    /// [`crate::Volume`]. Ghost cells of which a piece has the original are left out. What is added to the grid afterwards is for the points of
    /// all pieces together, as they are joined by the arrays that they have by then.
    ///
    /// # Errors
    /// - a piece that was not made from arrays.
    ///
    /// What the pieces lack is found when the grid is built.
    pub fn from_pieces(pieces: impl IntoIterator<Item = Grid>) -> Result<Grid> {
        let mut options = Options::default();
        let mut raw = Vec::new();
        for piece in pieces {
            match piece.source {
                Source::Arrays(own, of_piece) => {
                    options = if raw.is_empty() { of_piece } else { options };
                    raw.extend(own);
                }
                Source::File(..) | Source::Built(_) => {
                    let error = Error::usage("a piece of a grid was not made from arrays");
                    return Err(error.expected("Grid::from_vtk_arrays, from_tetrahedra or from_cells"));
                }
            }
        }
        Ok(Grid { source: Source::Arrays(raw, options) })
    }

    /// Number of straight pieces between two nodes of a curved cell's edge, 1 … 64.
    ///
    /// # Errors
    /// - a number out of range.
    pub fn subdivision(self, pieces: u32) -> Result<Grid> {
        if !(1..=64).contains(&pieces) {
            let error = Error::usage("the subdivision of curved cells is out of range").got(pieces);
            return Err(error.expected("a whole number from 1 to 64"));
        }
        Ok(self.with_options(|options| options.subdivision = pieces))
    }

    /// Keeps cell data constant within each cell.
    pub fn constant_cell_data(self) -> Grid {
        self.with_options(|options| options.cell_values = CellValues::Constant)
    }

    /// Changes how it is built; a grid that is built stays as it is.
    fn with_options(mut self, change: impl FnOnce(&mut Options)) -> Grid {
        match &mut self.source {
            Source::Arrays(_, options) => change(options),
            Source::File(_, request) => change(&mut request.options),
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
        Ok(match &self.source {
            Source::Arrays(pieces, _) => arrays_of(pieces).into_keys().map(str::to_string).collect(),
            Source::File(path, request) => {
                formats::arrays(path, request)?.into_iter().map(|array| array.name).collect()
            }
            Source::Built(grid) => grid.point_arrays.keys().cloned().collect(),
        })
    }

    fn raw(&mut self, action: &str) -> Result<&mut RawGrid> {
        match &mut self.source {
            Source::Arrays(pieces, _) => {
                if pieces.len() != 1 {
                    *pieces = vec![grid::join(std::mem::take(pieces))?];
                }
                Ok(&mut pieces[0])
            }
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
    /// - no piece, or pieces of which one lacks an array;
    /// - a scalar that does not exist, or has several components;
    /// - a grid without a cell that can be drawn.
    pub fn build(self, scalar: Option<&str>, progress: &dyn Progress) -> Result<Arc<BuiltGrid>> {
        let grid = match self.source {
            Source::File(path, mut request) => {
                request.scalar = scalar.map(str::to_string).or(request.scalar);
                return formats::read(&path, &request, progress).map(Arc::new);
            }
            Source::Arrays(raw, options) => Arc::new(grid::build(grid::join(raw)?, &options, progress)?),
            Source::Built(grid) => grid,
        };
        let Some(name) = scalar.filter(|name| grid.scalar.is_none() || grid.scalar_name != *name) else {
            return Ok(grid);
        };
        let mut grid = Arc::unwrap_or_clone(grid);
        in_memory_grid::set_scalar(&mut grid, name)?;
        Ok(Arc::new(grid))
    }

    /// The grid that stands for a node's. Errors: as of [`Grid::build`].
    pub(crate) fn in_memory(self) -> Result<HostGrid> {
        match self.source {
            Source::Arrays(raw, options) => HostGrid::build(raw, None, &options),
            _ => self.build(None, &NoProgress).map(HostGrid::from),
        }
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

/// Cells in memory of a host program.
#[derive(Debug, Clone, Copy)]
pub enum CellArrays<'a> {
    /// Four point numbers each.
    Tetrahedra(&'a [u32]),
    /// Any of VTK's types.
    Mixed {
        /// The type of every cell.
        types: &'a [u8],
        /// Index of each cell's first point in the connectivity, and the index past the last cell's points.
        offsets: &'a [i64],
        /// Point numbers.
        connectivity: PointNumbers<'a>,
        /// Faces of polyhedra (type 42): for each the number of faces, then each face's count and points.
        faces: &'a [i64],
        /// Index of each cell's faces in `faces`, read for polyhedra alone; empty where there are none.
        face_locations: &'a [i64],
    },
}

/// Point numbers in memory of a host program.
#[derive(Debug, Clone, Copy)]
pub enum PointNumbers<'a> {
    /// 64 bits each.
    I64(&'a [i64]),
    /// 32 bits each.
    U32(&'a [u32]),
}

/// A piece of a grid in borrowed memory, without arrays. The slices must stay valid and unchanged as long as `keep` lives: that is the
/// promise of the code that made them. `points`: three numbers each.
///
/// # Errors
/// - a number too many for the points;
/// - those of the cells: counts that do not fit together, offsets that descend or leave the connectivity, damaged faces of polyhedra.
pub fn borrowed_piece(
    points: &'static [f64],
    cells: CellArrays<'static>,
    keep: &Arc<dyn Send + Sync>,
) -> Result<RawGrid> {
    if !points.len().is_multiple_of(3) {
        let error = Error::usage("the points are not three numbers each").got(points.len());
        return Err(error.expected("a multiple of 3"));
    }
    let points = SharedSlice::from_borrowed(bytemuck::cast_slice(points), keep.clone());
    Ok(RawGrid::new(points, raw_cells(cells, |own| SharedSlice::from_borrowed(own, keep.clone()))?))
}

/// Arrays of pieces with cells, which must all have the same.
fn arrays_of(pieces: &[RawGrid]) -> BTreeMap<&str, &Array> {
    let with_cells = pieces.iter().filter(|piece| pieces.len() == 1 || piece.cells.count() > 0);
    let arrays = with_cells.flat_map(|piece| piece.point_arrays.iter().chain(&piece.cell_arrays));
    arrays.map(|(name, array)| (name.as_str(), array)).collect()
}

/// Builds the grid of pieces, which are put together. `scalar`: the array that is drawn; where none is named the only one of one
/// component, and none where several are.
pub fn build_grid(pieces: Vec<RawGrid>, scalar: Option<&str>, options: &Options) -> Result<HostGrid> {
    if pieces.iter().any(|piece| piece.point_arrays.is_empty() && piece.cell_arrays.is_empty()) {
        return Err(Error::usage("the grid has no arrays").expected("at least the scalar that is drawn"));
    }
    let scalar = scalar_of(scalar, &pieces)?;
    HostGrid::build(pieces, scalar.as_deref(), options)
}

/// Error for a grid whose scalar must be named.
pub fn unnamed_scalar(grid: &BuiltGrid) -> Error {
    let scalars = grid.point_arrays.iter().filter(|(_, array)| array.component_count == 1);
    let names: Vec<&str> = scalars.map(|(name, _)| name.as_str()).collect();
    Error::usage("the scalar is not named").expected(one_of("", &names))
}

/// "an array of one component: a, b", the nearest to a name first.
fn one_of(wanted: &str, names: &[&str]) -> String {
    match names.is_empty() {
        true => "an array of one component".to_string(),
        false => {
            format!("an array of one component: {}", nearest_first(wanted, names.iter().copied()).join(", "))
        }
    }
}

/// Adds an array to a piece.
///
/// # Errors
/// - a name that another array has.
pub fn add_array(piece: &mut RawGrid, name: &str, array: Array, on_cells: bool) -> Result<()> {
    if piece.point_arrays.contains_key(name) || piece.cell_arrays.contains_key(name) {
        return Err(Error::usage("two arrays have the same name").got(format!("'{name}'")));
    }
    let arrays = if on_cells { &mut piece.cell_arrays } else { &mut piece.point_arrays };
    arrays.insert(name.into(), array);
    Ok(())
}

/// Name of the array that is drawn.
fn scalar_of(name: Option<&str>, pieces: &[RawGrid]) -> Result<Option<String>> {
    let all = arrays_of(pieces);
    let scalars: Vec<&str> =
        all.iter().filter(|known| known.1.component_count == 1).map(|known| *known.0).collect();
    match (name, &scalars[..]) {
        (Some(name), _) if scalars.contains(&name) => Ok(Some(name.to_string())),
        (Some(name), _) => {
            let found = match all.get(name) {
                Some(array) => format!("'{name}' of {}", counted(array.component_count, "component")),
                None => format!("'{name}'"),
            };
            Err(Error::usage("the grid has no such scalar").got(found).expected(one_of(name, &scalars)))
        }
        (None, [only]) => Ok(Some(only.to_string())),
        (None, _) => Ok(None),
    }
}

/// Cells as the import takes them. `share`: how tetrahedra of 32-bit numbers are taken over.
///
/// # Errors
/// - counts that do not fit together;
/// - offsets that descend or leave the connectivity;
/// - numbers that cannot be those of points;
/// - damaged faces of polyhedra.
fn raw_cells<'a>(
    cells: CellArrays<'a>,
    share: impl Fn(&'a [[u32; 4]]) -> SharedSlice<[u32; 4]>,
) -> Result<Cells> {
    let (types, offsets, connectivity) = match cells {
        CellArrays::Tetrahedra(numbers) => {
            let (tetrahedra, rest) = numbers.as_chunks::<4>();
            if !rest.is_empty() {
                let error = Error::usage("the tetrahedra are not four point numbers each").got(numbers.len());
                return Err(error.expected("a multiple of 4"));
            }
            return Ok(Cells::Tetrahedra(share(tetrahedra)));
        }
        CellArrays::Mixed { types, offsets, connectivity, .. } => (types, offsets, connectivity),
    };
    if offsets.len() != types.len() + 1 {
        let error = Error::usage("the cells have the wrong number of offsets").got(offsets.len());
        return Err(error.expected(format!("{}, one more than cells", types.len() + 1)));
    }
    let count = match connectivity {
        PointNumbers::U32(numbers) => numbers.len(),
        PointNumbers::I64(numbers) => numbers.len(),
    };
    check_offsets(offsets, count)?;
    let is_plain = is_plain(types, offsets);
    let connectivity = match connectivity {
        PointNumbers::U32(numbers) if is_plain => {
            return Ok(Cells::Tetrahedra(share(numbers[..4 * types.len()].as_chunks::<4>().0)));
        }
        PointNumbers::U32(numbers) => numbers.to_vec(),
        PointNumbers::I64(numbers) => point_numbers(numbers, "connectivity")?,
    };
    if is_plain {
        let tetrahedra = connectivity[..4 * types.len()].as_chunks::<4>().0.to_vec();
        return Ok(Cells::Tetrahedra(tetrahedra.into()));
    }
    let offsets = offsets.iter().map(|&offset| offset as u64).collect();
    let polyhedra = polyhedra(cells)?;
    Ok(Cells::Mixed(CellSet { types: types.to_vec(), offsets, connectivity, polyhedra }))
}

/// True if the cells are tetrahedra one after the other.
fn is_plain(types: &[u8], offsets: &[i64]) -> bool {
    !types.is_empty()
        && types.par_iter().all(|&t| t == code::TETRA)
        && offsets.par_iter().enumerate().all(|(i, &offset)| offset as usize == 4 * i)
}

/// Checks that offsets begin at 0 or above, never descend, and end within the connectivity.
fn check_offsets(offsets: &[i64], total: usize) -> Result<()> {
    let wrong = |number: usize, accepted: String| {
        let error = Error::usage(format!("offsets[{number}] is wrong")).got(offsets[number]);
        Err(error.expected(accepted))
    };
    if offsets[0] < 0 {
        return wrong(0, "0 or more".into());
    }
    if let Some(number) = offsets.windows(2).position(|pair| pair[1] < pair[0]) {
        return wrong(number + 1, format!("at least {}, the one before", offsets[number]));
    }
    match offsets.iter().position(|&offset| offset as u64 > total as u64) {
        Some(number) => wrong(number, format!("at most {total}, the count of the connectivity")),
        None => Ok(()),
    }
}

/// Point numbers in 32 bits.
fn point_numbers(numbers: &[i64], what: &str) -> Result<Vec<u32>> {
    if let Some(place) = numbers.par_iter().position_first(|&number| u32::try_from(number).is_err()) {
        return Err(Error::usage(format!("{what}[{place}] is no number of a point"))
            .got(numbers[place])
            .expected(format!("0 to {}", u32::MAX)));
    }
    Ok(numbers.par_iter().map(|&number| number as u32).collect())
}

/// Faces of the cells of type 42.
fn polyhedra(cells: CellArrays) -> Result<Vec<Polyhedron>> {
    let CellArrays::Mixed { types, faces, face_locations, .. } = cells else { return Ok(Vec::new()) };
    let mut polyhedra = Vec::new();
    if !types.contains(&code::POLYHEDRON) {
        return Ok(polyhedra);
    }
    if face_locations.len() != types.len() {
        let found = format!(
            "{} for {}, polyhedra among them",
            counted(face_locations.len(), "place"),
            counted(types.len(), "cell")
        );
        let what = if face_locations.is_empty() { "is missing" } else { "has the wrong length" };
        let error = Error::usage(format!("face_locations {what}")).got(found);
        return Err(error.expected("the place of each polyhedron's faces, one number a cell"));
    }
    let faces = point_numbers(faces, "faces")?;
    for (number, _) in types.iter().enumerate().filter(|(_, t)| **t == code::POLYHEDRON) {
        let place = face_locations[number];
        let damaged = || {
            Error::usage(format!("the faces of cell {number}, a polyhedron, are damaged"))
                .got(format!("face_locations[{number}] = {place} of {}", counted(faces.len(), "number")))
                .expected(
                    "the place of its number of faces, then each face's count and points, all within faces",
                )
        };
        let own = usize::try_from(place).ok().and_then(|place| faces.get(place..)).ok_or_else(damaged)?;
        let faces = face_stream(own, number).map_err(|_| damaged())?;
        polyhedra.push(Polyhedron { cell: number as u32, faces });
    }
    Ok(polyhedra)
}
