//! Grids: points, cells as a file gives them, and the tetrahedra that are drawn.

mod adjacency;
mod build;
mod carve;
mod cell_types;
mod cell_values;
mod curved;
pub mod extent;
mod faces;
pub mod generate;
mod overlap;
mod parts;
mod pieces;
mod polygon;
mod polyhedra;
mod source;
mod split;
mod tetrahedra;

pub use adjacency::{Csr, Neighbours, cells_of_faces, cells_of_points, points_of_points, sum_over_cells};
pub use build::build;
pub use cell_types::{CellType, code, describe_counts};
pub use parts::{
    Array, Association, CellSet, CellValues, Cells, FileCells, ImportStats, Options, Polyhedron, RawGrid,
    Scalar, is_drawn, structured_corners,
};
pub use pieces::{check_cells, into_set, join};
pub use tetrahedra::{GhostCells, Grid, tetrahedron_volume};

#[cfg(test)]
mod tests;
