//! Probe: moments of fields over a region of space (Kniss et al. 2003, section 6: "all sample locations are recorded
//! and basic statistics are performed on these samples to derive the mean, standard deviation, and covariance").
//!
//! Here the samples are all points of the cells in the region: integrals, not a sample. Fields are measured from the
//! middle of their range over the grid and in units of that range, so that neither their units nor a large constant
//! part costs digits. Sums are made in a fixed order: the same data give the same bits on any number of cores.

use super::moments::{MAX_DIMENSIONS, Moments};
use super::region::ProbeRegion;
use super::sub_tetrahedron::scaled_volume;
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
    if let Some(values) = fields.iter().find(|values| values.len() != grid.points.len()) {
        let error = Error::run("a field to probe does not have one value a point").got(values.len());
        return Err(error.expected(grid.points.len()));
    }
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
        _ => {
            let (moments, cell_count) = in_region(grid, &fields, region, mask, progress)?;
            (moments, cell_count, 0)
        }
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
) -> Result<(Moments, u64)> {
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
    if progress.cancelled() {
        return Err(Error::cancelled());
    }
    let mut sum = Moments::NONE;
    parts.iter().for_each(|(part, ..)| sum.merge(part, n));
    if sum.weight > 0.0 {
        return Ok((sum, parts.iter().map(|part| part.1).sum()));
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
    if progress.cancelled() {
        return Err(Error::cancelled());
    }
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
