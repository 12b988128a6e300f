//! Regular lattices on the reference tetrahedron, hexahedron, wedge and pyramid, and the linear cells between their
//! points.
//!
//! A lattice of order m has m pieces along an edge. Its points are (i, j, k):
//! - tetrahedron: i + j + k ≤ m; corners 0 … 3 at the origin, (m, 0, 0), (0, m, 0), (0, 0, m);
//! - hexahedron: i ≤ m₀, j ≤ m₁, k ≤ m₂; corners in VTK's order;
//! - wedge: i + j ≤ m₀, k ≤ m₂; corners 0 … 2 of the triangle at k = 0, then those at k = m₂;
//! - pyramid: layers k ≤ m of (m − k + 1)² points; corners 0 … 3 of the base in VTK's order, apex 4 at k = m.
//!
//! [`nodes`] places the nodes of VTK's curved cells on the lattice of the cell's own order (VTK's classes of the same names; the
//! Lagrange and Bezier orders are those of vtkHigherOrderHexahedron, …Tetra and …Wedge).

use crate::grid::cell_types::{CellType, code};
use crate::grid::split;

#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) enum ReferenceCell {
    Tetrahedron,
    Hexahedron,
    Wedge,
    Pyramid,
}

/// Orders along the three axes; equal where the shape ties them together.
pub(super) type Orders = [usize; 3];

/// A linear cell between points of a lattice, by their positions in [`points`].
#[derive(Debug, Clone, PartialEq)]
pub(super) enum LatticeCell {
    Tetrahedron([usize; 4]),
    /// Six corners of which i and i + 3 are opposite.
    Octahedron([usize; 6]),
    Pyramid([usize; 5]),
    Wedge([usize; 6]),
    /// In the order of a voxel.
    Hexahedron([usize; 8]),
}

/// Faces of an octahedron whose corners i and i + 3 are opposite.
const OCTAHEDRON_FACES: &[&[usize]] =
    &[&[0, 1, 2], &[0, 1, 5], &[0, 4, 2], &[0, 4, 5], &[3, 1, 2], &[3, 1, 5], &[3, 4, 2], &[3, 4, 5]];

impl LatticeCell {
    /// Hands out the tetrahedra of the piece; `number` gives the point number of a lattice point.
    pub fn tetrahedra(&self, number: impl Fn(usize) -> u32, emit: &mut impl FnMut([u32; 4])) {
        match self {
            LatticeCell::Tetrahedron(v) => split::emit_distinct(v.map(number), emit),
            LatticeCell::Octahedron(v) => split::star(&v.map(number), OCTAHEDRON_FACES, emit),
            LatticeCell::Pyramid(v) => split::star(&v.map(number), split::PYRAMID_FACES, emit),
            LatticeCell::Wedge(v) => split::star(&v.map(number), split::WEDGE_FACES, emit),
            LatticeCell::Hexahedron(v) => split::hexahedron(&v.map(number), emit),
        }
    }
}

/// All lattice points, i fastest.
pub(super) fn points(shape: ReferenceCell, m: Orders) -> Vec<[usize; 3]> {
    let mut out = Vec::new();
    for k in 0..=m[2] {
        let (rows, columns) = match shape {
            ReferenceCell::Tetrahedron | ReferenceCell::Pyramid => (m[1] - k, m[0] - k),
            ReferenceCell::Hexahedron | ReferenceCell::Wedge => (m[1], m[0]),
        };
        for j in 0..=rows {
            let last = match shape {
                ReferenceCell::Tetrahedron | ReferenceCell::Wedge => columns - j,
                ReferenceCell::Hexahedron | ReferenceCell::Pyramid => columns,
            };
            out.extend((0..=last).map(|i| [i, j, k]));
        }
    }
    out
}

/// The point as a combination of the corners with whole weights (linear along edges, bilinear on quadrilaterals),
/// up to a common factor. On an edge or face only its own corners have weight, so neighbours see the same.
pub(super) fn corner_weights(shape: ReferenceCell, m: Orders, [i, j, k]: [usize; 3]) -> Vec<(usize, u64)> {
    let weights: Vec<usize> = match shape {
        ReferenceCell::Tetrahedron => vec![m[0] - i - j - k, i, j, k],
        ReferenceCell::Hexahedron => {
            [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]
                .iter()
                .map(|c| {
                    [i, j, k]
                        .iter()
                        .zip(m)
                        .zip(c)
                        .map(|((&x, m), &c)| if c == 1 { x } else { m - x })
                        .product()
                })
                .collect()
        }
        ReferenceCell::Wedge => {
            let triangle = [m[0] - i - j, i, j];
            triangle.iter().map(|w| w * (m[2] - k)).chain(triangle.iter().map(|w| w * k)).collect()
        }
        ReferenceCell::Pyramid if k == m[2] => vec![0, 0, 0, 0, 1],
        ReferenceCell::Pyramid => {
            let n = m[0] - k;
            vec![(n - i) * (n - j), i * (n - j), i * j, (n - i) * j, k * n]
        }
    };
    weights.into_iter().enumerate().filter(|&(_, w)| w > 0).map(|(c, w)| (c, w as u64)).collect()
}

/// True if a point with these corner weights lies on the surface of the cell.
pub(super) fn on_surface(shape: ReferenceCell, corner_weights: &[(usize, u64)]) -> bool {
    corner_weights.len() < 4 || (corner_weights.len() == 4 && shape != ReferenceCell::Tetrahedron)
}

/// The linear cells between the points of a lattice.
pub(super) fn pieces(shape: ReferenceCell, m: Orders) -> Vec<LatticeCell> {
    let all = points(shape, m);
    let at = |p: [usize; 3]| {
        all.binary_search_by_key(&[p[2], p[1], p[0]], |q| [q[2], q[1], q[0]])
            .expect("a piece lies between points of its lattice")
    };
    let mut out = Vec::new();
    for &[i, j, k] in &all {
        let o = |a: usize, b: usize, c: usize| at([i + a, j + b, k + c]);
        match shape {
            ReferenceCell::Hexahedron => {
                if i < m[0] && j < m[1] && k < m[2] {
                    out.push(LatticeCell::Hexahedron(std::array::from_fn(|c| o(c & 1, c >> 1 & 1, c >> 2))));
                }
            }
            ReferenceCell::Tetrahedron => {
                let rest = m[0] - i - j - k;
                if rest >= 1 {
                    out.push(LatticeCell::Tetrahedron([o(0, 0, 0), o(1, 0, 0), o(0, 1, 0), o(0, 0, 1)]));
                }
                if rest >= 2 {
                    let corners = [o(1, 0, 0), o(0, 1, 0), o(0, 0, 1), o(0, 1, 1), o(1, 0, 1), o(1, 1, 0)];
                    out.push(LatticeCell::Octahedron(corners));
                }
                if rest >= 3 {
                    out.push(LatticeCell::Tetrahedron([o(1, 1, 0), o(1, 0, 1), o(0, 1, 1), o(1, 1, 1)]));
                }
            }
            ReferenceCell::Wedge => {
                let rest = m[0] - i - j;
                for up in [[[0, 0], [1, 0], [0, 1]], [[1, 1], [0, 1], [1, 0]]].iter().take(rest.min(2)) {
                    if k < m[2] {
                        out.push(LatticeCell::Wedge(std::array::from_fn(|c| {
                            o(up[c % 3][0], up[c % 3][1], c / 3)
                        })));
                    }
                }
            }
            ReferenceCell::Pyramid => {
                let n = m[0] - k;
                if i < n && j < n {
                    let base = [o(0, 0, 0), o(1, 0, 0), o(1, 1, 0), o(0, 1, 0)];
                    out.push(LatticeCell::Pyramid([base[0], base[1], base[2], base[3], o(0, 0, 1)]));
                }
                if n < 2 {
                    continue;
                }
                // Between this layer and the next, from the next layer's point (i, j, k + 1).
                if i < n - 1 && j < n - 1 {
                    let base = [o(0, 0, 1), o(1, 0, 1), o(1, 1, 1), o(0, 1, 1)];
                    out.push(LatticeCell::Pyramid([base[0], base[1], base[2], base[3], o(1, 1, 0)]));
                }
                if i < n - 1 && j < n {
                    out.push(LatticeCell::Tetrahedron([o(1, 0, 0), o(1, 1, 0), o(0, 0, 1), o(1, 0, 1)]));
                }
                if i < n && j < n - 1 {
                    out.push(LatticeCell::Tetrahedron([o(0, 1, 0), o(1, 1, 0), o(0, 0, 1), o(0, 1, 1)]));
                }
            }
        }
    }
    out
}

#[derive(Debug, Clone, PartialEq)]
pub(super) struct Nodes {
    pub shape: ReferenceCell,
    /// The cell's own order along each axis.
    pub orders: Orders,
    /// Lattice position of every node, in VTK's order.
    pub positions: Vec<[usize; 3]>,
    /// Nodes other than corners are control points of Bernstein polynomials rather than points of the cell.
    pub bezier: bool,
}

/// Shape and, where the type fixes them, orders of the curved cells whose nodes lie on a lattice.
const CURVED: [(u8, ReferenceCell, Option<Orders>); 14] = [
    (code::QUADRATIC_TETRA, ReferenceCell::Tetrahedron, Some([2; 3])),
    (code::QUADRATIC_HEXAHEDRON, ReferenceCell::Hexahedron, Some([2; 3])),
    (code::BIQUADRATIC_QUADRATIC_HEXAHEDRON, ReferenceCell::Hexahedron, Some([2; 3])),
    (code::TRIQUADRATIC_HEXAHEDRON, ReferenceCell::Hexahedron, Some([2; 3])),
    (code::QUADRATIC_WEDGE, ReferenceCell::Wedge, Some([2; 3])),
    (code::BIQUADRATIC_QUADRATIC_WEDGE, ReferenceCell::Wedge, Some([2; 3])),
    (code::QUADRATIC_LINEAR_WEDGE, ReferenceCell::Wedge, Some([2, 2, 1])),
    (code::QUADRATIC_PYRAMID, ReferenceCell::Pyramid, Some([2; 3])),
    (code::LAGRANGE_TETRAHEDRON, ReferenceCell::Tetrahedron, None),
    (code::LAGRANGE_HEXAHEDRON, ReferenceCell::Hexahedron, None),
    (code::LAGRANGE_WEDGE, ReferenceCell::Wedge, None),
    (code::BEZIER_TETRAHEDRON, ReferenceCell::Tetrahedron, None),
    (code::BEZIER_HEXAHEDRON, ReferenceCell::Hexahedron, None),
    (code::BEZIER_WEDGE, ReferenceCell::Wedge, None),
];

/// True if [`nodes`] has the type.
pub(super) fn is_curved(code: u8) -> bool {
    CURVED.iter().any(|kind| kind.0 == code)
}

/// The nodes of a cell with this type, number of points and (for Lagrange and Bezier cells) degrees; `None` where
/// these do not fit together.
pub(super) fn nodes(code: u8, point_count: usize, degrees: Option<[u8; 3]>) -> Option<Nodes> {
    let &(_, shape, fixed) = CURVED.iter().find(|kind| kind.0 == code)?;
    let orders = fixed.or_else(|| orders(shape, point_count, degrees))?;
    let mut positions = match shape {
        ReferenceCell::Tetrahedron => tetrahedron_positions(orders[0]),
        ReferenceCell::Hexahedron => hexahedron_positions(orders),
        ReferenceCell::Wedge => wedge_positions(orders[0], orders[2]),
        ReferenceCell::Pyramid => pyramid_positions(orders[0]),
    };
    if let Some(count) = CellType::from_code(code)?.point_count {
        // A cell without the centres of its faces or body has the nodes before them, in the order of the Lagrange cell.
        positions.truncate(count.into());
    }
    let bezier = code >= code::BEZIER_TETRAHEDRON;
    (positions.len() == point_count).then_some(Nodes { shape, orders, positions, bezier })
}

/// Highest degree along an axis; VTK itself stops at 10.
const MAX_DEGREE: usize = 16;

/// Orders along the axes, from the degrees if given, else alike along all of them.
fn orders(shape: ReferenceCell, point_count: usize, degrees: Option<[u8; 3]>) -> Option<Orders> {
    let count = |m: Orders| match shape {
        ReferenceCell::Tetrahedron => (m[0] + 1) * (m[0] + 2) * (m[0] + 3) / 6,
        ReferenceCell::Wedge => (m[0] + 1) * (m[0] + 2) / 2 * (m[2] + 1),
        _ => (m[0] + 1) * (m[1] + 1) * (m[2] + 1),
    };
    let given = degrees.map(|d| d.map(usize::from));
    let tied = given.map(|d| match shape {
        ReferenceCell::Hexahedron => d,
        ReferenceCell::Wedge => [d[0], d[0], d[2]],
        _ => [d[0]; 3],
    });
    // Degrees of zero stand for "not given".
    tied.into_iter()
        .chain((1..=MAX_DEGREE).map(|m| [m; 3]))
        .find(|&m| m.iter().all(|n| (1..=MAX_DEGREE).contains(n)) && count(m) == point_count)
}

/// Points strictly between two lattice points, from the first to the second.
fn between(a: [usize; 3], b: [usize; 3], pieces: usize) -> impl Iterator<Item = [usize; 3]> {
    (1..pieces).map(move |t| std::array::from_fn(|axis| (a[axis] * (pieces - t) + b[axis] * t) / pieces))
}

/// Nodes of a Lagrange hexahedron: corners, edges, faces, inside.
fn hexahedron_positions([p, q, r]: Orders) -> Vec<[usize; 3]> {
    let corner = |c: usize| [[0, 0], [p, 0], [p, q], [0, q]].map(|[i, j]| [i, j, c / 4 * r])[c % 4];
    let mut out: Vec<[usize; 3]> = (0..8).map(corner).collect();
    for level in [0, 4] {
        for (a, b, n) in [(0, 1, p), (1, 2, q), (3, 2, p), (0, 3, q)] {
            out.extend(between(corner(level + a), corner(level + b), n));
        }
    }
    for c in 0..4 {
        out.extend(between(corner(c), corner(c + 4), r));
    }
    let (inner_p, inner_q, inner_r) = (1..p, 1..q, 1..r);
    for i in [0, p] {
        out.extend(inner_r.clone().flat_map(|k| inner_q.clone().map(move |j| [i, j, k])));
    }
    for j in [0, q] {
        out.extend(inner_r.clone().flat_map(|k| inner_p.clone().map(move |i| [i, j, k])));
    }
    for k in [0, r] {
        out.extend(inner_q.clone().flat_map(|j| inner_p.clone().map(move |i| [i, j, k])));
    }
    for k in inner_r {
        out.extend(inner_q.clone().flat_map(|j| inner_p.clone().map(move |i| [i, j, k])));
    }
    out
}

/// Nodes of a Lagrange wedge: corners, edges, triangles, quadrilaterals, inside.
fn wedge_positions(p: usize, r: usize) -> Vec<[usize; 3]> {
    let corner = |c: usize| [[0, 0, 0], [p, 0, 0], [0, p, 0]].map(|[i, j, _]| [i, j, c / 3 * r])[c % 3];
    let mut out: Vec<[usize; 3]> = (0..6).map(corner).collect();
    for level in [0, 3] {
        for (a, b) in [(0, 1), (1, 2), (2, 0)] {
            out.extend(between(corner(level + a), corner(level + b), p));
        }
    }
    for c in 0..3 {
        out.extend(between(corner(c), corner(c + 3), r));
    }
    let triangle = |k: usize| (1..p).flat_map(move |j| (1..p.saturating_sub(j)).map(move |i| [i, j, k]));
    out.extend(triangle(0));
    out.extend(triangle(r));
    for (a, b) in [(0, 1), (1, 2), (2, 0)] {
        for k in 1..r {
            out.extend(between(corner(a), corner(b), p).map(|[i, j, _]| [i, j, k]));
        }
    }
    for k in 1..r {
        out.extend(triangle(k));
    }
    out
}

/// Nodes of a pyramid of order p: corners, edges.
fn pyramid_positions(p: usize) -> Vec<[usize; 3]> {
    let corners = [[0, 0, 0], [p, 0, 0], [p, p, 0], [0, p, 0], [0, 0, p]];
    let edges = [(0, 1), (1, 2), (2, 3), (3, 0), (0, 4), (1, 4), (2, 4), (3, 4)];
    let inner = edges.into_iter().flat_map(|(a, b)| between(corners[a], corners[b], p));
    corners.into_iter().chain(inner).collect()
}

/// Nodes of a Lagrange tetrahedron: corners, edges, faces, then a smaller tetrahedron inside.
fn tetrahedron_positions(p: usize) -> Vec<[usize; 3]> {
    let mut out = Vec::new();
    let (mut p, mut shift) = (p as isize, 0);
    // The smaller tetrahedron inside starts at (1, 1, 1) and has four pieces less.
    while p >= 0 {
        let n = p as usize;
        let corners = [[0, 0, 0], [n, 0, 0], [0, n, 0], [0, 0, n]].map(|c| c.map(|x| x + shift));
        if p == 0 {
            out.push(corners[0]);
            break;
        }
        out.extend(corners);
        for (a, b) in [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)] {
            out.extend(between(corners[a], corners[b], n));
        }
        for [a, b, c] in [[0, 1, 3], [2, 3, 1], [0, 3, 2], [0, 2, 1]] {
            triangle_inside(corners[a], corners[b], corners[c], n, &mut out);
        }
        p -= 4;
        shift += 1;
    }
    out
}

/// Nodes inside a triangle with n pieces along an edge: a smaller triangle with three pieces less, corners first.
fn triangle_inside(a: [usize; 3], b: [usize; 3], c: [usize; 3], n: usize, out: &mut Vec<[usize; 3]>) {
    let mut n = n;
    let (mut a, mut b, mut c) = (a, b, c);
    while n >= 3 {
        let toward = |from: [usize; 3], x: [usize; 3], y: [usize; 3]| {
            std::array::from_fn(|axis| (from[axis] * (n - 2) + x[axis] + y[axis]) / n)
        };
        (a, b, c) = (toward(a, b, c), toward(b, c, a), toward(c, a, b));
        n -= 3;
        if n == 0 {
            out.push(a);
            return;
        }
        out.extend([a, b, c]);
        for (from, to) in [(a, b), (b, c), (c, a)] {
            out.extend(between(from, to, n));
        }
    }
}
