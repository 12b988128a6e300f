//! `least-squares`: the linear function through the point that fits the neighbours best.
//!
//! ∇s minimises Σ_q w_q² (∇s · d_q − Δ_q)² over the points q that share an edge with p, with d_q = x_q − x_p,
//! Δ_q = s_q − s_p and weights w_q = 1/|d_q|: the normal matrix Σ d̂ d̂ᵀ then has no unit, and thin cells do not
//! drown it. Exact for linear fields wherever the neighbours span three dimensions, first order in general (second
//! where the neighbourhood is symmetric). Differences are taken before anything else, so an offset of coordinates
//! or values costs only what it has already cost in the input.

use super::filter::for_these;
use super::{Fallback, Gradient, GradientFilter, check_scalar};
use crate::Result;
use crate::grid::{Grid, Neighbours, cells_of_points};
use crate::parameters::{Parameters, VariantSchema};
use crate::progress::Progress;
use glam::{DMat3, DVec3};

/// Inverse-distance weighted least squares over the points joined by an edge.
pub struct LeastSquares;

/// Under this pivot of the normal matrix (which has trace 1 after division by the number of neighbours) its
/// solution would lose more than six digits, and the singular values are taken instead.
const SMALL_PIVOT: f64 = 1e-6;

impl GradientFilter for LeastSquares {
    fn declaration(&self) -> VariantSchema {
        VariantSchema {
            name: "least-squares",
            summary: "Linear fit to the neighbouring points, weighted by inverse distance: exact for linear fields, \
                   first order.",
            parameters: &[],
        }
    }

    fn gradient(&self, grid: &Grid, s: &[f64], _: &Parameters, progress: &dyn Progress) -> Result<Gradient> {
        fit(grid, s, None, progress)
    }

    fn gradient_at(
        &self,
        grid: &Grid,
        s: &[f64],
        points: &[u32],
        _: &Parameters,
        progress: &dyn Progress,
    ) -> Option<Result<Gradient>> {
        Some(fit(grid, s, Some(points), progress))
    }
}

/// At every point, or those of a list.
fn fit(grid: &Grid, s: &[f64], points: Option<&[u32]>, progress: &dyn Progress) -> Result<Gradient> {
    check_scalar(grid, s)?;
    let scale = grid.length_scale();
    let cells = cells_of_points(grid);
    let (vectors, [flat, none]) = for_these(
        (grid.points.len(), points),
        progress,
        || (Neighbours::default(), Fit::default()),
        |(neighbours, fit), p| {
            fit.at(Neighbourhood { grid, s, scale, p, others: neighbours.around(grid, &cells, p) })
        },
    )?;
    Ok(Gradient { vectors, fallbacks: fallbacks(flat, none) })
}

/// The fall-backs of [`Fit::at`], by number.
pub(super) fn fallbacks(flat: u64, none: u64) -> Vec<Fallback> {
    Fallback::list([
        ("left without the component across: the neighbours lie in a plane or on a line", flat),
        (
            "set to zero: no neighbour lies apart from the point, or the gradient leaves the number range",
            none,
        ),
    ])
}

/// Memory for one fit.
#[derive(Default)]
pub(super) struct Fit {
    columns: [Vec<f64>; 3],
    right: Vec<f64>,
}

impl Fit {
    /// ∇s at a point from its neighbours; and the fall-back taken: 0 flat, 1 none.
    pub fn at(&mut self, around: Neighbourhood) -> (DVec3, Option<usize>) {
        let mut m = [0.0; 6];
        let mut b = DVec3::ZERO;
        let mut trace = 0.0;
        for Difference { d, square, delta, .. } in around.differences() {
            let wd = d / square;
            m.iter_mut().zip(products(wd, d)).for_each(|(slot, product)| *slot += product);
            b += wd * delta;
            trace += 1.0;
        }
        if trace > 0.0
            && let Some(gradient) = solve_normal(m, b, trace)
        {
            let gradient = gradient * around.scale;
            if gradient.is_finite() {
                return (gradient, None);
            }
        }
        self.careful(around)
    }

    /// Solves by singular values, for neighbourhoods that are flat or nearly so.
    #[cold]
    fn careful(&mut self, around: Neighbourhood) -> (DVec3, Option<usize>) {
        self.columns.iter_mut().for_each(Vec::clear);
        self.right.clear();
        let mut noise = 0.0_f64;
        for Difference { d, square, delta, resolution } in around.differences() {
            let length = square.sqrt();
            for (column, v) in self.columns.iter_mut().zip((d / length).to_array()) {
                column.push(v);
            }
            self.right.push(delta / length);
            noise = noise.max(resolution * around.scale / length);
        }
        if self.right.is_empty() {
            return (DVec3::ZERO, Some(1));
        }
        // A direction counts when it stands out of what the coordinates can resolve, and out of rounding here.
        let tolerance = (4.0 * noise).clamp(1e-12, 0.1);
        let [x, y, z] = &mut self.columns;
        let (solution, rank) = solve3([x, y, z], &self.right, tolerance);
        let gradient = DVec3::from_array(solution) * around.scale;
        if !gradient.is_finite() {
            return (DVec3::ZERO, Some(1));
        }
        (gradient, (rank < 3).then_some(0))
    }
}

/// Difference of position and value between a point and another.
pub(super) struct Difference {
    /// Difference of the positions, multiplied by the scale.
    pub d: DVec3,
    /// |d|².
    pub square: f64,
    pub delta: f64,
    /// Smallest difference that the coordinates of the two points resolve.
    resolution: f64,
}

/// A point with others near it.
#[derive(Clone, Copy)]
pub(super) struct Neighbourhood<'a> {
    pub grid: &'a Grid,
    /// The scalar at every point.
    pub s: &'a [f64],
    /// Factor on lengths.
    pub scale: f64,
    /// Number of the point.
    pub p: usize,
    /// Numbers of the others.
    pub others: &'a [u32],
}

impl<'a> Neighbourhood<'a> {
    /// Differences from the point to those of the others that lie apart from it by more than rounding of the coordinates.
    #[inline]
    pub fn differences(self) -> impl Iterator<Item = Difference> + 'a {
        let Neighbourhood { grid, s, scale, p, others } = self;
        let x = grid.points[p];
        let size = x.abs().max_element();
        others.iter().filter_map(move |&q| {
            let (y, delta) = (grid.points[q as usize], s[q as usize] - s[p]);
            let d = (y - x) * scale;
            let square = d.length_squared();
            let resolution = f64::EPSILON * size.max(y.abs().max_element());
            let is_apart = d.abs().max_element() > 2.0 * resolution * scale && square >= f64::MIN_POSITIVE;
            is_apart.then_some(Difference { d, square, delta, resolution })
        })
    }
}

/// Products of the components of two vectors: xx, xy, xz, yy, yz, zz.
#[inline]
pub(super) fn products(a: DVec3, b: DVec3) -> [f64; 6] {
    [a.x * b.x, a.x * b.y, a.x * b.z, a.y * b.y, a.y * b.z, a.z * b.z]
}

/// Solves the normal equations by Cholesky's method (as L D Lᵀ) with one step of refinement; `None` where a pivot
/// is too small.
#[inline]
fn solve_normal(m: [f64; 6], b: DVec3, trace: f64) -> Option<DVec3> {
    let limit = SMALL_PIVOT * trace;
    let [xx, xy, xz, yy, yz, zz] = m;
    if xx <= limit {
        return None;
    }
    let (l1, l2) = (xy / xx, xz / xx);
    let d1 = yy - l1 * xy;
    if d1 <= limit {
        return None;
    }
    let r = yz - l1 * xz;
    let l3 = r / d1;
    let d2 = zz - l2 * xz - l3 * r;
    if d2 <= limit {
        return None;
    }
    let solve = |b: DVec3| {
        let y1 = b.y - l1 * b.x;
        let y2 = b.z - l2 * b.x - l3 * y1;
        let z = y2 / d2;
        let y = y1 / d1 - l3 * z;
        DVec3::new(b.x / xx - l1 * y - l2 * z, y, z)
    };
    let matrix = DMat3::from_cols_array(&[xx, xy, xz, xy, yy, yz, xz, yz, zz]);
    let first = solve(b);
    Some(first + solve(b - matrix * first))
}

/// Solves in the least-squares sense with three unknowns by the one-sided Jacobi method (Hestenes 1958; Demmel and
/// Veselić 1992): the columns of A are rotated until they are orthogonal, their lengths are then the singular
/// values to high relative accuracy. Directions whose singular value is at most `tolerance` × the largest carry no
/// information and are left out, which gives the solution of least norm. Returns it with the rank.
fn solve3(mut columns: [&mut [f64]; 3], b: &[f64], tolerance: f64) -> ([f64; 3], usize) {
    let mut v = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    // Converges quadratically; 3 columns need about 5 sweeps.
    for _ in 0..30 {
        let mut rotated = false;
        for (i, j) in [(0, 1), (0, 2), (1, 2)] {
            let (alpha, beta) = (dot(columns[i], columns[i]), dot(columns[j], columns[j]));
            let gamma = dot(columns[i], columns[j]);
            if gamma.abs() <= 4.0 * f64::EPSILON * (alpha * beta).sqrt() || gamma == 0.0 {
                continue;
            }
            rotated = true;
            let zeta = (beta - alpha) / (2.0 * gamma);
            let t = zeta.signum() / (zeta.abs() + zeta.hypot(1.0));
            let cos = 1.0 / t.hypot(1.0);
            let sin = cos * t;
            let (head, tail) = columns.split_at_mut(j);
            for (x, y) in head[i].iter_mut().zip(tail[0].iter_mut()) {
                (*x, *y) = (cos * *x - sin * *y, sin * *x + cos * *y);
            }
            for row in &mut v {
                (row[i], row[j]) = (cos * row[i] - sin * row[j], sin * row[i] + cos * row[j]);
            }
        }
        if !rotated {
            break;
        }
    }
    let squares = [0, 1, 2].map(|k| dot(columns[k], columns[k]));
    let largest = squares.iter().copied().fold(0.0, f64::max);
    let mut x = [0.0; 3];
    let mut rank = 0;
    for k in 0..3 {
        if squares[k] > tolerance * tolerance * largest {
            rank += 1;
            let y = dot(columns[k], b) / squares[k];
            for (slot, row) in x.iter_mut().zip(&v) {
                *slot += row[k] * y;
            }
        }
    }
    (x, rank)
}

/// Solves in the least-squares sense with `N` unknowns by Householder's QR method with column pivoting (Businger and
/// Golub 1965). The columns of A lie one after another in `a`, each as long as `b`; both are overwritten. Columns
/// are brought to length 1 first. `None` where the smallest pivot is at most `tolerance`: too few or
/// ill-conditioned equations.
pub(super) fn solve_qr<const N: usize>(a: &mut [f64], b: &mut [f64], tolerance: f64) -> Option<[f64; N]> {
    let m = b.len();
    if m < N {
        return None;
    }
    let mut order: [usize; N] = std::array::from_fn(|k| k);
    let mut norms = [0.0; N];
    for (k, column) in a.chunks_exact_mut(m).enumerate() {
        norms[k] = dot(column, column).sqrt();
        if norms[k].is_nan() || norms[k] < f64::MIN_POSITIVE {
            return None;
        }
        let inverse = 1.0 / norms[k];
        column.iter_mut().for_each(|v| *v *= inverse);
    }
    let mut diagonal = [0.0; N];
    for k in 0..N {
        let rest = |c: usize, a: &[f64]| dot(&a[c * m + k..(c + 1) * m], &a[c * m + k..(c + 1) * m]);
        let mut pivot = (k, rest(k, a));
        for c in k + 1..N {
            let square = rest(c, a);
            if square > pivot.1 {
                pivot = (c, square);
            }
        }
        if pivot.1 <= tolerance * tolerance || !pivot.1.is_finite() {
            return None;
        }
        if pivot.0 != k {
            let (head, tail) = a.split_at_mut(pivot.0 * m);
            head[k * m..(k + 1) * m].swap_with_slice(&mut tail[..m]);
            order.swap(k, pivot.0);
        }
        // H = I − v vᵀ / h maps the column to −sign × length × e_k.
        let (head, tail) = a.split_at_mut((k + 1) * m);
        let v = &mut head[k * m + k..];
        let length = pivot.1.sqrt() * v[0].signum();
        let h = pivot.1 + length * v[0];
        v[0] += length;
        diagonal[k] = -length;
        for column in tail.chunks_exact_mut(m) {
            reflect(v, h, &mut column[k..]);
        }
        reflect(v, h, &mut b[k..]);
    }
    let mut x = [0.0; N];
    for k in (0..N).rev() {
        let mut sum = b[k];
        for c in k + 1..N {
            sum -= a[c * m + k] * x[order[c]];
        }
        x[order[k]] = sum / diagonal[k];
    }
    for k in 0..N {
        x[k] /= norms[k];
    }
    Some(x)
}

fn reflect(v: &[f64], h: f64, column: &mut [f64]) {
    let factor = dot(v, column) / h;
    column.iter_mut().zip(v).for_each(|(c, v)| *c -= factor * v);
}

/// Four partial sums, so that the compiler can keep them in one vector register.
#[inline]
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 4];
    let (a4, b4) = (a.chunks_exact(4), b.chunks_exact(4));
    let rest: f64 = a4.remainder().iter().zip(b4.remainder()).map(|(x, y)| x * y).sum();
    for (x, y) in a4.zip(b4) {
        for k in 0..4 {
            sums[k] += x[k] * y[k];
        }
    }
    (sums[0] + sums[1]) + (sums[2] + sums[3]) + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A = Q diag(1, ½, 10⁻³) Rᵀ with Q and R rotations: each direction counts while its singular value is above the tolerance,
    /// and along the others the solution is 0.
    #[test]
    fn directions_are_left_out_by_their_singular_value() {
        let (q, r) = (rotation(0.4, 1.1), rotation(-0.7, 0.3));
        let values = [1.0, 0.5, 1e-3];
        let wanted = [0.3, -2.0, 1.5];
        let entry = |i: usize, j: usize| (0..3).map(|k| q[i][k] * values[k] * r[j][k]).sum::<f64>();
        let right: [f64; 3] = std::array::from_fn(|i| (0..3).map(|j| entry(i, j) * wanted[j]).sum::<f64>());
        for (tolerance, rank) in [(1e-12, 3), (0.9e-3, 3), (1.1e-3, 2), (0.1, 2), (0.6, 1)] {
            let mut columns: [[f64; 3]; 3] = std::array::from_fn(|j| std::array::from_fn(|i| entry(i, j)));
            let [x, y, z] = &mut columns;
            let (found, held) = solve3([x, y, z], &right, tolerance);
            assert_eq!(held, rank, "at {tolerance:e}");
            // What is left of the solution along the directions that count.
            let share = |k: usize| (0..3).map(|j| r[j][k] * wanted[j]).sum::<f64>();
            for j in 0..3 {
                let expected: f64 = (0..rank).map(|k| r[j][k] * share(k)).sum();
                // Rounding, by the inverse of the least singular value.
                assert!((found[j] - expected).abs() < 1e-12, "{found:?} at {tolerance:e}");
            }
        }
    }

    /// A rotation by one angle about z, then by another about x.
    fn rotation(a: f64, b: f64) -> [[f64; 3]; 3] {
        let ((sin_a, cos_a), (sin_b, cos_b)) = (a.sin_cos(), b.sin_cos());
        [[cos_a, -sin_a, 0.0], [cos_b * sin_a, cos_b * cos_a, -sin_b], [sin_b * sin_a, sin_b * cos_a, cos_b]]
    }
}
