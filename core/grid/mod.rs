//! Grids: points, cells as a file gives them, and the tetrahedra that are drawn.

mod cells;

pub use cells::{CellSet, Polyhedron};
use glam::DVec3;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Values of one array, one tuple a point (or cell), components of a tuple side by side.
#[derive(Debug, Clone, PartialEq)]
pub struct Array {
    /// Components of a tuple, at least 1.
    pub component_count: usize,
    /// `tuples × component_count` values.
    pub values: Vec<f64>,
}

/// A grid of tetrahedra. Immutable once made; nodes share it.
#[derive(Debug, Clone, Default)]
pub struct Grid {
    /// Point positions, world units.
    pub points: Arc<Vec<DVec3>>,
    /// Four point numbers a cell, **ascending** (orientation carries no meaning for a volume picture, and a
    /// canonical order makes neighbours treat a shared face alike).
    pub tetrahedra: Arc<Vec<[u32; 4]>>,
    /// For each tetrahedron the cell of the file it is a part of; `None`: tetrahedron i is cell i.
    pub source_cells: Option<Arc<Vec<u32>>>,
    /// The scalar that the reader was asked for, per point.
    pub scalar: Option<Arc<Vec<f64>>>,
    /// Its name as the user wrote it (`momentum:magnitude`).
    pub scalar_name: String,
    /// Further point arrays that somebody asked for (fields of gaussian-nd widgets, a solver's own gradient).
    pub point_arrays: BTreeMap<String, Arc<Array>>,
    /// What the reader counted and left out.
    pub origin: Arc<Origin>,
}

/// What a grid was made from: counts for `info` and the report.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Origin {
    /// Cells of the file by VTK type code.
    pub cells_by_type: BTreeMap<u8, u64>,
    /// Three-dimensional cells left out because a position or the scalar is not finite.
    pub cells_not_finite: u64,
    /// Ghost cells left out.
    pub cells_ghost: u64,
    /// Cells that are not three-dimensional (vertices, lines, triangles, …), which a volume picture ignores.
    pub cells_not_volume: u64,
    /// Arrays of the file that nobody asked for and that were not decoded.
    pub arrays_unread: Vec<String>,
    /// Warnings for the user, each a sentence.
    pub warnings: Vec<String>,
}
