//! VTK's cell types: codes, names, numbers of points (VTK's `vtkCellType.h`).

use crate::noun_of;

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

/// Makes the table of the types, and of those that have a name in code its constant.
macro_rules! cell_types {
    ($($code:literal $($constant:ident)? $name:literal $dimension:literal $point_count:literal)*) => {
        /// VTK type codes of the three-dimensional cells that can be drawn, and of a few that a file may hold besides.
        #[allow(missing_docs)]
        pub mod code {
            $($(pub const $constant: u8 = $code;)?)*
        }

        const CELL_TYPES: &[CellType] = &[$(cell_type($code, $name, $dimension, $point_count)),*];
    };
}

// Every cell type of VTK, by ascending code: name, dimension, number of points, of which 0 stands for "any".
cell_types! {
    0 "empty cell" 0 0
    1 "vertex" 0 1
    2 "poly-vertex" 0 0
    3 "line" 1 2
    4 "poly-line" 1 0
    5 "triangle" 2 3
    6 "triangle strip" 2 0
    7 "polygon" 2 0
    8 "pixel" 2 4
    9 "quad" 2 4
    10 TETRA "tetrahedron" 3 4
    11 VOXEL "voxel" 3 8
    12 HEXAHEDRON "hexahedron" 3 8
    13 WEDGE "wedge" 3 6
    14 PYRAMID "pyramid" 3 5
    15 PENTAGONAL_PRISM "pentagonal prism" 3 10
    16 HEXAGONAL_PRISM "hexagonal prism" 3 12
    21 "quadratic edge" 1 3
    22 "quadratic triangle" 2 6
    23 "quadratic quad" 2 8
    24 QUADRATIC_TETRA "quadratic tetrahedron" 3 10
    25 QUADRATIC_HEXAHEDRON "quadratic hexahedron" 3 20
    26 QUADRATIC_WEDGE "quadratic wedge" 3 15
    27 QUADRATIC_PYRAMID "quadratic pyramid" 3 13
    28 "biquadratic quad" 2 9
    29 TRIQUADRATIC_HEXAHEDRON "triquadratic hexahedron" 3 27
    30 "quadratic-linear quad" 2 6
    31 QUADRATIC_LINEAR_WEDGE "quadratic-linear wedge" 3 12
    32 BIQUADRATIC_QUADRATIC_WEDGE "biquadratic-quadratic wedge" 3 18
    33 BIQUADRATIC_QUADRATIC_HEXAHEDRON "biquadratic-quadratic hexahedron" 3 24
    34 "biquadratic triangle" 2 7
    35 "cubic line" 1 4
    36 "quadratic polygon" 2 0
    37 TRIQUADRATIC_PYRAMID "triquadratic pyramid" 3 19
    41 CONVEX_POINT_SET "convex point set" 3 0
    42 POLYHEDRON "polyhedron" 3 0
    51 "parametric curve" 1 0
    52 "parametric surface" 2 0
    53 "parametric triangle surface" 2 0
    54 "parametric quad surface" 2 0
    55 "parametric tetrahedral region" 3 0
    56 "parametric hexahedral region" 3 0
    60 "higher-order edge" 1 0
    61 "higher-order triangle" 2 0
    62 "higher-order quad" 2 0
    63 "higher-order polygon" 2 0
    64 "higher-order tetrahedron" 3 0
    65 "higher-order wedge" 3 0
    66 "higher-order pyramid" 3 0
    67 "higher-order hexahedron" 3 0
    68 "Lagrange curve" 1 0
    69 "Lagrange triangle" 2 0
    70 "Lagrange quadrilateral" 2 0
    71 LAGRANGE_TETRAHEDRON "Lagrange tetrahedron" 3 0
    72 LAGRANGE_HEXAHEDRON "Lagrange hexahedron" 3 0
    73 LAGRANGE_WEDGE "Lagrange wedge" 3 0
    74 LAGRANGE_PYRAMID "Lagrange pyramid" 3 0
    75 "Bezier curve" 1 0
    76 "Bezier triangle" 2 0
    77 "Bezier quadrilateral" 2 0
    78 BEZIER_TETRAHEDRON "Bezier tetrahedron" 3 0
    79 BEZIER_HEXAHEDRON "Bezier hexahedron" 3 0
    80 BEZIER_WEDGE "Bezier wedge" 3 0
    81 BEZIER_PYRAMID "Bezier pyramid" 3 0
}

/// Places in [`CELL_TYPES`] by code, beyond the end for a code without a type: readers look up every cell.
static PLACES: [u8; 256] = {
    let mut places = [u8::MAX; 256];
    let mut place = 0;
    while place < CELL_TYPES.len() {
        places[CELL_TYPES[place].code as usize] = place as u8;
        place += 1;
    }
    places
};

impl CellType {
    /// The type with this code; `None` where VTK knows none.
    pub fn from_code(code: u8) -> Option<&'static CellType> {
        CELL_TYPES.get(usize::from(PLACES[usize::from(code)]))
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
