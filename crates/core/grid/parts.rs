//! Parts of a grid as a reader returns them: points, cells in VTK's terms, and arrays; and a file's own cells beside the tetrahedra.

use super::cell_set::CellSet;
use crate::{Error, Result, SharedSlice};
use glam::DVec3;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Location of an array's values: points or cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
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
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Cells {
    /// Linear tetrahedra only, four point numbers each.
    Tetrahedra(SharedSlice<[u32; 4]>),
    /// Any cells.
    Mixed(CellSet),
    /// The hexahedra of a structured grid: number of points along each axis, the first running fastest.
    Structured([usize; 3]),
}

impl Default for Cells {
    /// No cells.
    fn default() -> Self {
        Cells::Tetrahedra(SharedSlice::default())
    }
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

/// The points of a cell of a structured grid, in a voxel's order. `points`: those along each axis, whose product fits 32 bits.
#[inline]
pub fn structured_corners([nx, ny, _]: [usize; 3], number: usize) -> [u32; 8] {
    let (i, rest) = (number % (nx - 1), number / (nx - 1));
    let (j, k) = (rest % (ny - 1), rest / (ny - 1));
    std::array::from_fn(|corner| {
        ((i + (corner & 1)) + nx * ((j + (corner >> 1 & 1)) + ny * (k + (corner >> 2)))) as u32
    })
}

/// The points of a cell; none of a structured grid's, which [`super::join`] has made a set.
pub(super) fn corners(cells: &Cells, number: usize) -> &[u32] {
    match cells {
        Cells::Tetrahedra(tetrahedra) => &tetrahedra[number],
        Cells::Mixed(set) => {
            let range = set.offsets[number] as usize..set.offsets[number + 1] as usize;
            set.connectivity.get(range).unwrap_or(&[])
        }
        Cells::Structured(_) => &[],
    }
}

/// The scalar that is to be drawn.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Scalar {
    /// Its name as the user wrote it.
    pub name: String,
    /// Location of the values.
    pub association: Association,
    /// One value a point or cell of the file.
    pub values: SharedSlice<f64>,
}

/// Counts of a grid's import, for `info` and the report.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct ImportStats {
    /// Cells of the file by VTK type code.
    pub cells_by_type: BTreeMap<u8, u64>,
    /// Three-dimensional cells left out because a position or the scalar is not finite.
    pub cells_not_finite: u64,
    /// Ghost cells left out.
    pub cells_ghost: u64,
    /// Ghost cells whose original is in no piece.
    pub ghosts_without_owner: u64,
    /// Points of pieces that are another piece's, too.
    pub points_joined: u64,
    /// Cells that are not three-dimensional (vertices, lines, triangles, …), which a volume picture ignores.
    pub cells_not_volume: u64,
    /// Arrays of the file that nobody asked for and that were not decoded.
    pub arrays_unread: Vec<String>,
    /// Numbers that they hold, as far as the file's headers say.
    pub values_unread: u64,
    /// Arrays that were decoded: the scalar and those beside it.
    pub arrays_decoded: u64,
    /// Point arrays that are means of arrays of the file's cells.
    pub arrays_of_cells: Vec<String>,
    /// The time that the values are of, where the file says it.
    pub time: Option<f64>,
    /// Units that the file states of the scalar and of further arrays that were read, by their names.
    pub units: BTreeMap<String, String>,
    /// Names of the blocks of the file, by the numbers in the cell array that holds them.
    pub blocks: Vec<String>,
    /// First cell of each piece of a part of a grid, by its number in the part and in the whole grid, ascending. Empty for all of a
    /// grid.
    pub first_cells: Vec<[u64; 2]>,
    /// Warnings for the user, each a sentence.
    pub warnings: Vec<String>,
}

impl ImportStats {
    /// The number in the whole grid of a cell of a part.
    pub fn whole_cell(&self, cell: u32) -> u64 {
        let cell = u64::from(cell);
        let last = self.first_cells.iter().rev().find(|first| first[0] <= cell);
        last.map_or(cell, |[here, there]| cell - here + there)
    }
}

/// Values of an array of cells on faces at the boundary, where a file states them: points of these faces have the means of the faces'
/// values in the place of those of the cells'.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct BoundaryValues {
    /// Points of all faces.
    pub points: Vec<u32>,
    /// The end of each face's points.
    pub ends: Vec<usize>,
    /// A tuple for each face.
    pub values: Vec<f64>,
}

impl BoundaryValues {
    /// Faces with the points by other numbers.
    pub(super) fn renumbered(mut self, number: impl Fn(u32) -> u32) -> BoundaryValues {
        self.points.iter_mut().for_each(|point| *point = number(*point));
        self
    }

    /// Adds the faces of another piece.
    pub(super) fn append(&mut self, other: BoundaryValues) {
        let first = self.points.len();
        self.points.extend(other.points);
        self.ends.extend(other.ends.iter().map(|end| first + end));
        self.values.extend(other.values);
    }

    /// Faces with finite values, by other numbers of their points; those without are left out.
    pub(super) fn of_points(
        &self,
        component_count: usize,
        number: impl Fn(u32) -> Option<u32>,
    ) -> BoundaryValues {
        let mut own = BoundaryValues::default();
        let begins = std::iter::once(0).chain(self.ends.iter().copied());
        for ((begin, &end), value) in begins.zip(&self.ends).zip(self.values.chunks(component_count.max(1))) {
            let before = own.points.len();
            if value.iter().all(|value| value.is_finite()) {
                let points = self.points.get(begin..end).unwrap_or_default();
                own.points.extend(points.iter().filter_map(|&point| number(point)));
            }
            if own.points.len() > before {
                own.ends.push(own.points.len());
                own.values.extend_from_slice(value);
            }
        }
        own
    }

    /// Memory that they take.
    pub(super) fn byte_count(&self) -> usize {
        size_of_val(&self.points[..]) + size_of_val(&self.ends[..]) + size_of_val(&self.values[..])
    }

    /// Number of faces with a value that is not finite, `component_count` numbers a tuple.
    pub(super) fn not_finite(&self, component_count: usize) -> usize {
        let tuples = self.values.chunks(component_count.max(1));
        tuples.filter(|tuple| tuple.iter().any(|value| !value.is_finite())).count()
    }

    /// Sets means at the points of the faces with finite values, `component_count` numbers a tuple.
    pub(super) fn set_means(&self, means: &mut [f64], component_count: usize) {
        let n = component_count.max(1);
        let mut sums: BTreeMap<u32, (f64, Vec<f64>)> = BTreeMap::new();
        let begins = std::iter::once(0).chain(self.ends.iter().copied());
        for ((begin, &end), value) in begins.zip(&self.ends).zip(self.values.chunks(n)) {
            if value.iter().any(|value| !value.is_finite()) {
                continue;
            }
            let points = self.points.get(begin..end).unwrap_or_default();
            for &point in points.iter().filter(|point| **point != UNUSED) {
                let (count, sum) = sums.entry(point).or_insert_with(|| (0.0, vec![0.0; n]));
                *count += 1.0;
                sum.iter_mut().zip(value).for_each(|(sum, value)| *sum += value);
            }
        }
        for (point, (count, sum)) in sums {
            if let Some(mean) = means.get_mut(point as usize * n..(point as usize + 1) * n) {
                mean.iter_mut().zip(sum).for_each(|(mean, sum)| *mean = sum / count);
            }
        }
    }
}

/// Result of a reader, in the file's own numbering.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct RawGrid {
    /// Positions, world units. May hold points that no cell uses.
    pub points: SharedSlice<DVec3>,
    /// The cells.
    pub cells: Cells,
    /// `vtkGhostType` of every cell: bit 1 marks a ghost, which serves gradients and means of cell values and is not drawn; bits 8
    /// and 32 leave a cell out.
    pub ghost: Option<Vec<u8>>,
    /// Numbers of the points that the same points have in other pieces; read by [`super::join`] alone.
    pub global_ids: Option<Vec<i64>>,
    /// Number of the grid that it is a piece of: [`super::join`] leaves the points of different blocks apart.
    pub block: usize,
    /// Numbers among `points` of the points of the pieces that were joined, one piece after the other; `None`: it was whole.
    pub joined_points: Option<Vec<u32>>,
    /// The scalar asked for.
    pub scalar: Option<Scalar>,
    /// Further arrays that sit on points; they keep their names.
    pub point_arrays: BTreeMap<String, Array>,
    /// Further arrays that sit on cells; they become point arrays as [`Options::cell_values`] says.
    pub cell_arrays: BTreeMap<String, Array>,
    /// Values at the boundary of the scalar and of `cell_arrays`, by their names, where the file has such.
    pub boundary_values: BTreeMap<String, BoundaryValues>,
    /// Arrays that stay on the cells: [`super::Grid::cell_arrays`].
    pub kept_cell_arrays: BTreeMap<String, Array>,
    /// Degrees along the three axes of every cell, for Lagrange and Bezier cells whose degrees differ between axes;
    /// `None`: the same along all, found from the number of points.
    pub degrees: Option<Vec<[u8; 3]>>,
    /// Hanging points of an adaptive grid, see [`super::Grid::hanging`]; `None`: the grid is none.
    pub hanging: Option<Vec<HangingPoint>>,
    /// The reader's counts of arrays, and its warnings; [`super::build()`] adds those of the cells.
    pub origin: ImportStats,
}

impl RawGrid {
    /// Points and cells, without any values.
    pub fn new(points: impl Into<SharedSlice<DVec3>>, cells: Cells) -> Self {
        RawGrid { points: points.into(), cells, ..RawGrid::default() }
    }

    /// Refuses arrays whose lengths do not fit the points and cells.
    pub(super) fn check_lengths(&self) -> Result<()> {
        let point_count = self.points.len();
        number(point_count, "the grid has too many points", "")?;
        let cell_count = self.cells.count();
        number(cell_count, "the grid has too many cells", "")?;
        match &self.cells {
            Cells::Structured(n) => {
                let product = n.iter().fold(1usize, |product, &n| product.saturating_mul(n));
                if product != point_count {
                    return Err(Error::run("a structured grid has the wrong number of points")
                        .got(point_count)
                        .expected(format!("{} × {} × {}", n[0], n[1], n[2])));
                }
            }
            Cells::Mixed(cells) if cells.offsets.len() != cell_count + 1 => {
                return Err(Error::run("the cells have the wrong number of offsets")
                    .got(cells.offsets.len())
                    .expected(cell_count + 1));
            }
            _ => {}
        }
        let expect = |name: &str, found: usize, accepted: usize| {
            if found == accepted {
                return Ok(());
            }
            Err(Error::run("an array has the wrong number of values")
                .got(found)
                .expected(accepted)
                .at_item(name))
        };
        let count_of = |association| if association == Association::Point { point_count } else { cell_count };
        if let Some(scalar) = &self.scalar {
            expect(&scalar.name, scalar.values.len(), count_of(scalar.association))?;
        }
        for (arrays, association) in [
            (&self.point_arrays, Association::Point),
            (&self.cell_arrays, Association::Cell),
            (&self.kept_cell_arrays, Association::Cell),
        ] {
            for (name, array) in arrays {
                let tuples = count_of(association);
                expect(name, array.values.len(), tuples.saturating_mul(array.component_count.max(1)))?;
            }
        }
        if let Some(ghost) = &self.ghost {
            expect("ghost flags", ghost.len(), cell_count)?;
        }
        if let Some(ids) = &self.global_ids {
            expect("global ids", ids.len(), point_count)?;
        }
        if let Some(degrees) = &self.degrees {
            expect("degrees", degrees.len(), cell_count)?;
        }
        let of_faces = self.boundary_values.values().flat_map(|own| own.points.iter().copied());
        if let Some(wrong) = of_faces.filter(|&number| number as usize >= point_count).min() {
            let error = Error::run("a face at the boundary names a point that does not exist").got(wrong);
            return Err(error.expected(format!("a point number below {point_count}")));
        }
        let numbers = self.hanging.iter().flatten().flat_map(HangingPoint::numbers);
        if let Some(wrong) = numbers.into_iter().find(|&number| number as usize >= point_count) {
            let error = Error::run("a hanging point names a point that does not exist").got(wrong);
            return Err(error.expected(format!("a point number below {point_count}")));
        }
        Ok(())
    }

    /// Ghost cells whose original is in no piece.
    pub fn ghosts_without_owner(&self) -> u64 {
        self.ghost.iter().flatten().filter(|&&flags| is_ghost(flags)).count() as u64
    }
}

/// Bit of `vtkGhostType` at a cell of which another piece has the original: DUPLICATECELL.
pub(super) const DUPLICATE: u8 = 1;
/// Bits of `vtkGhostType` at cells that a finer grid replaces or that are blanked: REFINEDCELL, HIDDENCELL.
const HIDDEN: u8 = 8 | 32;
/// A ghost cell whose original is there. VTK gives this bit no meaning.
pub(super) const OWNED: u8 = 128;
/// A cell of another part of the grid that serves this one as a ghost. VTK gives this bit no meaning.
pub(super) const NEIGHBOUR: u8 = 64;

/// True if a cell with this `vtkGhostType` is not drawn but serves gradients and means of cell values: no piece has its original.
pub(super) fn is_ghost(flags: u8) -> bool {
    flags & (DUPLICATE | HIDDEN | OWNED) == DUPLICATE
}

/// True if a cell with this `vtkGhostType` serves nothing.
pub(super) fn is_left_out(flags: u8) -> bool {
    flags & (HIDDEN | OWNED) != 0
}

/// True if a cell with this `vtkGhostType` is another part's.
pub(super) fn is_neighbour(flags: u8) -> bool {
    flags & (DUPLICATE | NEIGHBOUR) == DUPLICATE | NEIGHBOUR
}

/// True if a cell with this `vtkGhostType` is drawn: it is no ghost, and not hidden.
pub fn is_drawn(flags: u8) -> bool {
    flags & (DUPLICATE | HIDDEN) == 0
}

/// `vtkGhostType` as it was given.
pub(super) fn as_given(flags: u8) -> u8 {
    flags & !(OWNED | NEIGHBOUR)
}

/// Refuses a count that leaves the 32 bits of point and cell numbers. `what` needs it or has it; `remedy`: another way, or nothing.
pub(super) fn number(count: usize, what: &str, remedy: &str) -> Result<u32> {
    u32::try_from(count)
        .map_err(|_| Error::run(what).got(count).expected(format!("at most {}{remedy}", u32::MAX)))
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
    /// True if the grid may be the file's cells, points and arrays alone, as they are, without tetrahedra: nothing is drawn of it. Only
    /// with `keep_cells`; a scalar, and arrays of cells that become point arrays, need the tetrahedra all the same.
    pub without_tetrahedra: bool,
}

impl Default for Options {
    fn default() -> Self {
        Options {
            subdivision: 1,
            cell_values: CellValues::Average,
            keep_cells: false,
            without_tetrahedra: false,
        }
    }
}

pub(super) struct Cell<'a> {
    /// Number in the file.
    pub number: usize,
    /// VTK type code.
    pub code: u8,
    pub corners: &'a [u32],
}

/// An array with one tuple a point (or cell), components of a tuple side by side.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Array {
    /// Components of a tuple, at least 1.
    pub component_count: usize,
    /// `tuples × component_count` values.
    pub values: SharedSlice<f64>,
}

impl From<SharedSlice<f64>> for Array {
    fn from(values: SharedSlice<f64>) -> Self {
        Array { component_count: 1, values }
    }
}

impl From<Vec<f64>> for Array {
    fn from(values: Vec<f64>) -> Self {
        SharedSlice::from(values).into()
    }
}

impl From<&[f64]> for Array {
    fn from(values: &[f64]) -> Self {
        values.to_vec().into()
    }
}

impl From<Vec<f32>> for Array {
    fn from(values: Vec<f32>) -> Self {
        values.into_iter().map(f64::from).collect::<Vec<f64>>().into()
    }
}

impl From<Vec<[f64; 3]>> for Array {
    fn from(vectors: Vec<[f64; 3]>) -> Self {
        Array { component_count: 3, values: vectors.into_flattened().into() }
    }
}

/// A point within a face or an edge of a larger cell: corners of one of its tetrahedra, and their weights at the point.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct HangingPoint {
    /// Number of the point.
    pub point: u32,
    /// Corners; those of weight 0 repeat others.
    pub corners: [u32; 4],
    /// Weights, whose sum is 1.
    pub weights: [f64; 4],
}

impl HangingPoint {
    pub(super) fn numbers(&self) -> [u32; 5] {
        let [a, b, c, d] = self.corners;
        [self.point, a, b, c, d]
    }

    pub(super) fn renumbered(&self, number: impl Fn(u32) -> u32) -> HangingPoint {
        HangingPoint { point: number(self.point), corners: self.corners.map(number), ..*self }
    }
}

/// The number of a point that no tetrahedron uses.
pub(super) const UNUSED: u32 = u32::MAX;

/// A file's cells and points, in the file's own numbering.
#[derive(Debug, Clone, PartialEq)]
pub struct FileCells {
    /// The cells, also those that are no volume.
    pub cells: Cells,
    /// Positions of all points, also of those that no cell uses.
    pub points: SharedSlice<DVec3>,
    /// For each point its number in the grid, see [`FileCells::grid_point`]; `None`: the same.
    pub(super) numbers: Option<Vec<u32>>,
    /// For each point of the pieces, one after the other, its number among `points`; `None`: the file was one piece.
    pub joined_points: Option<Vec<u32>>,
    /// `vtkGhostType` of every cell.
    pub ghost: Option<Vec<u8>>,
    /// Degrees along the three axes of every cell, where the file gives them.
    pub degrees: Option<Vec<[u8; 3]>>,
}

impl FileCells {
    /// True if the points have the same numbers in the grid, which may have further ones behind them.
    pub fn is_numbered_alike(&self) -> bool {
        self.numbers.is_none()
    }

    /// The number in the grid of a point of the file; `None` where no tetrahedron uses it.
    pub fn grid_point(&self, point: usize) -> Option<usize> {
        match &self.numbers {
            None => Some(point),
            Some(numbers) => numbers.get(point).filter(|&&number| number != UNUSED).map(|&n| n as usize),
        }
    }
}
