//! Cells as a file gives them: VTK types and connectivity.

/// Cells of a file, in VTK's terms.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CellSet {
    /// VTK cell type code of every cell.
    pub types: Vec<u8>,
    /// `offsets[i] .. offsets[i + 1]` is cell i's part of `connectivity`; `types.len() + 1` entries.
    pub offsets: Vec<u64>,
    /// Point numbers, in VTK's vertex order.
    pub connectivity: Vec<u32>,
    /// Faces of the polyhedra (type 42); empty where there are none.
    pub polyhedra: Vec<Polyhedron>,
}

/// The faces of one polyhedral cell.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Polyhedron {
    /// Number of the cell.
    pub cell: u32,
    /// Each face a closed loop of point numbers.
    pub faces: Vec<Vec<u32>>,
}

/// One cell.
pub(super) struct Cell<'a> {
    /// Number in the file.
    pub number: usize,
    /// VTK type code.
    pub code: u8,
    /// Its points.
    pub corners: &'a [u32],
}
