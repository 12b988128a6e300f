//! Nodes of VTK's curved cells: where each lies on the lattice of the cell's own order (VTK's classes of the same
//! names; the Lagrange and Bezier orders are those of vtkHigherOrderHexahedron, …Tetra and …Wedge).

use super::super::cell_types::code;
use super::lattice::{Orders, ReferenceCell};

/// Nodes of one type of cell.
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

const TETRAHEDRON: [[usize; 3]; 10] = [
    [0, 0, 0],
    [2, 0, 0],
    [0, 2, 0],
    [0, 0, 2],
    [1, 0, 0],
    [1, 1, 0],
    [0, 1, 0],
    [0, 0, 1],
    [1, 0, 1],
    [0, 1, 1],
];
const HEXAHEDRON: [[usize; 3]; 27] = [
    [0, 0, 0],
    [2, 0, 0],
    [2, 2, 0],
    [0, 2, 0],
    [0, 0, 2],
    [2, 0, 2],
    [2, 2, 2],
    [0, 2, 2],
    [1, 0, 0],
    [2, 1, 0],
    [1, 2, 0],
    [0, 1, 0],
    [1, 0, 2],
    [2, 1, 2],
    [1, 2, 2],
    [0, 1, 2],
    [0, 0, 1],
    [2, 0, 1],
    [2, 2, 1],
    [0, 2, 1],
    [0, 1, 1],
    [2, 1, 1],
    [1, 0, 1],
    [1, 2, 1],
    [1, 1, 0],
    [1, 1, 2],
    [1, 1, 1],
];
const WEDGE: [[usize; 3]; 18] = [
    [0, 0, 0],
    [2, 0, 0],
    [0, 2, 0],
    [0, 0, 2],
    [2, 0, 2],
    [0, 2, 2],
    [1, 0, 0],
    [1, 1, 0],
    [0, 1, 0],
    [1, 0, 2],
    [1, 1, 2],
    [0, 1, 2],
    [0, 0, 1],
    [2, 0, 1],
    [0, 2, 1],
    [1, 0, 1],
    [1, 1, 1],
    [0, 1, 1],
];
const LINEAR_WEDGE: [[usize; 3]; 12] = [
    [0, 0, 0],
    [2, 0, 0],
    [0, 2, 0],
    [0, 0, 1],
    [2, 0, 1],
    [0, 2, 1],
    [1, 0, 0],
    [1, 1, 0],
    [0, 1, 0],
    [1, 0, 1],
    [1, 1, 1],
    [0, 1, 1],
];
const PYRAMID: [[usize; 3]; 13] = [
    [0, 0, 0],
    [2, 0, 0],
    [2, 2, 0],
    [0, 2, 0],
    [0, 0, 2],
    [1, 0, 0],
    [2, 1, 0],
    [1, 2, 0],
    [0, 1, 0],
    [0, 0, 1],
    [1, 0, 1],
    [1, 1, 1],
    [0, 1, 1],
];

/// True if the type is one of these.
pub(super) fn is_curved(code: u8) -> bool {
    use code::*;
    matches!(
        code,
        QUADRATIC_TETRA
            | QUADRATIC_HEXAHEDRON
            | QUADRATIC_WEDGE
            | QUADRATIC_PYRAMID
            | TRIQUADRATIC_HEXAHEDRON
            | QUADRATIC_LINEAR_WEDGE
            | BIQUADRATIC_QUADRATIC_WEDGE
            | BIQUADRATIC_QUADRATIC_HEXAHEDRON
            | LAGRANGE_TETRAHEDRON
            | LAGRANGE_HEXAHEDRON
            | LAGRANGE_WEDGE
            | BEZIER_TETRAHEDRON
            | BEZIER_HEXAHEDRON
            | BEZIER_WEDGE
    )
}

/// The nodes of a cell with this type, number of points and (for Lagrange and Bezier cells) degrees; `None` where
/// these do not fit together.
pub(super) fn nodes(code: u8, point_count: usize, degrees: Option<[u8; 3]>) -> Option<Nodes> {
    let fixed = |shape, orders, positions: &[[usize; 3]]| {
        Some(Nodes { shape, orders, positions: positions.to_vec(), bezier: false })
    };
    let found = match code {
        code::QUADRATIC_TETRA => fixed(ReferenceCell::Tetrahedron, [2; 3], &TETRAHEDRON),
        code::QUADRATIC_HEXAHEDRON => fixed(ReferenceCell::Hexahedron, [2; 3], &HEXAHEDRON[..20]),
        code::BIQUADRATIC_QUADRATIC_HEXAHEDRON => fixed(ReferenceCell::Hexahedron, [2; 3], &HEXAHEDRON[..24]),
        code::TRIQUADRATIC_HEXAHEDRON => fixed(ReferenceCell::Hexahedron, [2; 3], &HEXAHEDRON),
        code::QUADRATIC_WEDGE => fixed(ReferenceCell::Wedge, [2; 3], &WEDGE[..15]),
        code::BIQUADRATIC_QUADRATIC_WEDGE => fixed(ReferenceCell::Wedge, [2; 3], &WEDGE),
        code::QUADRATIC_LINEAR_WEDGE => fixed(ReferenceCell::Wedge, [2, 2, 1], &LINEAR_WEDGE),
        code::QUADRATIC_PYRAMID => fixed(ReferenceCell::Pyramid, [2; 3], &PYRAMID),
        _ => {
            let (shape, bezier) = match code {
                code::LAGRANGE_TETRAHEDRON => (ReferenceCell::Tetrahedron, false),
                code::LAGRANGE_HEXAHEDRON => (ReferenceCell::Hexahedron, false),
                code::LAGRANGE_WEDGE => (ReferenceCell::Wedge, false),
                code::BEZIER_TETRAHEDRON => (ReferenceCell::Tetrahedron, true),
                code::BEZIER_HEXAHEDRON => (ReferenceCell::Hexahedron, true),
                code::BEZIER_WEDGE => (ReferenceCell::Wedge, true),
                _ => return None,
            };
            let orders = orders(shape, point_count, degrees)?;
            let positions = match shape {
                ReferenceCell::Tetrahedron => tetrahedron_positions(orders[0]),
                ReferenceCell::Hexahedron => hexahedron_positions(orders),
                _ => wedge_positions(orders[0], orders[2]),
            };
            Some(Nodes { shape, orders, positions, bezier })
        }
    }?;
    (found.positions.len() == point_count).then_some(found)
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
