//! Small dense least-squares problems, min |A x − b|, for the fits at single points.

/// Solves in the least-squares sense with three unknowns by the one-sided Jacobi method (Hestenes 1958; Demmel and
/// Veselić 1992): the columns of A are rotated until they are orthogonal, their lengths are then the singular
/// values to high relative accuracy. Directions whose singular value is at most `tolerance` × the largest carry no
/// information and are left out, which gives the solution of least norm. Returns it with the rank.
pub(super) fn solve3(mut columns: [&mut [f64]; 3], b: &[f64], tolerance: f64) -> ([f64; 3], usize) {
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
