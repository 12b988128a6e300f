//! Regular lattices on the reference tetrahedron, hexahedron, wedge and pyramid, and the linear cells between their
//! points.
//!
//! A lattice of order m has m pieces along an edge. Its points are (i, j, k):
//! - tetrahedron: i + j + k ≤ m; corners 0 … 3 at the origin, (m, 0, 0), (0, m, 0), (0, 0, m);
//! - hexahedron: i ≤ m₀, j ≤ m₁, k ≤ m₂; corners in VTK's order;
//! - wedge: i + j ≤ m₀, k ≤ m₂; corners 0 … 2 of the triangle at k = 0, then those at k = m₂;
//! - pyramid: layers k ≤ m of (m − k + 1)² points; corners 0 … 3 of the base in VTK's order, apex 4 at k = m.

use super::super::split;

/// The reference cells.
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
