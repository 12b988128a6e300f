//! Grids: points, cells as a file gives them, the tetrahedra that are drawn, and surfaces of them: contours and the boundary.

mod adjacency;
mod boundary;
mod build;
mod carve;
mod cell_edges;
mod cell_set;
mod cell_types;
mod cell_values;
mod contour;
mod curved;
pub mod extent;
mod faces;
mod feature_edges;
pub mod generate;
mod grid_surface;
mod halo;
mod overlap;
mod parts;
mod pieces;
mod point_keys;
mod polygon;
mod polyhedra;
mod shared_points;
mod source;
mod split;
mod subset;
mod tetrahedra;
mod unsplit;

pub use adjacency::{
    Csr, Neighbours, cells_of_faces, cells_of_points, points_of_points, second_rings, sum_over_cells,
};
pub use boundary::boundary;
pub use build::{build, build_part};
pub use cell_edges::{BoundaryEdges, boundary_edges};
pub use cell_set::{CellSet, Polyhedron};
pub use cell_types::{CellType, code, describe_counts};
pub use cell_values::add_from_cells;
pub use contour::contour;
pub use curved::is_curved;
pub use feature_edges::{SharpTriangles, feature_edges, sharp_triangles};
pub use grid_surface::{EdgePoint, GridSurface, point_normals};
pub use halo::{Halo, join_part};
pub use parts::{
    Array, Association, BoundaryValues, CellValues, Cells, FileCells, HangingPoint, ImportStats, Options,
    RawGrid, Scalar, is_drawn, structured_corners,
};
pub use pieces::{check_cells, into_set, join, join_by};
pub use point_keys::{Exchange, PointKeys, boxes_of_others};
pub use polygon::triangles_of_polygon;
pub use shared_points::SharedPoints;
pub use subset::{Subset, cells_above, cells_by_points, whole_cells};
pub use tetrahedra::{GhostCells, Grid, tetrahedron_volume};

#[cfg(test)]
mod tests;
