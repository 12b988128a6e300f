//! Mesh: for each face of a volume's cells the face of another cell that it is shared with.

use crate::tolerances::{FLAT_CELL, THIN_CELL};
use rayon::prelude::*;
use voltet_core::grid::{Grid, cells_of_faces};

/// Cells of a chunk of work.
const CHUNK: usize = 1 << 13;

/// Side of the face of a cell's first three corners on which the fourth lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Side {
    /// In their plane.
    Flat,
    Positive,
    Negative,
}

/// Shared faces of a volume, whatever is drawn of it.
#[derive(Debug)]
pub(crate) struct Mesh {
    /// For each face (4 a cell, by the corner opposite) the face of the cell on its other side; [`NO_FACE`] where there is none, or none
    /// that lies on the other side.
    pub neighbours: Vec<u32>,
    pub(super) sides: Vec<Side>,
    /// The longest edge of all cells, and of those that are thin, world units.
    pub longest: [f64; 2],
}

/// No face.
pub(super) const NO_FACE: u32 = u32::MAX;

impl Mesh {
    pub fn new(grid: &Grid) -> Mesh {
        let corners = |cell: &[u32; 4]| cell.map(|p| grid.points[p as usize]);
        let measure = |cell: &[u32; 4]| {
            let [a, b, c, d] = corners(cell);
            let [e, f, g] = [b - a, c - a, d - a];
            let volume = e.dot(f.cross(g));
            let edges = [e, f, g, c - b, d - b, d - c].map(|edge| edge.length());
            let side = if volume.abs() <= FLAT_CELL * edges[0] * edges[1] * edges[2] {
                Side::Flat
            } else if volume > 0.0 {
                Side::Positive
            } else {
                Side::Negative
            };
            let longest = edges.into_iter().fold(0.0, f64::max);
            // Twice the largest face.
            let area = [e.cross(f), e.cross(g), f.cross(g), (c - b).cross(d - b)];
            let area = area.into_iter().map(|normal| normal.length()).fold(0.0, f64::max);
            let is_thin = volume.abs() < THIN_CELL * longest * area;
            (side, [longest, if is_thin { longest } else { 0.0 }])
        };
        let max = |a: [f64; 2], b: [f64; 2]| [a[0].max(b[0]), a[1].max(b[1])];
        let parts: Vec<(Vec<Side>, [f64; 2])> = grid
            .tetrahedra
            .par_chunks(CHUNK)
            .map(|cells| {
                let mut longest = [0.0; 2];
                let side = |cell| {
                    let (side, of_cell) = measure(cell);
                    longest = max(longest, of_cell);
                    side
                };
                let sides = cells.iter().map(side).collect();
                (sides, longest)
            })
            .collect();
        let longest = parts.iter().fold([0.0; 2], |longest, (_, of_part)| max(longest, *of_part));
        let sides = parts.into_iter().map(|(sides, _)| sides).collect::<Vec<_>>().concat();
        let mut neighbours = cells_of_faces(grid);
        // Cells without a volume are passed by: no ray comes in, and what lies beside them is at a boundary. Cells on one side of the face
        // that they share overlap.
        let is_opposite = |here: usize, there: usize| {
            let side = |half_face: usize| match sides[half_face / 4] {
                Side::Flat => None,
                side => Some((side == Side::Positive) == half_face.is_multiple_of(2)),
            };
            matches!((side(here), side(there)), (Some(one), Some(other)) if one != other)
        };
        neighbours.par_chunks_mut(CHUNK).enumerate().for_each(|(chunk, faces)| {
            for (k, there) in faces.iter_mut().enumerate() {
                if *there != NO_FACE && !is_opposite(chunk * CHUNK + k, *there as usize) {
                    *there = NO_FACE;
                }
            }
        });
        Mesh { neighbours, sides, longest }
    }
}
