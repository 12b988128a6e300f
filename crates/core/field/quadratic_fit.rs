//! `quadratic-fit`: the quadratic function through the point that fits its surroundings best.
//!
//! s(x_p + d) ≈ s_p + ∇s · d + ½ dᵀ H d, nine unknowns, least squares with weights 1/|d| (in coordinates in which the
//! surroundings are as wide in every direction) over the points joined by
//! an edge; where these are too few or badly placed, over their neighbours too; where that does not do either, the
//! linear fit of `least-squares` stands in and is counted. Second order, exact for quadratic fields.

use super::filter::for_these;
use super::least_squares::{Difference, Fit, Neighbourhood, fallbacks, products, solve_qr};
use super::{Fallback, Gradient, GradientFilter, check_scalar};
use crate::Result;
use crate::grid::{Grid, Neighbours, cells_of_points, points_of_points};
use crate::parameters::{Parameters, VariantSchema};
use crate::progress::Progress;
use glam::DVec3;

/// Quadratic least squares.
pub struct QuadraticFit;

/// Unknowns: three slopes and six curvatures.
const UNKNOWNS: usize = 9;

/// Smallest pivot (columns of length 1) accepted: errors of third order, which the fit cannot hold, are blown up by
/// at most about its inverse.
const SMALL_PIVOT: f64 = 1e-2;

/// Smallest pivot for the larger neighbourhood, the last resort before a linear fit.
const SMALL_PIVOT_SECOND_RING: f64 = 1e-3;

/// Fewest neighbours for a fit without the second ring: three more than unknowns, so that single values do not
/// decide a curvature.
const FEWEST: usize = UNKNOWNS + 3;

impl GradientFilter for QuadraticFit {
    fn declaration(&self) -> VariantSchema {
        VariantSchema {
            name: "quadratic-fit",
            summary: "Quadratic fit to the surrounding points: exact for quadratic fields, second order.",
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
    let neighbours = points_of_points(grid, &cells_of_points(grid));
    let (vectors, [linear, flat, none]) = for_these(
        (grid.points.len(), points),
        progress,
        || (Neighbours::default(), QuadraticPoint::default(), Fit::default()),
        |(ring, quadratic, fit), p| {
            let first = Neighbourhood { grid, s, scale, p, others: neighbours.row(p) };
            if first.others.len() >= FEWEST
                && let Some(gradient) = quadratic.at(first, SMALL_PIVOT)
            {
                return (gradient, None);
            }
            let second = Neighbourhood { others: ring.second_ring(&neighbours, p), ..first };
            if let Some(gradient) = quadratic.at(second, SMALL_PIVOT_SECOND_RING) {
                return (gradient, None);
            }
            let (gradient, fallback) = fit.at(first);
            (gradient, Some(fallback.map_or(0, |which| which + 1)))
        },
    )?;
    let mut taken = Fallback::list([(
        "fitted by a linear function: the surroundings are too small or badly placed for a quadratic one",
        linear,
    )]);
    taken.extend(fallbacks(flat, none));
    Ok(Gradient { vectors, fallbacks: taken })
}

/// Memory for one fit.
#[derive(Default)]
struct QuadraticPoint {
    matrix: Vec<f64>,
    right: Vec<f64>,
    differences: Vec<(DVec3, f64)>,
}

impl QuadraticPoint {
    fn at(&mut self, around: Neighbourhood, small_pivot: f64) -> Option<DVec3> {
        self.differences.clear();
        let mut covariance = [0.0; 6];
        for Difference { d, delta, .. } in around.differences() {
            covariance.iter_mut().zip(products(d, d)).for_each(|(slot, product)| *slot += product);
            self.differences.push((d, delta));
        }
        let rows = self.differences.len();
        if rows < UNKNOWNS {
            return None;
        }
        let stretch = ShapeFactor::from_covariance(covariance.map(|v| v / rows as f64))?;
        self.matrix.clear();
        self.matrix.resize(rows * UNKNOWNS, 0.0);
        self.right.clear();
        for (row, &(d, delta)) in self.differences.iter().enumerate() {
            let d = stretch.undo(d);
            let weight = 1.0 / d.length();
            let [xx, xy, xz, yy, yz, zz] = products(d, d);
            let terms = [d.x, d.y, d.z, 0.5 * xx, 0.5 * yy, 0.5 * zz, xy, xz, yz];
            for (column, term) in terms.into_iter().enumerate() {
                self.matrix[column * rows + row] = weight * term;
            }
            self.right.push(weight * delta);
        }
        let x = solve_qr::<UNKNOWNS>(&mut self.matrix, &mut self.right, small_pivot)?;
        let gradient = stretch.undo_for_gradient(DVec3::new(x[0], x[1], x[2])) * around.scale;
        gradient.is_finite().then_some(gradient)
    }
}

/// L of the covariance L Lᵀ of the surroundings (Cholesky). In the coordinates L⁻¹ d they are as wide in every
/// direction, so that thin, long and sheared cells are fitted as well as regular ones.
struct ShapeFactor {
    rows: [f64; 6],
}

impl ShapeFactor {
    fn from_covariance([xx, xy, xz, yy, yz, zz]: [f64; 6]) -> Option<Self> {
        // Under this share of a variance what remains of it is rounding: the surroundings are flat.
        const FLATNESS_TOLERANCE: f64 = 1e-13;
        let l11 = xx.sqrt();
        let (l21, l31) = (xy / l11, xz / l11);
        let rest_y = yy - l21 * l21;
        let l22 = rest_y.sqrt();
        let l32 = (yz - l21 * l31) / l22;
        let rest_z = zz - l31 * l31 - l32 * l32;
        let l33 = rest_z.sqrt();
        let spans = xx > 0.0 && rest_y > FLATNESS_TOLERANCE * yy && rest_z > FLATNESS_TOLERANCE * zz;
        spans.then_some(ShapeFactor { rows: [l11, l21, l22, l31, l32, l33] })
    }

    /// L⁻¹ d.
    #[inline]
    fn undo(&self, d: DVec3) -> DVec3 {
        let [l11, l21, l22, l31, l32, l33] = self.rows;
        let x = d.x / l11;
        let y = (d.y - l21 * x) / l22;
        DVec3::new(x, y, (d.z - l31 * x - l32 * y) / l33)
    }

    /// L⁻ᵀ g: a gradient in the coordinates L⁻¹ d, as one in those of d.
    fn undo_for_gradient(&self, g: DVec3) -> DVec3 {
        let [l11, l21, l22, l31, l32, l33] = self.rows;
        let z = g.z / l33;
        let y = (g.y - l32 * z) / l22;
        DVec3::new((g.x - l21 * y - l31 * z) / l11, y, z)
    }
}
