//! Gradients of a scalar at the points of a grid: the trait that every filter fulfils, and the filters that ship.
//!
//! Symbols: s the scalar, ∇s its gradient (units of s per world unit), g = |∇s| the gradient magnitude. What each method
//! finds: docs/src/explanation/optics.md, section 3.

mod cell_mean;
mod derivative;
mod filter;
mod least_squares;
mod quadratic_fit;

pub use cell_mean::{CellAverage, FromArray, VolumeWeighted};
pub use derivative::Derivative;
pub use filter::{Fallback, Gradient, GradientFilter, Method, Plugin, check_scalar, fingerprint, for_points};
pub use least_squares::LeastSquares;
pub use quadratic_fit::QuadraticFit;

use glam::DVec3;
use rayon::prelude::*;
use std::sync::Arc;

/// The filters that ship, in the order in which help lists them.
pub fn filters() -> [Arc<dyn GradientFilter>; 5] {
    [
        Arc::new(LeastSquares),
        Arc::new(QuadraticFit),
        Arc::new(VolumeWeighted),
        Arc::new(CellAverage),
        Arc::new(FromArray),
    ]
}

/// g = |∇s| at every point.
pub fn magnitude(vectors: &[DVec3]) -> Vec<f64> {
    vectors.par_iter().with_min_len(1 << 14).map(|&v| length(v)).collect()
}

/// √‖DᵀD‖₂ = ‖D‖₂ at every point, D the matrix whose rows are the gradients of the fields there, one list a field: the
/// fastest that they change together in any direction (Di Zenzo 1986). Kniss et al. 2003, section 3.2, take ‖DᵀD‖₂ for the
/// magnitude of several fields; its root is that of one field, |∇s|, where there is one.
pub fn spectral_norms(gradients: &[Vec<DVec3>]) -> Vec<f64> {
    let point_count = gradients.first().map_or(0, Vec::len);
    let norm = |rows: &mut Vec<DVec3>, p: usize| {
        rows.clear();
        rows.extend(gradients.iter().map(|of_field| of_field[p]));
        spectral_norm(rows)
    };
    (0..point_count).into_par_iter().with_min_len(1 << 12).map_init(Vec::new, norm).collect()
}

/// The largest singular value of the matrix with these rows, without overflow or underflow on the way.
pub fn spectral_norm(rows: &[DVec3]) -> f64 {
    if let [only] = rows {
        return length(*only);
    }
    let largest = rows.iter().map(|row| row.abs().max_element()).fold(0.0, f64::max);
    if largest == 0.0 || !largest.is_finite() {
        return largest;
    }
    let mut product = glam::DMat3::ZERO;
    for row in rows {
        let row = *row / largest;
        product += glam::DMat3::from_cols(row * row.x, row * row.y, row * row.z);
    }
    largest * largest_eigenvalue(product.to_cols_array_2d()).sqrt()
}

/// Largest eigenvalue of a symmetric matrix, by Jacobi's rotations: it keeps all its digits, however near the others are.
fn largest_eigenvalue(mut a: [[f64; 3]; 3]) -> f64 {
    // Each sweep squares what is left beside the diagonal; four leave rounding.
    for _ in 0..8 {
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            if a[p][q] == 0.0 {
                continue;
            }
            let theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
            let t = theta.signum() / (theta.abs() + theta.hypot(1.0));
            let c = 1.0 / t.hypot(1.0);
            let (s, r) = (t * c, 3 - p - q);
            a[p][p] -= t * a[p][q];
            a[q][q] += t * a[p][q];
            (a[p][q], a[q][p]) = (0.0, 0.0);
            let (rp, rq) = (a[r][p], a[r][q]);
            (a[r][p], a[r][q]) = (c * rp - s * rq, s * rp + c * rq);
            (a[p][r], a[q][r]) = (a[r][p], a[r][q]);
        }
    }
    a[0][0].max(a[1][1]).max(a[2][2])
}

/// |v| without overflow or underflow on the way.
#[inline]
pub fn length(v: DVec3) -> f64 {
    let plain = v.length_squared();
    // Outside this range a square may have left the normal numbers.
    if (1e-280..=1e280).contains(&plain) {
        return plain.sqrt();
    }
    let largest = v.abs().max_element();
    if largest == 0.0 || !largest.is_finite() {
        return largest;
    }
    largest * (v / largest).length()
}

#[cfg(test)]
mod tests;
