//! Matrix K of a Gaussian widget, from moments, exp(−|K (v − mean)|²).
//!
//! With the covariance C of the fields, Kᵀ K = C⁻¹ / 2 makes the widget the normal distribution's shape (Kniss et al. 2003,
//! Eq. 11, 12). From the Cholesky factor C = L Lᵀ follows K = L⁻¹ / √2, a lower triangle.
//!
//! Directions in which the fields do not vary (a constant field, fewer points than fields, fields that depend on each
//! other) have no width. Fields are measured in their extents over the whole grid, and each eigenvalue of C is raised
//! to at least `least`²: a width of `least` extents. A field that is constant over the whole grid is not looked at
//! (its row and column of K are 0).

use super::probe::ProbeResult;

/// K, n rows of n. `least`: the smallest standard deviation in any direction, as a share of the fields' extents over the
/// grid, > 0; `scale`: factor on all standard deviations, > 0; `correlated`: false keeps to the axes, K being the
/// diagonal of 1 / (√2 σ).
pub fn kernel(found: &ProbeResult, least: f64, scale: f64, correlated: bool) -> Vec<Vec<f64>> {
    let n = found.mean.len();
    let varying: Vec<usize> = (0..n).filter(|&i| found.extent[i] > 0.0).collect();
    let covariance: Vec<Vec<f64>> = (varying.iter())
        .map(|&i| {
            varying.iter().map(|&j| if correlated || i == j { found.covariance[i][j] } else { 0.0 }).collect()
        })
        .collect();
    let inverse = inverse_of_factor(&raised(covariance, least));
    let mut matrix = vec![vec![0.0; n]; n];
    for (&i, row) in varying.iter().zip(&inverse) {
        for (&j, entry) in varying.iter().zip(row) {
            matrix[i][j] = entry / (std::f64::consts::SQRT_2 * scale) / found.extent[j];
        }
    }
    matrix
}

/// The symmetric matrix with each eigenvalue raised to at least `least`² (cyclic Jacobi rotations).
fn raised(mut a: Vec<Vec<f64>>, least: f64) -> Vec<Vec<f64>> {
    let n = a.len();
    let mut vectors: Vec<Vec<f64>> =
        (0..n).map(|i| (0..n).map(|j| f64::from(u8::from(i == j))).collect()).collect();
    // Convergence is quadratic: eight fields take six to ten sweeps.
    for _ in 0..64 {
        let off =
            (0..n).flat_map(|i| (0..i).map(move |j| (i, j))).map(|(i, j)| a[i][j].abs()).fold(0.0, f64::max);
        if off == 0.0 {
            break;
        }
        for p in 0..n {
            for q in p + 1..n {
                if a[p][q] == 0.0 {
                    continue;
                }
                // The angle that makes a[p][q] vanish (Golub and Van Loan, section 8.5).
                let tau = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
                let t =
                    if tau.is_finite() { tau.signum() / (tau.abs() + (1.0 + tau * tau).sqrt()) } else { 0.0 };
                let c = 1.0 / (1.0 + t * t).sqrt();
                let s = t * c;
                for row in a.iter_mut().chain(&mut vectors) {
                    (row[p], row[q]) = (c * row[p] - s * row[q], s * row[p] + c * row[q]);
                }
                let (upper, lower) = a.split_at_mut(q);
                for (x, y) in upper[p].iter_mut().zip(&mut lower[0]) {
                    (*x, *y) = (c * *x - s * *y, s * *x + c * *y);
                }
                (a[p][q], a[q][p]) = (0.0, 0.0);
            }
        }
    }
    let entry = |i: usize, j: usize| {
        (0..n).map(|k| vectors[i][k] * a[k][k].max(least * least) * vectors[j][k]).sum::<f64>()
    };
    (0..n).map(|i| (0..n).map(|j| entry(i, j)).collect()).collect()
}

/// L⁻¹, with L the lower Cholesky factor of a positive definite matrix.
fn inverse_of_factor(a: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let n = a.len();
    let mut l = vec![vec![0.0; n]; n];
    for i in 0..n {
        for j in 0..=i {
            let rest = a[i][j] - (0..j).map(|k| l[i][k] * l[j][k]).sum::<f64>();
            // Positive by the raised eigenvalues, up to rounding.
            l[i][j] = if i == j { rest.max(f64::MIN_POSITIVE).sqrt() } else { rest / l[j][j] };
        }
    }
    let mut inverse = vec![vec![0.0; n]; n];
    for j in 0..n {
        inverse[j][j] = 1.0 / l[j][j];
        for i in j + 1..n {
            let sum = (j..i).map(|k| l[i][k] * inverse[k][j]).sum::<f64>();
            inverse[i][j] = -sum / l[i][i];
        }
    }
    inverse
}
