//! Contours: the places where a field that is linear in each tetrahedron has a value, by marching tetrahedra (Doi and Koide 1991, An
//! efficient method of triangulating equi-valued surfaces by using tetrahedral cells, IEICE Transactions E74(1)).
//!
//! A point is inside where f ≥ value, so that each edge is cut or not for all of its cells alike. Neighbours share the points on
//! their edges, and a cut at an end of an edge is that end: no cracks, and triangles without area are left out.

use super::Grid;
use super::grid_surface::{GridSurface, edge_key};
use crate::progress::{Progress, refuse_beyond_memory};
use crate::{Result, counted};
use rayon::prelude::*;

/// Cells of a chunk of work.
const CHUNK: usize = 1 << 13;

/// For each set of corners inside (bit k: corner k), up to two of them: these first, in an even permutation of all.
const INSIDE_FIRST: [[usize; 4]; 16] = {
    const NONE: [usize; 4] = [0, 1, 2, 3];
    [
        NONE, // 0000
        [0, 1, 2, 3],
        [1, 0, 3, 2],
        [0, 1, 2, 3], // 0011
        [2, 3, 0, 1],
        [0, 2, 3, 1], // 0101
        [1, 2, 0, 3], // 0110
        NONE,
        [3, 2, 1, 0],
        [0, 3, 1, 2], // 1001
        [3, 1, 0, 2], // 1010
        NONE,
        [2, 3, 0, 1], // 1100
        NONE,
        NONE,
        NONE,
    ]
};

/// A field, one value a point, at a value.
pub(super) struct Level<'a> {
    pub field: &'a [f64],
    pub value: f64,
}

impl Level<'_> {
    /// The set of a cell's corners inside (bit k: corner k); none where a value is not finite.
    pub fn inside(&self, corners: &[u32; 4]) -> usize {
        let of = corners.map(|p| self.field[p as usize]);
        let is_finite = of.iter().all(|f| f.is_finite());
        (0..4).map(|k| usize::from(is_finite && of[k] >= self.value) << k).sum()
    }

    /// Share of the way along an edge where the field has the value.
    pub fn share(&self, ends: [u32; 2]) -> f64 {
        let [from, to] = ends.map(|p| self.field[p as usize]);
        match to - from {
            0.0 => 0.0,
            span if span.is_finite() => (self.value - from) / span,
            _ => (0.5 * self.value - 0.5 * from) / (0.5 * to - 0.5 * from),
        }
    }

    /// The key of that point. Its ends ascend, so that all cells of the edge have them in one order.
    pub fn key(&self, a: u32, b: u32) -> u64 {
        let [a, b] = [a.min(b), a.max(b)];
        match self.share([a, b]) {
            0.0 => edge_key([a, a]),
            1.0 => edge_key([b, b]),
            _ => edge_key([a, b]),
        }
    }
}

/// Corners of a cell, those inside first, in an even permutation.
pub(super) fn inside_first(inside: usize, corners: &[u32; 4]) -> [u32; 4] {
    INSIDE_FIRST[inside].map(|k| corners[k])
}

/// Triangles where a field, one value a point, has a value; outside it is less. Cells with values that are not finite are left out.
///
/// Errors: another number of values than points; memory ends.
pub fn contour(grid: &Grid, values: &[f64], value: f64, progress: &dyn Progress) -> Result<GridSurface> {
    grid.check_values("the field", values)?;
    let level = Level { field: values, value };
    let is_cut = |corners: &&[u32; 4]| !matches!(level.inside(corners), 0 | 15);
    let cut = grid.tetrahedra.par_iter().with_min_len(CHUNK).filter(is_cut).count();
    // Two triangles of three keys, the sorted keys, and what is made of them.
    let bytes = cut as u64 * 2 * (24 + 24 + 24 + 12);
    refuse_beyond_memory(progress, || format!("a surface through {}", counted(cut, "tetrahedron")), bytes)?;
    progress.check_cancelled()?;
    let key = |a, b| level.key(a, b);
    let scale = grid.length_scale();
    let cell = |triangles: &mut Vec<[u64; 3]>, (number, corners): (usize, &[u32; 4])| {
        let mask = level.inside(corners);
        let is_most = mask.count_ones() == 3;
        let [i, j, k, l] = inside_first(if is_most { 15 - mask } else { mask }, corners);
        let mut add = |[a, b, c]: [u64; 3]| {
            let [p, q, r, s] = grid.corners(number);
            let is_positive = ((q - p) * scale).dot(((r - p) * scale).cross((s - p) * scale)) >= 0.0;
            if a != b && b != c && c != a {
                triangles.push(if is_positive != is_most { [a, b, c] } else { [a, c, b] });
            }
        };
        match mask.count_ones() {
            1 | 3 => add([key(i, j), key(i, k), key(i, l)]),
            2 => {
                add([key(i, k), key(i, l), key(j, l)]);
                add([key(i, k), key(j, l), key(j, k)]);
            }
            _ => {}
        }
    };
    let chunk = |(chunk, cells): (usize, &[[u32; 4]])| {
        let mut triangles = Vec::new();
        (chunk * CHUNK..).zip(cells).for_each(|of| cell(&mut triangles, of));
        triangles
    };
    let triangles: Vec<Vec<[u64; 3]>> = grid.tetrahedra.par_chunks(CHUNK).enumerate().map(chunk).collect();
    Ok(GridSurface::of_keys(&triangles.concat(), |ends| level.share(ends)))
}
