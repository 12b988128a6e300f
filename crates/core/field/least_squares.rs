//! `least-squares`: the linear function through the point that fits the neighbours best.
//!
//! ∇s minimises Σ_q w_q² (∇s · d_q − Δ_q)² over the points q that share an edge with p, with d_q = x_q − x_p,
//! Δ_q = s_q − s_p and weights w_q = 1/|d_q|: the normal matrix Σ d̂ d̂ᵀ then has no unit, and thin cells do not
//! drown it. Exact for linear fields wherever the neighbours span three dimensions, first order in general (second
//! where the neighbourhood is symmetric). Differences are taken before anything else, so an offset of coordinates
//! or values costs only what it has already cost in the input.

use super::dense::solve3;
use super::frame::for_these;
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
        |(neighbours, fit), p| fit.at(grid, s, scale, p, neighbours.around(grid, &cells, p)),
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
    /// ∇s at point `p` from `neighbours`; and the fall-back taken: 0 flat, 1 none.
    pub fn at(
        &mut self,
        grid: &Grid,
        s: &[f64],
        scale: f64,
        p: usize,
        neighbours: &[u32],
    ) -> (DVec3, Option<usize>) {
        let (x, s_p) = (grid.points[p], s[p]);
        let apart = CoincidenceTest::new(x);
        let mut m = [0.0; 6];
        let mut b = DVec3::ZERO;
        let mut trace = 0.0;
        for &q in neighbours {
            let (y, delta) = (grid.points[q as usize], s[q as usize] - s_p);
            let d = (y - x) * scale;
            let square = d.length_squared();
            if !apart.holds(y, d, scale, square) {
                continue;
            }
            let wd = d / square;
            for (slot, product) in
                m.iter_mut().zip([wd.x * d.x, wd.x * d.y, wd.x * d.z, wd.y * d.y, wd.y * d.z, wd.z * d.z])
            {
                *slot += product;
            }
            b += wd * delta;
            trace += 1.0;
        }
        if trace > 0.0
            && let Some(gradient) = solve_normal(m, b, trace)
        {
            let gradient = gradient * scale;
            if gradient.is_finite() {
                return (gradient, None);
            }
        }
        self.careful(grid, s, scale, p, neighbours)
    }

    /// Solves by singular values, for neighbourhoods that are flat or nearly so.
    #[cold]
    fn careful(
        &mut self,
        grid: &Grid,
        s: &[f64],
        scale: f64,
        p: usize,
        neighbours: &[u32],
    ) -> (DVec3, Option<usize>) {
        self.columns.iter_mut().for_each(Vec::clear);
        self.right.clear();
        let x = grid.points[p];
        let apart = CoincidenceTest::new(x);
        let mut noise = 0.0_f64;
        for &q in neighbours {
            let (y, delta) = (grid.points[q as usize], s[q as usize] - s[p]);
            let d = (y - x) * scale;
            let square = d.length_squared();
            if !apart.holds(y, d, scale, square) {
                continue;
            }
            let length = square.sqrt();
            for (column, v) in self.columns.iter_mut().zip((d / length).to_array()) {
                column.push(v);
            }
            self.right.push(delta / length);
            noise = noise.max(apart.resolution(y) * scale / length);
        }
        if self.right.is_empty() {
            return (DVec3::ZERO, Some(1));
        }
        // A direction counts when it stands out of what the coordinates can resolve, and out of rounding here.
        let tolerance = (4.0 * noise).clamp(1e-12, 0.1);
        let [x, y, z] = &mut self.columns;
        let (solution, rank) = solve3([x, y, z], &self.right, tolerance);
        let gradient = DVec3::from_array(solution) * scale;
        if !gradient.is_finite() {
            return (DVec3::ZERO, Some(1));
        }
        (gradient, (rank < 3).then_some(0))
    }
}

/// Tells points apart from coincident ones.
pub(super) struct CoincidenceTest {
    /// |x| in its largest component.
    size: f64,
}

impl CoincidenceTest {
    pub fn new(x: DVec3) -> Self {
        CoincidenceTest { size: x.abs().max_element() }
    }

    /// Smallest difference that the coordinates of the two points resolve.
    fn resolution(&self, y: DVec3) -> f64 {
        f64::EPSILON * self.size.max(y.abs().max_element())
    }

    /// True if the difference d (times `scale`, with this square) is more than rounding of the coordinates.
    #[inline]
    pub fn holds(&self, y: DVec3, d: DVec3, scale: f64, square: f64) -> bool {
        d.abs().max_element() > 2.0 * self.resolution(y) * scale && square >= f64::MIN_POSITIVE
    }
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
