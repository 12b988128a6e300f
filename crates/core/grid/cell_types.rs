//! VTK's cell types: codes, names, numbers of points (VTK's `vtkCellType.h`).

use crate::noun_of;

/// VTK type codes of the three-dimensional cells that can be drawn, and of a few that a file may hold besides.
#[allow(missing_docs)]
pub mod code {
    pub const TETRA: u8 = 10;
    pub const VOXEL: u8 = 11;
    pub const HEXAHEDRON: u8 = 12;
    pub const WEDGE: u8 = 13;
    pub const PYRAMID: u8 = 14;
    pub const PENTAGONAL_PRISM: u8 = 15;
    pub const HEXAGONAL_PRISM: u8 = 16;
    pub const QUADRATIC_TETRA: u8 = 24;
    pub const QUADRATIC_HEXAHEDRON: u8 = 25;
    pub const QUADRATIC_WEDGE: u8 = 26;
    pub const QUADRATIC_PYRAMID: u8 = 27;
    pub const TRIQUADRATIC_HEXAHEDRON: u8 = 29;
    pub const QUADRATIC_LINEAR_WEDGE: u8 = 31;
    pub const BIQUADRATIC_QUADRATIC_WEDGE: u8 = 32;
    pub const BIQUADRATIC_QUADRATIC_HEXAHEDRON: u8 = 33;
    pub const TRIQUADRATIC_PYRAMID: u8 = 37;
    pub const CONVEX_POINT_SET: u8 = 41;
    pub const POLYHEDRON: u8 = 42;
    pub const LAGRANGE_TETRAHEDRON: u8 = 71;
    pub const LAGRANGE_HEXAHEDRON: u8 = 72;
    pub const LAGRANGE_WEDGE: u8 = 73;
    pub const LAGRANGE_PYRAMID: u8 = 74;
    pub const BEZIER_TETRAHEDRON: u8 = 78;
    pub const BEZIER_HEXAHEDRON: u8 = 79;
    pub const BEZIER_WEDGE: u8 = 80;
    pub const BEZIER_PYRAMID: u8 = 81;
}

/// VTK cell type: code, name, dimension, corner count.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CellType {
    /// VTK's type code.
    pub code: u8,
    /// A name for messages, in the singular.
    pub name: &'static str,
    /// Dimension of the cell: 0 … 3.
    pub dimension: u8,
    /// Number of points where the type fixes it.
    pub point_count: Option<u8>,
}

const fn cell_type(code: u8, name: &'static str, dimension: u8, point_count: u8) -> CellType {
    CellType { code, name, dimension, point_count: if point_count == 0 { None } else { Some(point_count) } }
}

/// Every cell type of VTK, by ascending code; a point count of 0 stands for "any".
const CELL_TYPES: &[CellType] = &[
    cell_type(0, "empty cell", 0, 0),
    cell_type(1, "vertex", 0, 1),
    cell_type(2, "poly-vertex", 0, 0),
    cell_type(3, "line", 1, 2),
    cell_type(4, "poly-line", 1, 0),
    cell_type(5, "triangle", 2, 3),
    cell_type(6, "triangle strip", 2, 0),
    cell_type(7, "polygon", 2, 0),
    cell_type(8, "pixel", 2, 4),
    cell_type(9, "quad", 2, 4),
    cell_type(code::TETRA, "tetrahedron", 3, 4),
    cell_type(code::VOXEL, "voxel", 3, 8),
    cell_type(code::HEXAHEDRON, "hexahedron", 3, 8),
    cell_type(code::WEDGE, "wedge", 3, 6),
    cell_type(code::PYRAMID, "pyramid", 3, 5),
    cell_type(code::PENTAGONAL_PRISM, "pentagonal prism", 3, 10),
    cell_type(code::HEXAGONAL_PRISM, "hexagonal prism", 3, 12),
    cell_type(21, "quadratic edge", 1, 3),
    cell_type(22, "quadratic triangle", 2, 6),
    cell_type(23, "quadratic quad", 2, 8),
    cell_type(code::QUADRATIC_TETRA, "quadratic tetrahedron", 3, 10),
    cell_type(code::QUADRATIC_HEXAHEDRON, "quadratic hexahedron", 3, 20),
    cell_type(code::QUADRATIC_WEDGE, "quadratic wedge", 3, 15),
    cell_type(code::QUADRATIC_PYRAMID, "quadratic pyramid", 3, 13),
    cell_type(28, "biquadratic quad", 2, 9),
    cell_type(code::TRIQUADRATIC_HEXAHEDRON, "triquadratic hexahedron", 3, 27),
    cell_type(30, "quadratic-linear quad", 2, 6),
    cell_type(code::QUADRATIC_LINEAR_WEDGE, "quadratic-linear wedge", 3, 12),
    cell_type(code::BIQUADRATIC_QUADRATIC_WEDGE, "biquadratic-quadratic wedge", 3, 18),
    cell_type(code::BIQUADRATIC_QUADRATIC_HEXAHEDRON, "biquadratic-quadratic hexahedron", 3, 24),
    cell_type(34, "biquadratic triangle", 2, 7),
    cell_type(35, "cubic line", 1, 4),
    cell_type(36, "quadratic polygon", 2, 0),
    cell_type(code::TRIQUADRATIC_PYRAMID, "triquadratic pyramid", 3, 19),
    cell_type(code::CONVEX_POINT_SET, "convex point set", 3, 0),
    cell_type(code::POLYHEDRON, "polyhedron", 3, 0),
    cell_type(51, "parametric curve", 1, 0),
    cell_type(52, "parametric surface", 2, 0),
    cell_type(53, "parametric triangle surface", 2, 0),
    cell_type(54, "parametric quad surface", 2, 0),
    cell_type(55, "parametric tetrahedral region", 3, 0),
    cell_type(56, "parametric hexahedral region", 3, 0),
    cell_type(60, "higher-order edge", 1, 0),
    cell_type(61, "higher-order triangle", 2, 0),
    cell_type(62, "higher-order quad", 2, 0),
    cell_type(63, "higher-order polygon", 2, 0),
    cell_type(64, "higher-order tetrahedron", 3, 0),
    cell_type(65, "higher-order wedge", 3, 0),
    cell_type(66, "higher-order pyramid", 3, 0),
    cell_type(67, "higher-order hexahedron", 3, 0),
    cell_type(68, "Lagrange curve", 1, 0),
    cell_type(69, "Lagrange triangle", 2, 0),
    cell_type(70, "Lagrange quadrilateral", 2, 0),
    cell_type(code::LAGRANGE_TETRAHEDRON, "Lagrange tetrahedron", 3, 0),
    cell_type(code::LAGRANGE_HEXAHEDRON, "Lagrange hexahedron", 3, 0),
    cell_type(code::LAGRANGE_WEDGE, "Lagrange wedge", 3, 0),
    cell_type(code::LAGRANGE_PYRAMID, "Lagrange pyramid", 3, 0),
    cell_type(75, "Bezier curve", 1, 0),
    cell_type(76, "Bezier triangle", 2, 0),
    cell_type(77, "Bezier quadrilateral", 2, 0),
    cell_type(code::BEZIER_TETRAHEDRON, "Bezier tetrahedron", 3, 0),
    cell_type(code::BEZIER_HEXAHEDRON, "Bezier hexahedron", 3, 0),
    cell_type(code::BEZIER_WEDGE, "Bezier wedge", 3, 0),
    cell_type(code::BEZIER_PYRAMID, "Bezier pyramid", 3, 0),
];

impl CellType {
    /// The type with this code; `None` where VTK knows none.
    pub fn from_code(code: u8) -> Option<&'static CellType> {
        CELL_TYPES.binary_search_by_key(&code, |t| t.code).ok().map(|i| &CELL_TYPES[i])
    }

    /// Name of the type with this code in the number of a count: "hexahedra", "wedge", "cells of unknown type (99)".
    pub fn name_of(code: u8, count: u64) -> String {
        match CellType::from_code(code) {
            Some(known) => noun_of(&count, known.name),
            None => format!("{} of unknown type ({code})", noun_of(&count, "cell")),
        }
    }
}

/// Counts by type code as a list for messages: "54 tetrahedra, 9 voxels".
pub fn describe_counts<'a>(counts: impl IntoIterator<Item = (&'a u8, &'a u64)>) -> String {
    let parts: Vec<String> = counts
        .into_iter()
        .map(|(&code, &count)| format!("{count} {}", CellType::name_of(code, count)))
        .collect();
    if parts.is_empty() { "no cells".into() } else { parts.join(", ") }
}
