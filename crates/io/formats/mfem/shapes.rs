//! Elements of MFEM: their vertices, edges and faces, and the order of their nodes in VTK's terms.
//!
//! Source: MFEM's documentation, "Mesh Formats" (geometry types), and the reference elements of `fem/geom.hpp`. MFEM numbers the vertices of
//! an element as VTK does, and other nodes in the order edges, faces, middle.

use voltet_core::grid::code;

pub(super) struct MfemShape {
    pub dimension: u64,
    pub vertex_count: usize,
    /// Types of VTK for nodes of the first and of the second order.
    pub codes: [u8; 2],
    /// Vertices of the edges; none where the element is one itself.
    pub edges: &'static [[u8; 2]],
    /// Vertices of the faces; none where the element is one itself.
    pub faces: &'static [&'static [u8]],
    /// True if a node of the second order is in its own middle.
    pub has_middle: bool,
    /// For each node of the second order in VTK's order its place among vertices, edges, faces of four vertices, middle.
    pub order: &'static [u8],
}

/// Numbers of types among [`SHAPES`].
pub(super) const TETRAHEDRON: usize = 4;
pub(super) const CUBE: usize = 5;
pub(super) const PRISM: usize = 6;
pub(super) const PYRAMID: usize = 7;

/// The types by their numbers. VTK's pyramid has no node in the middle of its base.
pub(super) const SHAPES: [MfemShape; 8] = [
    MfemShape {
        dimension: 0,
        vertex_count: 1,
        codes: [1, 1],
        edges: &[],
        faces: &[],
        has_middle: false,
        order: &[0],
    },
    MfemShape {
        dimension: 1,
        vertex_count: 2,
        codes: [3, 21],
        edges: &[],
        faces: &[],
        has_middle: true,
        order: &[0, 1, 2],
    },
    MfemShape {
        dimension: 2,
        vertex_count: 3,
        codes: [5, 22],
        edges: &[[0, 1], [1, 2], [2, 0]],
        faces: &[],
        has_middle: false,
        order: &[0, 1, 2, 3, 4, 5],
    },
    MfemShape {
        dimension: 2,
        vertex_count: 4,
        codes: [9, 28],
        edges: &[[0, 1], [1, 2], [2, 3], [3, 0]],
        faces: &[],
        has_middle: true,
        order: &[0, 1, 2, 3, 4, 5, 6, 7, 8],
    },
    MfemShape {
        dimension: 3,
        vertex_count: 4,
        codes: [code::TETRA, code::QUADRATIC_TETRA],
        edges: &[[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]],
        faces: &[&[1, 2, 3], &[0, 3, 2], &[0, 1, 3], &[0, 2, 1]],
        has_middle: false,
        order: &[0, 1, 2, 3, 4, 7, 5, 6, 8, 9],
    },
    MfemShape {
        dimension: 3,
        vertex_count: 8,
        codes: [code::HEXAHEDRON, code::TRIQUADRATIC_HEXAHEDRON],
        edges: &[
            [0, 1],
            [1, 2],
            [3, 2],
            [0, 3],
            [4, 5],
            [5, 6],
            [7, 6],
            [4, 7],
            [0, 4],
            [1, 5],
            [2, 6],
            [3, 7],
        ],
        faces: &[&[3, 2, 1, 0], &[0, 1, 5, 4], &[1, 2, 6, 5], &[2, 3, 7, 6], &[3, 0, 4, 7], &[4, 5, 6, 7]],
        has_middle: true,
        order: &[
            0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19, 24, 22, 21, 23, 20, 25, 26,
        ],
    },
    MfemShape {
        dimension: 3,
        vertex_count: 6,
        codes: [code::WEDGE, code::BIQUADRATIC_QUADRATIC_WEDGE],
        edges: &[[0, 1], [1, 2], [2, 0], [3, 4], [4, 5], [5, 3], [0, 3], [1, 4], [2, 5]],
        faces: &[&[0, 2, 1], &[3, 4, 5], &[0, 1, 4, 3], &[1, 2, 5, 4], &[2, 0, 3, 5]],
        has_middle: false,
        order: &[0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17],
    },
    MfemShape {
        dimension: 3,
        vertex_count: 5,
        codes: [code::PYRAMID, code::QUADRATIC_PYRAMID],
        edges: &[[0, 1], [1, 2], [3, 2], [0, 3], [0, 4], [1, 4], [2, 4], [3, 4]],
        faces: &[&[3, 2, 1, 0], &[0, 1, 4], &[1, 2, 4], &[2, 3, 4], &[3, 0, 4]],
        has_middle: false,
        order: &[0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12],
    },
];
