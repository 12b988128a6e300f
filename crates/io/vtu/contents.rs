//! Contents of a file to write.

use glam::DVec3;
use voltet_core::SharedSlice;
use voltet_core::grid::{CellSet, Cells, Polyhedron, code};

/// Points, cells and arrays.
#[derive(Debug, Clone)]
pub struct Contents {
    /// Positions, world units.
    pub points: SharedSlice<DVec3>,
    /// The cells.
    pub cells: Topology,
    /// One tuple a point.
    pub point_arrays: Vec<Column>,
    /// One tuple a cell.
    pub cell_arrays: Vec<Column>,
}

/// An array by name.
#[derive(Debug, Clone)]
pub struct Column {
    /// Its name.
    pub name: String,
    /// Role of the array for other programs.
    pub role: Role,
    /// Components of a tuple.
    pub component_count: usize,
    /// Tuples side by side.
    pub values: Values,
}

/// Numbers of one type.
#[derive(Debug, Clone)]
pub enum Values {
    /// Quantities.
    Floats(Vec<f64>),
    /// Flags and small numbers.
    Bytes(Vec<u8>),
    /// Numbers of cells.
    Numbers(Vec<u32>),
}

/// Role of an array for other programs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// The scalar to show first.
    Scalar,
    /// The vectors to show first.
    Vectors,
    /// One of many.
    Plain,
}

/// Bits of a written quantity.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Precision {
    /// 32 where that keeps every value of the array, else 64.
    Lossless,
    /// 32, rounded.
    Single,
    /// 64.
    Double,
}

/// Cells as a file lists them.
#[derive(Debug, Clone, Default)]
pub struct Topology {
    /// Point numbers of all cells, one after the other.
    pub connectivity: Vec<u32>,
    /// End of each cell's part.
    pub offsets: Vec<u64>,
    /// VTK type codes.
    pub types: Vec<u8>,
    /// Faces of the polyhedra.
    pub polyhedra: Vec<Polyhedron>,
}

impl Topology {
    /// Tetrahedra.
    pub fn of_tetrahedra(tetrahedra: &[[u32; 4]]) -> Self {
        Topology {
            connectivity: tetrahedra.as_flattened().to_vec(),
            offsets: (1..=tetrahedra.len() as u64).map(|i| 4 * i).collect(),
            types: vec![code::TETRA; tetrahedra.len()],
            polyhedra: Vec::new(),
        }
    }

    /// The cells of a file; those of structured grids become hexahedra.
    pub fn of_cells(cells: &Cells) -> Self {
        match cells {
            Cells::Tetrahedra(own) => Self::of_tetrahedra(own),
            Cells::Mixed(CellSet { types, offsets, connectivity, polyhedra }) => Topology {
                // What stands before the first cell and behind the last belongs to none.
                connectivity: connectivity[offsets[0] as usize..offsets[types.len()] as usize].to_vec(),
                offsets: offsets[1..].iter().map(|end| end - offsets[0]).collect(),
                types: types.clone(),
                polyhedra: polyhedra.clone(),
            },
            &Cells::Structured(points) => {
                let count = cells.count();
                Topology {
                    connectivity: (0..count).flat_map(|i| hexahedron(points, i)).collect(),
                    offsets: (1..=count as u64).map(|i| 8 * i).collect(),
                    types: vec![code::HEXAHEDRON; count],
                    polyhedra: Vec::new(),
                }
            }
        }
    }
}

/// The corners of a cell of a structured grid with so many points along its axes, in VTK's order of a hexahedron.
fn hexahedron([nx, ny, _]: [usize; 3], number: usize) -> [u32; 8] {
    let (i, rest) = (number % (nx - 1), number / (nx - 1));
    let (j, k) = (rest % (ny - 1), rest / (ny - 1));
    let at = |[di, dj, dk]: [usize; 3]| ((i + di) + nx * ((j + dj) + ny * (k + dk))) as u32;
    [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]].map(at)
}

impl Values {
    /// Their number.
    pub fn len(&self) -> usize {
        match self {
            Values::Floats(floats) => floats.len(),
            Values::Bytes(bytes) => bytes.len(),
            Values::Numbers(numbers) => numbers.len(),
        }
    }

    /// True if there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}
