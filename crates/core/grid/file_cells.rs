//! The cells of a file as they are, beside the tetrahedra made of them: kept to write results back on the user's own cells.

use super::parts::Cells;
use crate::SharedSlice;
use glam::DVec3;

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
    /// One flag a cell: true for ghosts and blanked cells.
    pub ghost: Option<Vec<bool>>,
    /// Degrees along the three axes of every cell, where the file gives them.
    pub degrees: Option<Vec<[u8; 3]>>,
}

impl FileCells {
    /// The number in the grid of a point of the file; `None` where no tetrahedron uses it.
    pub fn grid_point(&self, point: usize) -> Option<usize> {
        match &self.numbers {
            None => Some(point),
            Some(numbers) => numbers.get(point).filter(|&&number| number != UNUSED).map(|&n| n as usize),
        }
    }
}
