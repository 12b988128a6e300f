//! Shape functions of curved cells: a point of a refined lattice as a weighted sum of the cell's nodes.
//!
//! Every cell is brought to the full lattice of its own order first: what a serendipity cell lacks (centres of faces
//! and of the body) follows from the nodes it has, exactly, since its functions are among those of the full lattice;
//! Bezier points follow from Bernstein polynomials. On the full lattice the functions are products of Lagrange
//! polynomials on hexahedra and wedges, Silvester's on triangles and tetrahedra (P. Silvester, 1969), and on
//! pyramids the rational functions that are polynomials on every face (M. Bergot, G. Cohen, M. Duruflé, "Higher-order
//! finite elements for hybrid meshes", 2010).

use super::lattice::{Nodes, Orders, ReferenceCell, points};

/// Weights of nodes, by their number in the cell; those that vanish are left out.
pub(super) type Weights = Vec<(usize, f64)>;

/// Under this a weight is rounding of zero.
const ZERO: f64 = 1e-13;

/// The full lattice of a cell's own order: every point as a weighted sum of the cell's nodes.
pub(super) fn full_lattice(nodes: &Nodes) -> Option<Vec<Weights>> {
    let all = points(nodes.shape, nodes.orders);
    let given = |p: [usize; 3]| nodes.positions.iter().position(|&q| q == p);
    all.iter()
        .map(|&p| {
            if nodes.bezier {
                let bernstein = nodes.positions.iter().enumerate();
                let weights =
                    bernstein.map(|(node, &q)| (node, bernstein_at(nodes.shape, nodes.orders, q, p)));
                return Some(weights.filter(|&(_, w)| w.abs() > ZERO).collect());
            }
            match given(p) {
                Some(node) => Some(vec![(node, 1.0)]),
                None => serendipity(nodes, p),
            }
        })
        .collect()
}

/// The centre of a face or of the body of a quadratic cell from the nodes it has.
fn serendipity(nodes: &Nodes, p: [usize; 3]) -> Option<Weights> {
    let node = |q: [usize; 3]| nodes.positions.iter().position(|&r| r == q);
    // Neighbours on the lattice along `axes`, in the plane through p: corners lie off p along both axes.
    let face = |axes: [[isize; 3]; 2]| -> Option<Weights> {
        let step = |a: isize, b: isize| -> Option<usize> {
            let mut q = [0; 3];
            for axis in 0..3 {
                q[axis] = usize::try_from(p[axis] as isize + a * axes[0][axis] + b * axes[1][axis]).ok()?;
            }
            node(q)
        };
        let mut weights = Vec::new();
        for (a, b) in [(-1, -1), (1, -1), (1, 1), (-1, 1)] {
            weights.push((step(a, b)?, -0.25));
        }
        for (a, b) in [(-1, 0), (1, 0), (0, -1), (0, 1)] {
            weights.push((step(a, b)?, 0.5));
        }
        Some(weights)
    };
    let (x, y, z) = ([1, 0, 0], [0, 1, 0], [0, 0, 1]);
    // A wedge's slanted quadrilateral runs along (−1, 1, 0).
    for axes in [[x, y], [x, z], [y, z], [[-1, 1, 0], z]] {
        let body = nodes.shape == ReferenceCell::Hexahedron && p == [1, 1, 1] && nodes.positions.len() < 24;
        if !body && let Some(weights) = face(axes) {
            return Some(weights);
        }
    }
    // The centre of a 20-node hexahedron: −1/4 at the corners, 1/4 at the middles of the edges.
    (nodes.shape == ReferenceCell::Hexahedron && nodes.positions.len() == 20)
        .then(|| (0..20).map(|node| (node, if node < 8 { -0.25 } else { 0.25 })).collect())
}

/// Values of all functions of the full lattice of order `p` at point `at` of the lattice of order `m`, in the order
/// of [`points`].
pub(super) fn functions_at(shape: ReferenceCell, p: Orders, m: Orders, at: [usize; 3]) -> Vec<f64> {
    let all = points(shape, p);
    let line = |axis: usize, node: usize| lagrange(p[axis], node, m[axis], at[axis]);
    match shape {
        ReferenceCell::Hexahedron => {
            all.iter().map(|q| line(0, q[0]) * line(1, q[1]) * line(2, q[2])).collect()
        }
        ReferenceCell::Wedge => {
            let rest = m[0] - at[0] - at[1];
            let triangle = |q: &[usize; 3]| {
                silvester(p[0], q[0], m[0], at[0])
                    * silvester(p[0], q[1], m[0], at[1])
                    * silvester(p[0], p[0] - q[0] - q[1], m[0], rest)
            };
            all.iter().map(|q| triangle(q) * line(2, q[2])).collect()
        }
        ReferenceCell::Tetrahedron => {
            let rest = m[0] - at[0] - at[1] - at[2];
            all.iter()
                .map(|q| {
                    let axes: f64 = (0..3).map(|axis| silvester(p[0], q[axis], m[0], at[axis])).product();
                    axes * silvester(p[0], p[0] - q[0] - q[1] - q[2], m[0], rest)
                })
                .collect()
        }
        ReferenceCell::Pyramid => pyramid(p[0], m[0], at),
    }
}

/// Lagrange's polynomial of `node` among 0 … p at p x/m; exactly 0 or 1 at the nodes.
fn lagrange(p: usize, node: usize, m: usize, x: usize) -> f64 {
    let factor = |other: usize| (p * x) as f64 / m as f64 - other as f64;
    (0..=p).filter(|&o| o != node).map(|o| factor(o) / (node as f64 - o as f64)).product()
}

/// Silvester's polynomial: Π over o < node of (t − o)/(node − o) at t = p x/m.
fn silvester(p: usize, node: usize, m: usize, x: usize) -> f64 {
    let t = (p * x) as f64 / m as f64;
    (0..node).map(|o| (t - o as f64) / (node - o) as f64).product()
}

/// Bernstein's polynomial of control point `q` at point `p` of the same lattice.
fn bernstein_at(shape: ReferenceCell, m: Orders, q: [usize; 3], p: [usize; 3]) -> f64 {
    let power = |x: usize, m: usize, n: usize| (x as f64 / m as f64).powi(n as i32);
    // n! / Π parts! × Π x^part
    let simplex = |m: usize, parts: &[usize], at: &[usize]| {
        let mut value = factorial(m);
        for (&part, &x) in parts.iter().zip(at) {
            value *= power(x, m, part) / factorial(part);
        }
        value
    };
    let line = |axis: usize| {
        let m = m[axis];
        simplex(m, &[q[axis], m - q[axis]], &[p[axis], m - p[axis]])
    };
    match shape {
        ReferenceCell::Tetrahedron => {
            let rest = |v: [usize; 3]| m[0] - v[0] - v[1] - v[2];
            simplex(m[0], &[q[0], q[1], q[2], rest(q)], &[p[0], p[1], p[2], rest(p)])
        }
        ReferenceCell::Wedge => {
            let rest = |v: [usize; 3]| m[0] - v[0] - v[1];
            simplex(m[0], &[q[0], q[1], rest(q)], &[p[0], p[1], rest(p)]) * line(2)
        }
        _ => line(0) * line(1) * line(2),
    }
}

fn factorial(n: usize) -> f64 {
    (1..=n).map(|k| k as f64).product()
}

/// The pyramid's functions through their values: x^i y^j (1 − z)^(max(i, j) − i − j) z^k with i, j ≤ p and
/// k ≤ p − max(i, j), combined so that each is 1 at one lattice point and 0 at the others.
fn pyramid(p: usize, m: usize, at: [usize; 3]) -> Vec<f64> {
    let position = |[i, j, k]: [usize; 3], m: usize| [i, j, k].map(|x| x as f64 / m as f64);
    let terms = |[x, y, z]: [f64; 3]| -> Vec<f64> {
        let mut out = Vec::new();
        for (i, j) in (0..=p).flat_map(|i| (0..=p).map(move |j| (i, j))) {
            let most = i.max(j);
            for k in 0..=p - most {
                // At the apex x = y = 0: only i = j = 0 is left.
                let w = 1.0 - z;
                let product = x.powi(i as i32) * y.powi(j as i32) * z.powi(k as i32);
                let power = most as i32 - (i + j) as i32;
                out.push(if w == 0.0 && power < 0 { 0.0 } else { product * w.powi(power) });
            }
        }
        out
    };
    let all = points(ReferenceCell::Pyramid, [p; 3]);
    // Solves Σ_l weight_l × terms(l) = terms(at).
    let columns: Vec<Vec<f64>> = all.iter().map(|&q| terms(position(q, p))).collect();
    solve(&columns, terms(position(at, m)))
}

/// Solves Σ x_l column_l = right by Gauss's method with pivoting (small, regular systems).
fn solve(columns: &[Vec<f64>], right: Vec<f64>) -> Vec<f64> {
    let n = right.len();
    let mut rows: Vec<Vec<f64>> =
        (0..n).map(|r| columns.iter().map(|c| c[r]).chain([right[r]]).collect()).collect();
    for k in 0..n {
        let pivot = (k..n).max_by(|&a, &b| rows[a][k].abs().total_cmp(&rows[b][k].abs())).unwrap_or(k);
        rows.swap(k, pivot);
        let (done, rest) = rows.split_at_mut(k + 1);
        let head = &done[k];
        for row in rest {
            let factor = row[k] / head[k];
            row.iter_mut().zip(head).skip(k).for_each(|(v, h)| *v -= factor * h);
        }
    }
    let mut x = vec![0.0; n];
    for k in (0..n).rev() {
        let sum: f64 = (k + 1..n).map(|c| rows[k][c] * x[c]).sum();
        x[k] = (rows[k][n] - sum) / rows[k][k];
    }
    x
}

/// Weighted sum of the full lattice's points, as one of the nodes.
pub(super) fn combine(functions: &[f64], lattice: &[Weights]) -> Weights {
    let mut sums: std::collections::BTreeMap<usize, f64> = std::collections::BTreeMap::new();
    for (&f, weights) in functions.iter().zip(lattice).filter(|(f, _)| f.abs() > ZERO) {
        for &(node, w) in weights {
            *sums.entry(node).or_default() += f * w;
        }
    }
    sums.into_iter().filter(|(_, w)| w.abs() > ZERO).collect()
}
