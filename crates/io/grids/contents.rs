//! Contents of a written file: points, cells and arrays of a grid, in the numbering of the file that it came from.

use super::numbers::{Numbers, Precision};
use std::borrow::Cow;
use std::sync::Arc;
use voltet_core::grid::{Array, CellSet, Cells, FileCells, Grid, Polyhedron, code, into_set};

/// Points, cells and arrays.
pub struct Contents<'a> {
    grid: &'a Grid,
    /// The file whose cells are written; `None`: the tetrahedra that they were split into.
    file: Option<&'a FileCells>,
    precision: Precision,
    pub(super) points: Numbers<'a>,
    pub(super) cells: WrittenCells<'a>,
    /// One tuple a point.
    pub(super) point_arrays: Vec<Column<'a>>,
    /// One tuple a cell.
    pub(super) cell_arrays: Vec<Column<'a>>,
}

/// The cells; none before the first offset.
pub(super) struct WrittenCells<'a> {
    /// VTK cell type codes.
    pub types: Cow<'a, [u8]>,
    /// One more than cells, the first 0.
    pub offsets: Cow<'a, [u64]>,
    pub connectivity: Cow<'a, [u32]>,
    pub polyhedra: Cow<'a, [Polyhedron]>,
}

/// An array by name.
pub(super) struct Column<'a> {
    pub name: String,
    pub role: Role,
    pub component_count: usize,
    /// Tuples side by side.
    pub numbers: Numbers<'a>,
}

/// Role of an array for other programs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// The scalar to show first.
    Scalar,
    /// The vectors to show first.
    Vectors,
    /// The degrees of Lagrange and Bezier cells along their axes.
    HigherOrderDegrees,
    /// One of many.
    Plain,
}

impl Role {
    /// VTK's name of the role.
    pub(super) fn name(self) -> Option<&'static str> {
        match self {
            Role::Scalar => Some("Scalars"),
            Role::Vectors => Some("Vectors"),
            Role::HigherOrderDegrees => Some(DEGREES),
            Role::Plain => None,
        }
    }
}

/// VTK's name of the array of degrees.
const DEGREES: &str = "HigherOrderDegrees";

/// A tetrahedron whose fourth corner lies on the side of the others' normal, as VTK has it.
fn oriented(grid: &Grid, i: usize) -> [u32; 4] {
    let [a, b, c, d] = grid.tetrahedra[i];
    let [p, q, r, s] = grid.corners(i);
    if (q - p).cross(r - p).dot(s - p) < 0.0 { [a, c, b, d] } else { [a, b, c, d] }
}

impl<'a> WrittenCells<'a> {
    fn new(cells: &'a Cells) -> Self {
        match cells {
            Cells::Tetrahedra(own) => Self::of_tetrahedra(Cow::Borrowed(own.as_flattened())),
            Cells::Mixed(CellSet { types, offsets, connectivity, polyhedra }) => {
                // What stands before the first cell and behind the last belongs to none.
                let (first, last) = (offsets[0], offsets[types.len()]);
                let offsets = match first {
                    0 => Cow::Borrowed(&offsets[..]),
                    _ => Cow::Owned(offsets.iter().map(|end| end - first).collect()),
                };
                let connectivity = Cow::Borrowed(&connectivity[first as usize..last as usize]);
                let (types, polyhedra) = (Cow::Borrowed(&types[..]), Cow::Borrowed(&polyhedra[..]));
                WrittenCells { types, offsets, connectivity, polyhedra }
            }
            Cells::Structured(_) => {
                let CellSet { types, offsets, connectivity, polyhedra } = into_set(cells.clone());
                WrittenCells {
                    types: types.into(),
                    offsets: offsets.into(),
                    connectivity: connectivity.into(),
                    polyhedra: polyhedra.into(),
                }
            }
        }
    }

    fn of_tetrahedra(connectivity: Cow<'a, [u32]>) -> Self {
        let count = connectivity.len() / 4;
        WrittenCells {
            types: vec![code::TETRA; count].into(),
            offsets: (0..=count as u64).map(|cell| 4 * cell).collect(),
            connectivity,
            polyhedra: Cow::default(),
        }
    }
}

impl<'a> Contents<'a> {
    /// The cells of `file`, those of structured grids as hexahedra, or where there is none the tetrahedra of the grid; with the arrays
    /// that belong to them, and no others. `precision`: of positions and quantities.
    pub fn new(grid: &'a Grid, file: Option<&'a FileCells>, precision: Precision) -> Contents<'a> {
        let points = file.map_or(&grid.points, |file| &file.points);
        let cells = match file {
            Some(file) => WrittenCells::new(&file.cells),
            None => {
                let corners: Vec<[u32; 4]> = (0..grid.tetrahedra.len()).map(|i| oriented(grid, i)).collect();
                WrittenCells::of_tetrahedra(corners.into_flattened().into())
            }
        };
        let points = Numbers::quantities(bytemuck::cast_slice::<_, f64>(points.as_slice()), precision);
        let (point_arrays, cell_arrays) = (Vec::new(), Vec::new());
        let mut contents = Contents { grid, file, precision, points, cells, point_arrays, cell_arrays };
        let Some(file) = file else {
            let cells: Vec<u32> = (0..grid.tetrahedra.len()).map(|i| grid.source_cell(i) as u32).collect();
            let narrow = cells.iter().all(|&cell| cell <= i32::MAX as u32);
            contents.add_to_cells("file_cell", Role::Plain, 1, Numbers::indices(cells, narrow));
            return contents;
        };
        if let Some(ghost) = &file.ghost {
            contents.add_to_cells("vtkGhostType", Role::Plain, 1, Numbers::flags(&ghost[..]));
        }
        if let Some(degrees) = &file.degrees {
            let degrees = Numbers::flags(degrees.as_flattened());
            contents.add_to_cells(DEGREES, Role::HigherOrderDegrees, 3, degrees);
        }
        contents
    }

    /// Number of points.
    pub fn point_count(&self) -> usize {
        self.points.count() / 3
    }

    /// Number of cells.
    pub fn cell_count(&self) -> usize {
        self.cells.types.len()
    }

    /// Number of arrays.
    pub fn array_count(&self) -> usize {
        self.point_arrays.len() + self.cell_arrays.len()
    }

    /// Names of the arrays, those of the points first.
    pub fn array_names(&self) -> impl Iterator<Item = &str> {
        self.point_arrays.iter().chain(&self.cell_arrays).map(|array| array.name.as_str())
    }

    /// Bytes of points, cells and arrays, about as they are written.
    pub fn byte_count(&self) -> u64 {
        let arrays = self.point_arrays.iter().chain(&self.cell_arrays);
        let arrays: u64 = arrays.map(|array| array.numbers.byte_count()).sum();
        let cells = 8 * (self.cells.connectivity.len() + self.cells.offsets.len()) + self.cells.types.len();
        self.points.byte_count() + arrays + cells as u64
    }

    /// Bytes of the largest of points, cells and arrays.
    pub fn largest_array_bytes(&self) -> u64 {
        let arrays = self.point_arrays.iter().chain(&self.cell_arrays);
        let arrays = arrays.map(|array| array.numbers.byte_count());
        let connectivity = 8 * self.cells.connectivity.len() as u64;
        arrays.chain([self.points.byte_count(), connectivity]).max().unwrap_or(0)
    }

    /// True if an array at points has this name.
    pub fn has_point_array(&self, name: &str) -> bool {
        self.point_arrays.iter().any(|array| array.name == name)
    }

    pub(super) fn time(&self) -> Option<f64> {
        self.grid.origin.time.filter(|time| time.is_finite())
    }

    fn add_to_cells(&mut self, name: &str, role: Role, component_count: usize, numbers: Numbers<'a>) {
        self.cell_arrays.push(Column { name: name.to_string(), role, component_count, numbers });
    }

    /// Adds values of the grid's points. Points of the file that no tetrahedron uses get NaN.
    pub fn add_point_values(
        &mut self,
        name: &str,
        role: Role,
        values: impl Into<Cow<'a, [f64]>>,
        component_count: usize,
    ) {
        let values = self.at_written_points(values.into(), component_count);
        let numbers = Numbers::quantities(values, self.precision);
        self.point_arrays.push(Column { name: name.to_string(), role, component_count, numbers });
    }

    /// Values of the grid's points at those that are written.
    fn at_written_points(&self, values: Cow<'a, [f64]>, n: usize) -> Cow<'a, [f64]> {
        let Some(file) = self.file else { return values };
        let count = file.points.len();
        if file.is_numbered_alike() {
            // Points that splitting cells has added come last.
            return match values {
                Cow::Borrowed(values) => Cow::Borrowed(&values[..count * n]),
                Cow::Owned(mut values) => {
                    values.truncate(count * n);
                    Cow::Owned(values)
                }
            };
        }
        let mut own = Vec::with_capacity(count * n);
        for point in 0..count {
            match file.grid_point(point) {
                Some(at) => own.extend_from_slice(&values[at * n..(at + 1) * n]),
                None => own.extend(std::iter::repeat_n(f64::NAN, n)),
            }
        }
        own.into()
    }

    /// Adds arrays of the file's cells.
    pub fn add_cell_arrays(&mut self, arrays: impl Iterator<Item = (&'a String, &'a Arc<Array>)>) {
        let grid = self.grid;
        for (name, array) in arrays {
            let n = array.component_count;
            let values = match self.file {
                Some(_) => Cow::Borrowed(&array.values[..]),
                None => (0..grid.tetrahedra.len())
                    .map(|i| grid.source_cell(i))
                    .flat_map(|cell| &array.values[cell * n..(cell + 1) * n])
                    .copied()
                    .collect(),
            };
            self.add_to_cells(name, Role::Plain, n, Numbers::quantities(values, self.precision));
        }
    }

    /// Adds numbers of tetrahedra, none negative. A cell has the largest of its tetrahedra's.
    pub fn add_tetrahedra_values(&mut self, name: &str, numbers: &[f32]) {
        let values = self.largest_in_cells(|i| f64::from(numbers[i]));
        self.add_to_cells(name, Role::Plain, 1, Numbers::quantities(values, self.precision));
    }

    /// Adds flags of culled cells (1), none of whose tetrahedra is `kept`.
    pub fn add_culled(&mut self, name: &str, kept: &[bool]) {
        let kept = self.largest_in_cells(|i| f64::from(u8::from(kept[i])));
        let culled: Vec<u8> = kept.iter().map(|&kept| u8::from(kept == 0.0)).collect();
        self.add_to_cells(name, Role::Plain, 1, Numbers::flags(culled));
    }

    /// The largest value of each cell's tetrahedra, at least 0.
    fn largest_in_cells(&self, value: impl Fn(usize) -> f64) -> Vec<f64> {
        let count = self.grid.tetrahedra.len();
        let Some(file) = self.file else { return (0..count).map(value).collect() };
        let mut cells = vec![0.0; file.cells.count()];
        for i in 0..count {
            let cell: &mut f64 = &mut cells[self.grid.source_cell(i)];
            *cell = cell.max(value(i));
        }
        cells
    }

    /// Points of the file that have no values, since no tetrahedron uses them.
    pub fn points_without_values(&self) -> usize {
        self.file.map_or(0, |file| (0..file.points.len()).filter(|&p| file.grid_point(p).is_none()).count())
    }
}
