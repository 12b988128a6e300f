//! Uniform refinement: each tetrahedron in eight, points in the middles of its edges.
//!
//! Bey, "Tetrahedral Grid Refinement" (1995): four tetrahedra at the corners, and four around a diagonal of the octahedron
//! that they leave. Every face is cut in four by the middles of its edges, so neighbours match whatever the diagonal; the
//! shortest one is taken, which keeps cells from getting thin.

use glam::DVec3;
use rayon::prelude::*;
use voltet_core::grid::Grid;
use voltet_core::{Error, Result, SharedSlice};

/// A refined grid: points and tetrahedra alone, no values.
#[derive(Debug, Clone)]
pub struct RefinedGrid {
    /// The points of the coarse grid, then one in the middle of each edge; eight tetrahedra for each coarse one.
    pub grid: Grid,
    /// The coarse points between which each further point lies.
    pub ends: Vec<[u32; 2]>,
}

impl RefinedGrid {
    /// Values at the points of the refined grid: those of the coarse points, and what `middle` makes of the two ends of
    /// each edge.
    pub fn values<T: Copy + Send + Sync>(
        &self,
        coarse: &[T],
        middle: impl Fn([usize; 2]) -> T + Sync + Send,
    ) -> Vec<T> {
        let further = self.ends.par_iter().map(|ends| middle(ends.map(|p| p as usize)));
        coarse.par_iter().copied().chain(further).collect()
    }
}

/// The edges of a tetrahedron, by its corners.
const EDGES: [[usize; 2]; 6] = [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]];

/// The corners' tetrahedra: a corner and the middles of its edges, by their places in [`EDGES`].
const CORNERS: [[usize; 3]; 4] = [[0, 1, 2], [0, 3, 4], [1, 3, 5], [2, 4, 5]];

/// Opposite edges, whose middles span a diagonal of the octahedron, with the ring of middles around it.
const DIAGONALS: [([usize; 2], [usize; 4]); 3] =
    [([0, 5], [1, 2, 4, 3]), ([1, 4], [0, 2, 5, 3]), ([2, 3], [0, 1, 5, 4])];

/// Cuts every tetrahedron in eight.
///
/// Errors: more points or tetrahedra than 32 bits count.
pub fn refine(grid: &Grid) -> Result<RefinedGrid> {
    let key = |cell: &[u32; 4], [a, b]: [usize; 2]| {
        let (low, high) = (cell[a].min(cell[b]), cell[a].max(cell[b]));
        u64::from(low) << 32 | u64::from(high)
    };
    let mut edges: Vec<u64> =
        grid.tetrahedra.par_iter().flat_map_iter(|cell| EDGES.map(|edge| key(cell, edge))).collect();
    edges.par_sort_unstable();
    edges.dedup();
    let (point_count, cell_count) = (grid.points.len() + edges.len(), 8 * grid.tetrahedra.len());
    if u32::try_from(point_count).is_err() || u32::try_from(cell_count).is_err() {
        return Err(Error::run("the grid has too many cells to be refined")
            .got(format!("{point_count} points and {cell_count} cells"))
            .expected(format!("at most {} of either", u32::MAX)));
    }
    let ends: Vec<[u32; 2]> = edges.par_iter().map(|&key| [(key >> 32) as u32, key as u32]).collect();
    let further = ends.par_iter().map(|ends| {
        let [a, b] = ends.map(|p| grid.points[p as usize]);
        a + 0.5 * (b - a)
    });
    let points: Vec<DVec3> = grid.points.par_iter().copied().chain(further).collect();
    let first = grid.points.len() as u32;
    let tetrahedra: Vec<[u32; 4]> = grid
        .tetrahedra
        .par_iter()
        .flat_map_iter(|cell| {
            // Every edge is in the list.
            let middle = EDGES.map(|edge| first + edges.partition_point(|&k| k < key(cell, edge)) as u32);
            eight(cell, &middle, &points)
        })
        .collect();
    let grid = Grid {
        points: SharedSlice::from(points),
        tetrahedra: SharedSlice::from(tetrahedra),
        ..Grid::default()
    };
    Ok(RefinedGrid { grid, ends })
}

/// The parts of a cell.
fn eight(cell: &[u32; 4], middle: &[u32; 6], points: &[DVec3]) -> [[u32; 4]; 8] {
    let length = |&([a, b], _): &([usize; 2], [usize; 4])| {
        points[middle[a] as usize].distance_squared(points[middle[b] as usize])
    };
    let shortest = DIAGONALS.iter().min_by(|a, b| length(a).total_cmp(&length(b)));
    let ([a, b], ring) = shortest.unwrap_or(&DIAGONALS[0]);
    let mut parts = [[0; 4]; 8];
    for (k, edges) in CORNERS.iter().enumerate() {
        parts[k] = [cell[k], middle[edges[0]], middle[edges[1]], middle[edges[2]]];
    }
    for k in 0..4 {
        parts[4 + k] = [middle[*a], middle[*b], middle[ring[k]], middle[ring[(k + 1) % 4]]];
    }
    parts.iter_mut().for_each(|part| part.sort_unstable());
    parts
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashMap;
    use voltet_core::grid::generate::box_of_tetrahedra;
    use voltet_core::grid::tetrahedron_volume;

    #[test]
    fn eight_parts_fill_each_cell_and_neighbours_match() {
        let coarse = box_of_tetrahedra([2, 3, 2], [DVec3::ZERO, DVec3::new(1.0, 2.0, 0.5)], 0.2);
        let refined = refine(&refine(&coarse).unwrap().grid).unwrap();
        let grid = &refined.grid;
        assert_eq!(grid.tetrahedra.len(), 64 * coarse.tetrahedra.len());
        let volume = |grid: &Grid| -> f64 {
            (0..grid.tetrahedra.len()).map(|i| tetrahedron_volume(grid.corners(i))).sum()
        };
        // A sum of some thousand roundings.
        assert!((volume(grid) - volume(&coarse)).abs() < 1e-12);
        let least = (0..grid.tetrahedra.len()).map(|i| tetrahedron_volume(grid.corners(i)));
        assert!(least.fold(f64::INFINITY, f64::min) > 0.0);
        assert!(grid.tetrahedra.iter().all(|cell| cell.is_sorted()));
        // Every face belongs to two cells, but for those on the six sides of the box, which are 16 times as many.
        let on_sides = |grid: &Grid| {
            let mut faces: HashMap<[u32; 3], usize> = HashMap::new();
            for cell in grid.tetrahedra.iter() {
                for out in 0..4 {
                    let face: Vec<u32> = (0..4).filter(|&k| k != out).map(|k| cell[k]).collect();
                    *faces.entry([face[0], face[1], face[2]]).or_default() += 1;
                }
            }
            assert!(faces.values().all(|&count| count <= 2));
            faces.values().filter(|&&count| count == 1).count()
        };
        assert_eq!(on_sides(grid), 16 * on_sides(&coarse));
    }

    #[test]
    fn a_linear_field_stays_itself() {
        let coarse = box_of_tetrahedra([2, 2, 2], [DVec3::ZERO, DVec3::ONE], 0.2);
        let field = |p: &DVec3| 1.0 + 2.0 * p.x - p.y + 0.5 * p.z;
        let values: Vec<f64> = coarse.points.iter().map(field).collect();
        let refined = refine(&coarse).unwrap();
        let values = refined.values(&values, |[a, b]| 0.5 * (values[a] + values[b]));
        for (point, value) in refined.grid.points.iter().zip(values) {
            assert!((field(point) - value).abs() < 1e-14);
        }
    }
}
