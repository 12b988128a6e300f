//! Memory: what a grid takes while it is read and drawn, what this process may still take, and the most that it took.
//!
//! What is taken was measured (largest resident memory of a run) on grids of 28 thousand to 6 million tetrahedra and follows
//! from the arrays that stand at the same time; `tests/program/memory.rs` holds the two against each other.

mod process;

pub use process::{address_space, available, forget_peak, peak};

use voltet_core::grid::{Cells, code};

/// A point: its position and one scalar.
const POINT_BYTES: u64 = 32;
/// A tetrahedron: the numbers of its four points.
const TETRAHEDRON_BYTES: u64 = 16;
/// The number of the cell that it is a part of.
const SOURCE_BYTES: u64 = 4;
/// While overlapping cells are looked for: where the cells of a point begin, and how many there are; each cell twice.
const POINT_LOOKED_AT_BYTES: u64 = 12;
const TETRAHEDRON_LOOKED_AT_BYTES: u64 = 8;

/// The size of a grid.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct GridSize {
    /// Its points.
    pub points: u64,
    /// Its tetrahedra.
    pub tetrahedra: u64,
    /// Bytes of the cells as they stand in the file, where they are split into tetrahedra.
    pub split: Option<u64>,
}

/// About how many tetrahedra a cell becomes.
fn tetrahedra_of(cell: u8) -> u64 {
    match cell {
        0..=9 | 21..=23 => 0,
        code::TETRA => 1,
        code::PYRAMID => 2,
        code::WEDGE => 3,
        code::QUADRATIC_TETRA => 8,
        code::QUADRATIC_HEXAHEDRON..=code::TRIQUADRATIC_PYRAMID => 32,
        _ => 6,
    }
}

impl GridSize {
    /// Adds the cells of a file, or of a piece of it.
    pub fn add(&mut self, cells: &Cells) {
        let (tetrahedra, bytes) = match cells {
            Cells::Tetrahedra(own) => (own.len() as u64, None),
            Cells::Mixed(set) => {
                let bytes = size_of_val(&set.connectivity[..])
                    + size_of_val(&set.offsets[..])
                    + size_of_val(&set.types[..]);
                (set.types.iter().map(|&cell| tetrahedra_of(cell)).sum(), Some(bytes as u64))
            }
            Cells::Structured(_) => (6 * cells.count() as u64, Some(0)),
        };
        self.tetrahedra = self.tetrahedra.saturating_add(tetrahedra);
        self.split = match (self.split, bytes) {
            (None, None) => None,
            (a, b) => Some(a.unwrap_or(0).saturating_add(b.unwrap_or(0))),
        };
    }

    /// The grid in memory.
    pub fn bytes(&self) -> u64 {
        let tetrahedron = TETRAHEDRON_BYTES + if self.split.is_some() { SOURCE_BYTES } else { 0 };
        (self.points.saturating_mul(POINT_BYTES)).saturating_add(self.tetrahedra.saturating_mul(tetrahedron))
    }

    /// Bytes that reading takes beside the program itself: the grid, and the cells that it is made from or, after these, the
    /// look for cells that overlap.
    pub fn reading_bytes(&self) -> u64 {
        let looking = self.points.saturating_mul(POINT_LOOKED_AT_BYTES);
        let looking = looking.saturating_add(self.tetrahedra.saturating_mul(TETRAHEDRON_LOOKED_AT_BYTES));
        self.bytes().saturating_add(looking.max(self.split.unwrap_or(0)))
    }
}
