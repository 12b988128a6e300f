//! Grids: points, cells as a file gives them, and the tetrahedra that are drawn.

mod adjacency;
mod array;
mod build;
mod cell_types;
mod cell_values;
mod cells;
mod clean;
mod curved;
pub mod extent;
pub(crate) mod faces;
mod file_cells;
pub mod generate;
pub(crate) mod overlap;
mod parts;
mod polyhedron;
mod refine;
mod source;
mod split;
mod tally;
mod tetrahedra;
mod within;

pub use adjacency::{Csr, Neighbours, cells_of_faces, cells_of_points, points_of_points, sum_over_cells};
pub use array::Array;
pub use build::build;
pub use cell_types::{CellType, code, describe_counts};
pub use cells::{CellSet, Polyhedron};
pub use file_cells::FileCells;
pub use parts::{Association, CellValues, Cells, Options, RawGrid, Scalar};
pub use refine::{RefinedGrid, refine};
pub use tetrahedra::{Grid, ImportStats, tetrahedron_volume};

#[cfg(test)]
mod tests;
