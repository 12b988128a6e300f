//! Probe: moments of fields over a region of space (Kniss et al. 2003, section 6: "all sample locations are recorded
//! and basic statistics are performed on these samples to derive the mean, standard deviation, and covariance").
//!
//! Here the samples are all points of the cells in the region: integrals, not a sample. Fields are measured from the
//! middle of their range over the grid and in units of that range, so that neither their units nor a large constant
//! part costs digits. Sums are made in a fixed order: the same data give the same bits on any number of cores.
//!
//! Over a tetrahedron with corner values v_i and mean m = Σ v_i / 4, the covariance of linear fields is
//! Σ (v_i − m)(v_i − m)ᵀ / 20 exactly (from ∫ λ_i λ_j = (1 + δ_ij) V / 20 of the barycentric coordinates λ). Parts are
//! merged as Chan, Golub and LeVeque (1979) do, about their own means, so that a small spread around a large value
//! keeps its digits.
//!
//! Matrix K of a Gaussian widget, exp(−|K (v − mean)|²), from moments: with
//! With the covariance C of the fields, Kᵀ K = C⁻¹ / 2 makes the widget the normal distribution's shape (Kniss et al. 2003,
//! Eq. 11, 12). From the Cholesky factor C = L Lᵀ follows K = L⁻¹ / √2, a lower triangle.
//!
//! Directions in which the fields do not vary (a constant field, fewer points than fields, fields that depend on each
//! other) have no width. Fields are measured in their extents over the whole grid, and each eigenvalue of C is raised
//! to at least `least`²: a width of `least` extents. A field that is constant over the whole grid is not looked at
//! (its row and column of K are 0).

use super::sub_tetrahedron::{ProbeRegion, scaled_volume};
use crate::grid::Grid;
use crate::grid::extent::range;
use crate::progress::Progress;
use crate::{Error, Result};
use glam::DVec3;
use rayon::prelude::*;

/// Selection of tetrahedra, by their number.
pub type Mask<'a> = &'a (dyn Fn(usize) -> bool + Sync);

/// Result of a probe: weight, mean, deviations and correlation of the fields.
#[derive(Debug, Clone, PartialEq)]
pub struct ProbeResult {
    /// Mean of each field.
    pub mean: Vec<f64>,
    /// Largest less smallest value of each field over the whole grid; 0 for a constant field.
    pub extent: Vec<f64>,
    /// Covariance of the fields divided by their extents (0 with a constant field); population, not sample.
    pub covariance: Vec<Vec<f64>>,
    /// Tetrahedra that contributed.
    pub cell_count: u64,
    /// Their volume within the region, world units cubed; 0 for points.
    pub volume: f64,
    /// Points that lie in a cell; 0 for other regions.
    pub point_count: u64,
}

impl ProbeResult {
    /// Standard deviation of each field.
    pub fn sigma(&self) -> Vec<f64> {
        (0..self.mean.len()).map(|i| self.extent[i] * self.covariance[i][i].sqrt()).collect()
    }
}

/// A field's values, measured from `zero` in units of `extent`.
struct CentredField<'a> {
    values: &'a [f64],
    zero: f64,
    extent: f64,
}

impl CentredField<'_> {
    fn value_at(&self, point: u32) -> f64 {
        let value = self.values[point as usize];
        // A constant field is 0 everywhere, but what is not finite stays so.
        if self.extent > 0.0 { 2.0 * ((0.5 * value - 0.5 * self.zero) / self.extent) } else { 0.0 * value }
    }
}

/// Tetrahedra that one task looks at.
const CHUNK: usize = 1 << 12;

/// The moments of `fields` (one value a point each, 1 to 8 of them) in the region; cells with values that are not
/// finite are left out.
///
/// Errors: nothing of the grid lies in the region, or the mask leaves no cell.
pub fn probe(
    grid: &Grid,
    fields: &[&[f64]],
    region: &ProbeRegion,
    mask: Option<Mask>,
    progress: &dyn Progress,
) -> Result<ProbeResult> {
    if !(1..=MAX_DIMENSIONS).contains(&fields.len()) {
        let error = Error::usage("the number of fields to probe is out of range").got(fields.len());
        return Err(error.expected(format!("1 to {MAX_DIMENSIONS}")));
    }
    fields.iter().try_for_each(|values| grid.check_values("a field to probe", values))?;
    let ranges: Vec<[f64; 2]> = fields.iter().map(|values| range(values).unwrap_or([0.0; 2])).collect();
    let fields: Vec<CentredField> = (fields.iter().zip(&ranges))
        .map(|(&values, &[low, high])| CentredField {
            values,
            zero: 0.5 * low + 0.5 * high,
            extent: high - low,
        })
        .collect();
    if let Some(field) = fields.iter().find(|field| !field.extent.is_finite()) {
        let error = Error::run("the range of a field to probe is beyond 64-bit floats").got(field.extent);
        return Err(error.expected("values below 8e307"));
    }
    let (moments, cell_count, point_count) = match region {
        ProbeRegion::Points(points) => at_points(grid, &fields, points, mask, progress)?,
        _ => in_region(grid, &fields, region, mask, progress)?,
    };
    let n = fields.len();
    let mean = |k: usize| fields[k].zero + moments.mean[k] * fields[k].extent;
    let variance = |i: usize, j: usize| moments.scatter[i][j] / moments.weight;
    let scale = grid.length_scale();
    let is_points = matches!(region, ProbeRegion::Points(_));
    Ok(ProbeResult {
        // Rounding must not carry a mean out of the range.
        mean: (0..n).map(|k| mean(k).clamp(ranges[k][0], ranges[k][1])).collect(),
        extent: fields.iter().map(|field| field.extent).collect(),
        covariance: (0..n).map(|i| (0..n).map(|j| variance(i, j)).collect()).collect(),
        cell_count,
        volume: if is_points { 0.0 } else { moments.weight / scale / scale / scale },
        point_count,
    })
}

/// The values at the corners of tetrahedron `i`; `None` where one is not finite.
fn corner_values(grid: &Grid, fields: &[CentredField], i: usize) -> Option<[[f64; 4]; MAX_DIMENSIONS]> {
    let mut values = [[0.0; 4]; MAX_DIMENSIONS];
    for (value, field) in values.iter_mut().zip(fields) {
        *value = grid.tetrahedra[i].map(|p| field.value_at(p));
    }
    values.as_flattened().iter().all(|v| v.is_finite()).then_some(values)
}

fn in_region(
    grid: &Grid,
    fields: &[CentredField],
    region: &ProbeRegion,
    mask: Option<Mask>,
    progress: &dyn Progress,
) -> Result<(Moments, u64, u64)> {
    let n = fields.len();
    let scale = grid.length_scale();
    let parts: Vec<(Moments, u64, bool)> = (0..grid.tetrahedra.len().div_ceil(CHUNK))
        .into_par_iter()
        .map(|chunk| {
            let (mut sum, mut count, mut masked) = (Moments::NONE, 0, false);
            if progress.cancelled() {
                return (sum, count, masked);
            }
            for i in chunk * CHUNK..((chunk + 1) * CHUNK).min(grid.tetrahedra.len()) {
                if mask.is_some_and(|mask| !mask(i)) {
                    continue;
                }
                masked = true;
                let Some(values) = corner_values(grid, fields, i) else { continue };
                let volume = scaled_volume(grid, i, scale);
                let before = sum.weight;
                region.parts(grid.corners(i), &mut |piece| {
                    let mut own = [[0.0; 4]; MAX_DIMENSIONS];
                    own[..n].iter_mut().zip(&values).for_each(|(own, &values)| *own = piece.values(values));
                    sum.merge(&Moments::of_tetrahedron(volume * piece.volume_fraction, &own[..n]), n);
                });
                count += u64::from(sum.weight > before);
            }
            (sum, count, masked)
        })
        .collect();
    progress.check_cancelled()?;
    let mut sum = Moments::NONE;
    parts.iter().for_each(|(part, ..)| sum.merge(part, n));
    if sum.weight > 0.0 {
        return Ok((sum, parts.iter().map(|part| part.1).sum(), 0));
    }
    if !parts.iter().any(|part| part.2) {
        return Err(Error::run("the mask leaves no cell").expected("a mask that holds for at least one cell"));
    }
    let cell = if mask.is_some() { "no cell of the mask" } else { "no cell" };
    Err(nothing(
        grid,
        &match region {
            ProbeRegion::Box { .. } => format!("{cell} reaches into the box"),
            ProbeRegion::Sphere { .. } => format!("{cell} reaches into the sphere"),
            _ => "the cells have no volume, or no finite values".into(),
        },
    ))
}

/// The error where a region misses the grid.
fn nothing(grid: &Grid, what: &str) -> Error {
    let error = Error::run(what);
    match grid.bounds() {
        Some([low, high]) => {
            error.expected(format!("a part of the grid, which reaches from {low} to {high}"))
        }
        None => error.expected("a grid with points"),
    }
}

/// Tolerance of a barycentric coordinate below 0 by rounding, for a point on a face, which must belong to a cell.
const ON_FACE: f64 = 1e-9;

/// The interpolated values at points; each in the cell that holds it best, so that one on a face counts once.
fn at_points(
    grid: &Grid,
    fields: &[CentredField],
    points: &[DVec3],
    mask: Option<Mask>,
    progress: &dyn Progress,
) -> Result<(Moments, u64, u64)> {
    /// A cell, the point's smallest coordinate in it, and all of them.
    type LocatedPoint = Option<(usize, f64, [f64; 4])>;
    let better = |a: LocatedPoint, b: LocatedPoint| match (a, b) {
        // The first of equals, whatever the order of work.
        (Some(x), Some(y)) => Some(if (y.1, x.0) > (x.1, y.0) { y } else { x }),
        (a, b) => a.or(b),
    };
    let holds = (0..grid.tetrahedra.len().div_ceil(CHUNK))
        .into_par_iter()
        .map(|chunk| {
            let mut held: Vec<LocatedPoint> = vec![None; points.len()];
            if progress.cancelled() {
                return held;
            }
            for i in chunk * CHUNK..((chunk + 1) * CHUNK).min(grid.tetrahedra.len()) {
                if mask.is_some_and(|mask| !mask(i)) || corner_values(grid, fields, i).is_none() {
                    continue;
                }
                let corners = grid.corners(i);
                let low = corners.iter().copied().fold(DVec3::INFINITY, DVec3::min);
                let high = corners.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
                let slack = ON_FACE * (high - low).max_element();
                for (held, &point) in held.iter_mut().zip(points) {
                    if (point - low).min_element() >= -slack && (high - point).min_element() >= -slack {
                        *held =
                            better(*held, coordinates(corners, point).map(|(least, all)| (i, least, all)));
                    }
                }
            }
            held
        })
        .reduce(
            || vec![None; points.len()],
            |a, b| a.into_iter().zip(b).map(|(a, b)| better(a, b)).collect(),
        );
    progress.check_cancelled()?;
    let mut sum = Moments::NONE;
    let mut cells: Vec<usize> = Vec::new();
    for (i, _, at) in holds.into_iter().flatten() {
        let corners = corner_values(grid, fields, i).unwrap_or_default();
        let values: Vec<f64> =
            corners[..fields.len()].iter().map(|v| (0..4).map(|k| at[k] * v[k]).sum()).collect();
        sum.merge(&Moments::of_point(&values), fields.len());
        cells.push(i);
    }
    if cells.is_empty() {
        let cell = if mask.is_some() { "no cell of the mask" } else { "no cell" };
        return Err(nothing(grid, &format!("{cell} holds any of the points")));
    }
    let point_count = cells.len() as u64;
    cells.sort_unstable();
    cells.dedup();
    Ok((sum, cells.len() as u64, point_count))
}

/// Barycentric coordinates of a point and the smallest of them; `None` where it lies outside or the cell is flat.
fn coordinates([a, b, c, d]: [DVec3; 4], p: DVec3) -> Option<(f64, [f64; 4])> {
    let sides = [b - a, c - a, d - a];
    let longest = sides.iter().map(|side| side.abs().max_element()).fold(0.0, f64::max);
    // In units of the cell, since products of lengths may leave the number range.
    let [u, v, w] = sides.map(|side| side / longest);
    let q = (p - a) / longest;
    let volume = u.dot(v.cross(w));
    let [x, y, z] = [q.dot(v.cross(w)), u.dot(q.cross(w)), u.dot(v.cross(q))].map(|part| part / volume);
    let all = [1.0 - x - y - z, x, y, z];
    let least = all.iter().copied().fold(f64::INFINITY, f64::min);
    (all.iter().all(|c| c.is_finite()) && least >= -ON_FACE).then_some((least, all))
}

/// Most fields that are looked at together: as many as a gaussian-nd widget has.
const MAX_DIMENSIONS: usize = 8;

/// Weight, mean and weighted scatter about the mean.
#[derive(Debug, Clone, Copy)]
struct Moments {
    pub weight: f64,
    pub mean: [f64; MAX_DIMENSIONS],
    /// Σ w (v − mean)(v − mean)ᵀ.
    pub scatter: [[f64; MAX_DIMENSIONS]; MAX_DIMENSIONS],
}

impl Moments {
    pub const NONE: Moments = Moments {
        weight: 0.0,
        mean: [0.0; MAX_DIMENSIONS],
        scatter: [[0.0; MAX_DIMENSIONS]; MAX_DIMENSIONS],
    };

    /// Moments of a tetrahedron of volume `weight`, `values[field][corner]`.
    pub fn of_tetrahedron(weight: f64, values: &[[f64; 4]]) -> Moments {
        let mut moments = Moments { weight, ..Moments::NONE };
        let mut centred = [[0.0; 4]; MAX_DIMENSIONS];
        for (k, v) in values.iter().enumerate() {
            let mean = 0.25 * ((v[0] + v[1]) + (v[2] + v[3]));
            moments.mean[k] = mean;
            centred[k] = v.map(|v| v - mean);
        }
        for (i, a) in centred.iter().enumerate().take(values.len()) {
            for (j, b) in centred.iter().enumerate().take(values.len()) {
                let sum = (a[0] * b[0] + a[1] * b[1]) + (a[2] * b[2] + a[3] * b[3]);
                moments.scatter[i][j] = weight * sum / 20.0;
            }
        }
        moments
    }

    pub fn of_point(values: &[f64]) -> Moments {
        let mut moments = Moments { weight: 1.0, ..Moments::NONE };
        moments.mean[..values.len()].copy_from_slice(values);
        moments
    }

    /// Adds other moments of `n` fields.
    pub fn merge(&mut self, other: &Moments, n: usize) {
        if other.weight <= 0.0 {
            return;
        }
        let weight = self.weight + other.weight;
        // The share of the newcomer; self.weight × share is the weight between the two means.
        let share = other.weight / weight;
        let mut apart = [0.0; MAX_DIMENSIONS];
        for (apart, (theirs, ours)) in apart[..n].iter_mut().zip(other.mean.iter().zip(&self.mean)) {
            *apart = theirs - ours;
        }
        for i in 0..n {
            for j in 0..n {
                self.scatter[i][j] += other.scatter[i][j] + self.weight * share * apart[i] * apart[j];
            }
        }
        self.mean.iter_mut().zip(apart).for_each(|(mean, apart)| *mean += share * apart);
        self.weight = weight;
    }
}

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
