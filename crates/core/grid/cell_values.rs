//! Averages of cell values at the points.

use super::parts::{Association, BoundaryValues, CellValues, RawGrid, Scalar, number};
use super::{Array, Grid, cells_of_points, tetrahedron_volume};
use crate::Result;
use crate::SharedSlice;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::sync::Arc;

pub(super) struct CellArrays {
    scalar: Option<Scalar>,
    arrays: BTreeMap<String, Array>,
    boundary: BTreeMap<String, BoundaryValues>,
}

impl CellArrays {
    fn is_empty(&self) -> bool {
        self.scalar.is_none() && self.arrays.is_empty()
    }

    /// Names of arrays with the number of faces at the boundary whose values are not finite.
    pub fn not_finite_at_boundary(&self) -> Vec<(&str, usize)> {
        let components = |name: &String| self.arrays.get(name).map_or(1, |array| array.component_count);
        let counts =
            self.boundary.iter().map(|(name, own)| (name.as_str(), own.not_finite(components(name))));
        counts.filter(|entry| entry.1 > 0).collect()
    }

    /// The points of faces at the boundary by other numbers.
    pub fn renumbered(mut self, numbers: &[u32]) -> CellArrays {
        let renumber = |own: BoundaryValues| own.renumbered(|point| numbers[point as usize]);
        self.boundary = self.boundary.into_iter().map(|(name, own)| (name, renumber(own))).collect();
        self
    }

    /// Point arrays; `convert` is given the values, the components of a tuple, and what faces at the boundary have.
    fn converted(self, convert: impl Fn(&[f64], usize, Option<&BoundaryValues>) -> Vec<f64>) -> CellArrays {
        let convert =
            |name: &String, values: &[f64], n| SharedSlice::from(convert(values, n, self.boundary.get(name)));
        let scalar = self.scalar.map(|s| Scalar { values: convert(&s.name, &s.values, 1), ..s });
        let arrays = self.arrays.into_iter().map(|(name, a)| {
            let values = convert(&name, &a.values, a.component_count);
            (name, Array { values, ..a })
        });
        CellArrays { scalar, arrays: arrays.collect(), boundary: BTreeMap::new() }
    }
}

/// Takes what sits on cells out of the parts.
pub(super) fn take(parts: &mut RawGrid) -> CellArrays {
    let on_cells = parts.scalar.as_ref().is_some_and(|s| s.association == Association::Cell);
    CellArrays {
        scalar: if on_cells { parts.scalar.take() } else { None },
        arrays: std::mem::take(&mut parts.cell_arrays),
        boundary: std::mem::take(&mut parts.boundary_values),
    }
}

/// A power of two by which sums of the greatest numbers come into the number range.
const TINY: f64 = f64::from_bits((1023 - 512) << 52);

/// Gives every point the mean over the cells of the file that use it, weighted by their volume (the sum of their
/// tetrahedra's); where all these volumes are zero, the plain mean. In an adaptive grid the weight is one over the size of the cell,
/// and hanging points have what is interpolated in the larger cell: both is exact for linear fields
/// (docs/src/explanation/optics.md, section 3). Where the file states values on faces at the boundary, their points have the means
/// of these.
pub(super) fn average(grid: &mut Grid, cells: CellArrays) {
    if cells.is_empty() {
        return;
    }
    let volumes = volumes_of_cells(grid);
    let rows = cells_of_points(grid);
    let weight_of = |cell: usize| match &grid.hanging {
        Some(_) if volumes[cell] > 0.0 => volumes[cell].cbrt().recip(),
        _ => volumes[cell],
    };
    let average = |values: &[f64], component_count: usize, boundary: Option<&BoundaryValues>| {
        let n = component_count.max(1);
        let mut means = vec![0.0; grid.points.len() * n];
        means.par_chunks_exact_mut(n).with_min_len(1024).enumerate().for_each(|(p, mean)| {
            let mut sum = |weight: &dyn Fn(usize) -> f64, scale: f64| {
                mean.fill(0.0);
                let mut total = 0.0;
                let mut last = None;
                for &tetrahedron in rows.row(p) {
                    let cell = grid.source_cell(tetrahedron as usize);
                    // A cell's tetrahedra follow one another.
                    if last == Some(cell) {
                        continue;
                    }
                    last = Some(cell);
                    let w = weight(cell);
                    total += w;
                    mean.iter_mut().zip(&values[cell * n..]).for_each(|(m, v)| *m += w * (v * scale));
                }
                mean.iter_mut().for_each(|m| *m = (*m / total / scale).clamp(f64::MIN, f64::MAX));
                (total > 0.0, mean.iter().all(|m| m.abs() < f64::MAX))
            };
            let weights: [&dyn Fn(usize) -> f64; 2] = [&weight_of, &|_| 1.0];
            for weight in weights {
                let (has_weight, is_within) = sum(weight, 1.0);
                if !has_weight {
                    continue;
                }
                // The mean of numbers is one, even where their sum leaves the range.
                if !is_within {
                    sum(weight, TINY);
                }
                break;
            }
        });
        for own in grid.hanging.iter().flat_map(|hanging| hanging.iter()) {
            for k in 0..n {
                let terms = own.corners.iter().zip(own.weights).map(|(&p, w)| w * means[p as usize * n + k]);
                means[own.point as usize * n + k] = terms.sum::<f64>().clamp(f64::MIN, f64::MAX);
            }
        }
        if let Some(boundary) = boundary {
            boundary.set_means(&mut means, n);
        }
        means
    };
    let converted = cells.converted(average);
    set(grid, converted);
}

/// Adds the point array that is made of an array of the file's cells, as a reader makes it.
///
/// # Errors
/// - cells that keep constant values need too many points.
pub fn add_from_cells(grid: &mut Grid, name: &str, array: Array, conversion: CellValues) -> Result<()> {
    grid.point_arrays.remove(name);
    let arrays = BTreeMap::from([(name.to_owned(), array)]);
    let cells = CellArrays { scalar: None, arrays, boundary: BTreeMap::new() };
    match conversion {
        CellValues::Average => average(grid, cells),
        CellValues::Constant => keep_constant(grid, cells)?,
    }
    Ok(())
}

/// Volume of every cell of the file up to the last one that is drawn, in units that keep it in the number range.
fn volumes_of_cells(grid: &Grid) -> Vec<f64> {
    let scale = grid.length_scale();
    let volumes: Vec<f64> = (0..grid.tetrahedra.len())
        .into_par_iter()
        .with_min_len(4096)
        .map(|i| tetrahedron_volume(grid.corners(i).map(|p| p * scale)))
        .collect();
    let Some(source_cells) = &grid.source_cells else { return volumes };
    let mut sums = vec![0.0; source_cells.iter().max().map_or(0, |&last| last as usize + 1)];
    for (&cell, volume) in source_cells.iter().zip(volumes) {
        sums[cell as usize] += volume;
    }
    sums
}

fn set(grid: &mut Grid, converted: CellArrays) {
    if let Some(scalar) = converted.scalar {
        (grid.scalar_name, grid.scalar) = (scalar.name, Some(scalar.values));
    }
    for (name, array) in converted.arrays {
        // A point array of the same name is the better one.
        grid.point_arrays.entry(name).or_insert_with(|| Arc::new(array));
    }
}

/// Gives every cell of the file points of its own, which carry the cell's values.
pub(super) fn keep_constant(grid: &mut Grid, cells: CellArrays) -> Result<()> {
    if cells.is_empty() {
        return Ok(());
    }
    let mut old_points: Vec<u32> = Vec::with_capacity(grid.tetrahedra.len() * 4);
    let mut owners: Vec<u32> = Vec::with_capacity(grid.tetrahedra.len() * 4);
    let mut tetrahedra = Vec::with_capacity(grid.tetrahedra.len());
    let mut own: Vec<u32> = Vec::new();
    let mut i = 0;
    while i < grid.tetrahedra.len() {
        let cell = grid.source_cell(i);
        let end = (i..grid.tetrahedra.len()).find(|&k| grid.source_cell(k) != cell);
        let parts = &grid.tetrahedra[i..end.unwrap_or(grid.tetrahedra.len())];
        own.clear();
        own.extend(parts.as_flattened());
        own.sort_unstable();
        own.dedup();
        let number = |p: u32| (old_points.len() + own.partition_point(|&q| q < p)) as u32;
        tetrahedra.extend(parts.iter().map(|t| t.map(number)));
        old_points.extend_from_slice(&own);
        owners.resize(old_points.len(), cell as u32);
        i += parts.len();
    }
    let what = "cells that keep constant values need too many points";
    number(old_points.len(), what, " (or values averaged to the points)")?;
    (grid.file_cells, grid.ghosts, grid.hanging) = (None, None, None);
    grid.points = old_points.par_iter().map(|&p| grid.points[p as usize]).collect::<Vec<_>>().into();
    grid.tetrahedra = tetrahedra.into();
    let scalar_on_points = grid.scalar.take();
    grid.scalar = scalar_on_points.map(|s| gather(&s, 1, &old_points).into());
    for array in grid.point_arrays.values_mut() {
        let n = array.component_count;
        *array = Arc::new(Array { component_count: n, values: gather(&array.values, n, &old_points).into() });
    }
    set(grid, cells.converted(|values, component_count, _| gather(values, component_count, &owners)));
    Ok(())
}

/// The tuples with these numbers.
pub(super) fn gather(values: &[f64], component_count: usize, numbers: &[u32]) -> Vec<f64> {
    let n = component_count.max(1);
    let mut out = vec![0.0; numbers.len() * n];
    out.par_chunks_mut(n).with_min_len(4096).zip(numbers).for_each(|(tuple, &number)| {
        let start = number as usize * n;
        tuple.copy_from_slice(&values[start..start + n]);
    });
    out
}
