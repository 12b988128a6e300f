//! Values that sit on cells, as values of points.

use super::parts::{Association, Parts, Scalar};
use super::{Array, Grid, tetrahedron_volume};
use crate::{Error, Result};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Arrays that sit on cells.
pub(super) struct CellArrays {
    scalar: Option<Scalar>,
    arrays: BTreeMap<String, Array>,
}

impl CellArrays {
    fn is_empty(&self) -> bool {
        self.scalar.is_none() && self.arrays.is_empty()
    }
}

/// Takes what sits on cells out of the parts.
pub(super) fn take(parts: &mut Parts) -> CellArrays {
    let on_cells = parts.scalar.as_ref().is_some_and(|s| s.association == Association::Cell);
    CellArrays {
        scalar: if on_cells { parts.scalar.take() } else { None },
        arrays: std::mem::take(&mut parts.cell_arrays),
    }
}

/// Gives every point the mean over the cells of the file that use it, weighted by their volume (the sum of their
/// tetrahedra's); where all these volumes are zero, the plain mean.
pub(super) fn average(grid: &mut Grid, cells: CellArrays) {
    if cells.is_empty() {
        return;
    }
    let weights = Weights::of(grid);
    let point_count = grid.points.len();
    let average =
        |values: &[f64], component_count: usize| weights.average(point_count, values, component_count);
    let scalar = cells.scalar.map(|s| (s.name, average(&s.values, 1)));
    let arrays: Vec<(String, Array)> = cells
        .arrays
        .into_iter()
        .map(|(name, a)| {
            let values = average(&a.values, a.component_count);
            (name, Array { component_count: a.component_count, values })
        })
        .collect();
    set(grid, scalar, arrays);
}

fn set(grid: &mut Grid, scalar: Option<(String, Vec<f64>)>, arrays: Vec<(String, Array)>) {
    if let Some((name, values)) = scalar {
        grid.scalar_name = name;
        grid.scalar = Some(Arc::new(values));
    }
    for (name, array) in arrays {
        // A point array of the same name is the better one.
        grid.point_arrays.entry(name).or_insert_with(|| Arc::new(array));
    }
}

/// The cells that use each point, and their volumes.
struct Weights {
    /// (point, cell, volume) of every use, grouped by cell.
    uses: Vec<(u32, u32)>,
    /// Volume by cell of the file, scaled so that the largest is 1.
    volumes: Vec<f64>,
}

impl Weights {
    fn of(grid: &Grid) -> Self {
        let cell_of = |i: usize| grid.source_cells.as_ref().map_or(i as u32, |s| s[i]);
        let count = grid.tetrahedra.len();
        let cell_count = (0..count).into_par_iter().map(cell_of).max().map_or(0, |c| c as usize + 1);
        let mut volumes = vec![0.0; cell_count];
        let mut uses = Vec::with_capacity(count * 4);
        let mut start = 0;
        for i in 0..count {
            let cell = cell_of(i);
            if i > 0 && cell_of(i - 1) != cell {
                start = uses.len();
            }
            volumes[cell as usize] += tetrahedron_volume(grid.corners(i));
            for &p in &grid.tetrahedra[i] {
                if !uses[start..].contains(&(p, cell)) {
                    uses.push((p, cell));
                }
            }
        }
        let largest = volumes.iter().copied().fold(0.0, f64::max);
        if largest > 0.0 {
            volumes.par_iter_mut().for_each(|v| *v /= largest);
        }
        Weights { uses, volumes }
    }

    fn average(&self, point_count: usize, values: &[f64], component_count: usize) -> Vec<f64> {
        let n = component_count.max(1);
        let mut sums = vec![0.0; point_count * n];
        let mut weights = vec![0.0; point_count];
        self.accumulate(|cell| self.volumes[cell], values, n, &mut sums, &mut weights);
        if weights.contains(&0.0) {
            let (mut plain, mut counts) = (vec![0.0; point_count * n], vec![0.0; point_count]);
            self.accumulate(|_| 1.0, values, n, &mut plain, &mut counts);
            for p in 0..point_count {
                if weights[p] != 0.0 {
                    continue;
                }
                weights[p] = f64::max(counts[p], 1.0);
                sums[p * n..(p + 1) * n].copy_from_slice(&plain[p * n..(p + 1) * n]);
            }
        }
        for (tuple, weight) in sums.chunks_exact_mut(n).zip(&weights) {
            tuple.iter_mut().for_each(|v| *v /= weight);
        }
        sums
    }

    fn accumulate(
        &self,
        weight: impl Fn(usize) -> f64,
        values: &[f64],
        n: usize,
        sums: &mut [f64],
        weights: &mut [f64],
    ) {
        for &(p, cell) in &self.uses {
            let (p, cell) = (p as usize, cell as usize);
            let w = weight(cell);
            weights[p] += w;
            for c in 0..n {
                sums[p * n + c] += w * values[cell * n + c];
            }
        }
    }
}

/// Gives every cell of the file points of its own, which carry the cell's values.
pub(super) fn keep_constant(grid: &mut Grid, cells: CellArrays) -> Result<()> {
    if cells.is_empty() {
        return Ok(());
    }
    let cell_of = |i: usize| grid.source_cells.as_ref().map_or(i as u32, |s| s[i]);
    let mut old_points: Vec<u32> = Vec::with_capacity(grid.tetrahedra.len() * 4);
    let mut owners: Vec<u32> = Vec::with_capacity(grid.tetrahedra.len() * 4);
    let mut tetrahedra = Vec::with_capacity(grid.tetrahedra.len());
    let mut start = 0;
    let mut i = 0;
    while i < grid.tetrahedra.len() {
        let cell = cell_of(i);
        let mut end = i + 1;
        while end < grid.tetrahedra.len() && cell_of(end) == cell {
            end += 1;
        }
        for t in &grid.tetrahedra[i..end] {
            old_points.extend_from_slice(t);
        }
        old_points[start..].sort_unstable();
        let mut kept = start;
        for k in start..old_points.len() {
            if k == start || old_points[k] != old_points[kept - 1] {
                old_points[kept] = old_points[k];
                kept += 1;
            }
        }
        old_points.truncate(kept);
        owners.resize(kept, cell);
        for t in &grid.tetrahedra[i..end] {
            let own = &old_points[start..];
            tetrahedra.push(t.map(|p| (start + own.partition_point(|&q| q < p)) as u32));
        }
        start = kept;
        i = end;
    }
    if u32::try_from(old_points.len()).is_err() {
        return Err(Error::run("cells that keep constant values need too many points")
            .found(old_points.len())
            .accepted(format!("at most {} (or values averaged to the points)", u32::MAX)));
    }
    grid.points = Arc::new(old_points.par_iter().map(|&p| grid.points[p as usize]).collect());
    grid.tetrahedra = Arc::new(tetrahedra);
    let scalar_on_points = grid.scalar.take();
    grid.scalar = scalar_on_points.map(|s| Arc::new(gather(&s, 1, &old_points)));
    for array in grid.point_arrays.values_mut() {
        let n = array.component_count;
        *array = Arc::new(Array { component_count: n, values: gather(&array.values, n, &old_points) });
    }
    let scalar = cells.scalar.map(|s| (s.name, gather(&s.values, 1, &owners)));
    let arrays = cells
        .arrays
        .into_iter()
        .map(|(name, a)| {
            let values = gather(&a.values, a.component_count, &owners);
            (name, Array { component_count: a.component_count, values })
        })
        .collect();
    set(grid, scalar, arrays);
    Ok(())
}

/// The tuples with these numbers.
fn gather(values: &[f64], component_count: usize, numbers: &[u32]) -> Vec<f64> {
    let n = component_count.max(1);
    let mut out = vec![0.0; numbers.len() * n];
    out.par_chunks_mut(n).with_min_len(4096).zip(numbers).for_each(|(tuple, &number)| {
        let start = number as usize * n;
        tuple.copy_from_slice(&values[start..start + n]);
    });
    out
}
