//! Tests of the tetrahedralisation: volumes, shared faces, the rule of the lowest corner, what is left out.

mod boxes;
mod cell_edges;
mod cell_sets;
mod curved;
mod higher_order;
mod linear;
mod overlap;
mod parts;
mod pieces;
mod polyhedra;
mod subsets;
mod surfaces;
mod values;

use super::generate::Random;
use super::*;
use crate::Result;
use glam::DVec3;
use std::collections::HashMap;

pub(super) const UNIT: [DVec3; 2] = [DVec3::ZERO, DVec3::ONE];

pub(super) fn total_volume(grid: &Grid) -> f64 {
    (0..grid.tetrahedra.len()).map(|i| tetrahedron_volume(grid.corners(i))).sum()
}

/// Triangles by how many tetrahedra they belong to.
pub(super) fn triangle_uses(grid: &Grid) -> HashMap<[u32; 3], u32> {
    let mut uses = HashMap::new();
    for &[a, b, c, d] in grid.tetrahedra.iter() {
        for face in [[a, b, c], [a, b, d], [a, c, d], [b, c, d]] {
            *uses.entry(face).or_default() += 1;
        }
    }
    uses
}

/// No triangle belongs to more than two tetrahedra, those of one lie on the boundary of the unit cube, and the
/// tetrahedra fill it without overlap.
pub(super) fn assert_fills_unit_cube(grid: &Grid, what: &str) {
    assert!(grid.tetrahedra.iter().all(|t| t.is_sorted()), "{what}: corners ascend");
    for (face, uses) in triangle_uses(grid) {
        let corners = face.map(|p| grid.points[p as usize]);
        // Flat tetrahedra in two planes have the line in which they meet as a face.
        if (corners[1] - corners[0]).cross(corners[2] - corners[0]).length() < 1e-12 {
            continue;
        }
        assert!(uses <= 2, "{what}: {face:?} used {uses} times");
        let on_boundary = (0..3).any(|axis| {
            [0.0, 1.0].iter().any(|&side| corners.iter().all(|c| (c[axis] - side).abs() < 1e-12))
        });
        assert!(uses == 2 || on_boundary, "{what}: {face:?} inside has one neighbour");
    }
    // 1e-12: sums of some thousand volumes of order 1e-3, each right to a few ulp.
    let volume = total_volume(grid);
    assert!((volume - 1.0).abs() < 1e-12, "{what}: volume {volume}");
}

/// Renumbers the points at random, so that every case of the splits occurs.
pub(super) fn shuffled(mut parts: RawGrid, seed: u64) -> RawGrid {
    let mut random = Random(seed);
    let n = parts.points.len();
    let mut new_number: Vec<u32> = (0..n as u32).collect();
    for i in (1..n).rev() {
        new_number.swap(i, (random.next() * (i + 1) as f64) as usize);
    }
    let mut points = parts.points.to_vec();
    for (old, &new) in new_number.iter().enumerate() {
        points[new as usize] = parts.points[old];
    }
    parts.points = points.into();
    let Cells::Mixed(set) = &mut parts.cells else { panic!("mixed cells") };
    set.connectivity.iter_mut().for_each(|p| *p = new_number[*p as usize]);
    for polyhedron in &mut set.polyhedra {
        polyhedron.faces.iter_mut().flatten().for_each(|p| *p = new_number[*p as usize]);
    }
    parts
}
