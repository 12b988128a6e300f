//! Subsets of a grid: some of its cells, whole or cut where a field has a value, with all that lies on them.
//!
//! A tetrahedron that is cut leaves a tetrahedron or a wedge, which is split from its corner of lowest number as the cells of a file
//! are (see [`super::split`]), so that neighbours share the same triangles: the cut is watertight, and exact for a field that is linear
//! in each tetrahedron.

use super::contour::{Level, inside_first};
use super::grid_surface::{EdgePoint, edge_key, numbered};
use super::split::{WEDGE_FACES, emit_distinct, star};
use super::{Array, Grid};
use crate::progress::{Progress, refuse_beyond_memory};
use crate::{Result, counted};
use rayon::prelude::*;
use std::ops::{Add, Mul, Sub};
use std::sync::Arc;

/// Cells of a chunk of work.
const CHUNK: usize = 1 << 13;

/// Cells of a grid or parts of them.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Subset {
    /// The points: those of the grid, and on edges of its cells.
    pub points: Vec<EdgePoint>,
    /// Four points each, ascending.
    pub tetrahedra: Vec<[u32; 4]>,
    /// For each the tetrahedron of the grid that it is, or is a part of.
    pub origins: Vec<u32>,
}

/// Keys of the corners of tetrahedra, and the tetrahedra of the grid that they are parts of.
type Keyed = (Vec<[u64; 4]>, Vec<u32>);

/// Whole tetrahedra, of those numbers for which `is_kept` holds.
///
/// Errors: memory ends.
pub fn whole_cells(
    grid: &Grid,
    is_kept: impl Fn(usize) -> bool + Sync,
    progress: &dyn Progress,
) -> Result<Subset> {
    let keep = |(cells, origins): &mut Keyed, number: usize, corners: &[u32; 4]| {
        if is_kept(number) {
            cells.push(corners.map(|p| edge_key([p; 2])));
            origins.push(number as u32);
        }
    };
    collected(grid, keep, |_| 0.0, progress)
}

/// The parts of the tetrahedra in which a field, one value a point and linear in each, is at least `value`. Cells with values that are
/// not finite are left out.
///
/// Errors: another number of values than points; memory ends.
pub fn cells_above(grid: &Grid, field: &[f64], value: f64, progress: &dyn Progress) -> Result<Subset> {
    grid.check_values("the field", field)?;
    let level = Level { field, value };
    let keep = |(cells, origins): &mut Keyed, number: usize, corners: &[u32; 4]| {
        let own = |p: u32| edge_key([p; 2]);
        let cut = |a: u32, b: u32| level.key(a, b);
        let mask = level.inside(corners);
        let mut emit = |cell| {
            cells.push(cell);
            origins.push(number as u32);
        };
        match mask.count_ones() {
            4 => emit(corners.map(own)),
            3 => {
                let [l, i, j, k] = inside_first(15 - mask, corners);
                let wedge = [own(i), own(j), own(k), cut(i, l), cut(j, l), cut(k, l)];
                star(&wedge, WEDGE_FACES, &mut emit);
            }
            2 => {
                let [i, j, k, l] = inside_first(mask, corners);
                let wedge = [own(i), cut(i, k), cut(i, l), own(j), cut(j, k), cut(j, l)];
                star(&wedge, WEDGE_FACES, &mut emit);
            }
            1 => {
                let [i, j, k, l] = inside_first(mask, corners);
                emit_distinct([own(i), cut(i, j), cut(i, k), cut(i, l)], &mut emit);
            }
            _ => {}
        }
    };
    collected(grid, keep, |ends| level.share(ends), progress)
}

/// The subset of what `keep` adds for each cell.
fn collected(
    grid: &Grid,
    keep: impl Fn(&mut Keyed, usize, &[u32; 4]) + Sync,
    share: impl Fn([u32; 2]) -> f64 + Sync,
    progress: &dyn Progress,
) -> Result<Subset> {
    progress.check_cancelled()?;
    let chunk = |(chunk, cells): (usize, &[[u32; 4]])| {
        let mut keyed = Keyed::default();
        (chunk * CHUNK..).zip(cells).for_each(|(number, corners)| keep(&mut keyed, number, corners));
        keyed
    };
    let chunks: Vec<Keyed> = grid.tetrahedra.par_chunks(CHUNK).enumerate().map(chunk).collect();
    let count: usize = chunks.iter().map(|(cells, _)| cells.len()).sum();
    // Keys twice and sorted, and the cells of numbers.
    let bytes = count as u64 * (2 * 32 + 32 + 16);
    refuse_beyond_memory(progress, || format!("a subset of {}", counted(count, "tetrahedron")), bytes)?;
    let (cells, origins): (Vec<_>, Vec<_>) = chunks.into_iter().unzip();
    let (points, mut tetrahedra) = numbered(&cells.concat(), share);
    tetrahedra.par_iter_mut().for_each(|corners| corners.sort_unstable());
    Ok(Subset { points, tetrahedra, origins: origins.concat() })
}

impl Subset {
    /// Adds the cells of another one; points are not joined.
    pub fn append(&mut self, other: Subset) {
        let before = self.points.len() as u32;
        self.points.extend(other.points);
        self.tetrahedra.extend(other.tetrahedra.into_iter().map(|corners| corners.map(|p| before + p)));
        self.origins.extend(other.origins);
    }

    /// The grid of these cells, with the arrays of points and cells and without a scalar. The numbers of the cells of the file stay;
    /// its own cells, and ghosts, are left out.
    pub fn grid(&self, whole: &Grid) -> Grid {
        let array = |array: &Arc<Array>| {
            let n = array.component_count;
            let at = |point: &EdgePoint, k: usize| point.value(|p| array.values[p as usize * n + k]);
            let values: Vec<f64> =
                self.points.iter().flat_map(|point| (0..n).map(move |k| at(point, k))).collect();
            Arc::new(Array { component_count: n, values: values.into() })
        };
        let cells = self.origins.iter().map(|&i| whole.source_cell(i as usize) as u32).collect();
        Grid {
            points: self.of_points(|p| whole.points[p as usize]).into(),
            tetrahedra: self.tetrahedra.clone().into(),
            source_cells: Some(Arc::new(cells)),
            scalar: None,
            scalar_name: whole.scalar_name.clone(),
            point_arrays: whole.point_arrays.iter().map(|(name, own)| (name.clone(), array(own))).collect(),
            cell_arrays: whole.cell_arrays.clone(),
            ghosts: None,
            file_cells: None,
            hanging: None,
            origin: whole.origin.clone(),
        }
    }

    /// Values at the points, from those at the points of the grid: linear on edges.
    pub fn of_points<T>(&self, at: impl Fn(u32) -> T + Sync) -> Vec<T>
    where
        T: Copy + Send + Add<Output = T> + Sub<Output = T> + Mul<f64, Output = T>,
    {
        self.points.par_iter().map(|point| point.value(&at)).collect()
    }
}

/// For each tetrahedron: true where all points of its cell of the file hold, or any of them.
pub fn cells_by_points(grid: &Grid, is_all: bool, holds: impl Fn(u32) -> bool) -> Vec<bool> {
    let mut kept = Vec::with_capacity(grid.tetrahedra.len());
    while kept.len() < grid.tetrahedra.len() {
        // The tetrahedra of a cell follow one another.
        let first = kept.len();
        let cell = grid.source_cell(first);
        let end = (first..grid.tetrahedra.len()).find(|&i| grid.source_cell(i) != cell);
        let end = end.unwrap_or(grid.tetrahedra.len());
        let mut points = grid.tetrahedra[first..end].as_flattened().iter();
        let is_kept = if is_all { points.all(|&p| holds(p)) } else { points.any(|&p| holds(p)) };
        kept.resize(end, is_kept);
    }
    kept
}
