//! Cells that overlap their neighbours: on the same side of a shared face.
//!
//! Two cells of a grid that fills space once lie on different sides of the face that they share. Cells that are there twice,
//! that are folded over, or that are joined three to a face are found by that; [`super::within`] finds those that overlap and
//! share no face. Points at one place count as one, so that pieces that hold the same cells are seen.

use super::faces::{CoincidentPoints, Face, each_face};
use glam::DVec3;
use rayon::prelude::*;

/// A tetrahedron whose height over a face is less than this share of the distance of its fourth corner has no side that
/// rounding could not turn.
const FLATNESS_TOLERANCE: f64 = 1e-9;

/// Boundary faces of a grid, and counts of faces that show overlapping cells.
#[derive(Debug, PartialEq)]
pub(super) struct BoundaryFaces {
    /// The tetrahedra that lie on the same side of a face as another one does, ascending.
    pub overlapping: Vec<u32>,
    /// The faces of one cell alone, the grid's boundary: the cell and the point opposite (the first at its place),
    /// ascending.
    pub boundary: Vec<[u32; 2]>,
}

/// Looks at all faces of tetrahedra (corners ascending).
pub(super) fn faces(points: &[DVec3], tetrahedra: &[[u32; 4]]) -> BoundaryFaces {
    let none = || BoundaryFaces { overlapping: Vec::new(), boundary: Vec::new() };
    let look = |found: &mut BoundaryFaces, p, shared: &[Face]| look_at(points, p, shared, found);
    let mut found =
        each_face(points, tetrahedra, &CoincidentPoints::find(points), none, look, |mut all, mut more| {
            all.overlapping.append(&mut more.overlapping);
            all.boundary.append(&mut more.boundary);
            all
        });
    found.overlapping.par_sort_unstable();
    found.overlapping.dedup();
    found.boundary.par_sort_unstable();
    found
}

/// Adds the cells of a face that lie on one side of it with another one, and the face of one cell.
fn look_at(points: &[DVec3], p: u32, shared: &[Face], found: &mut BoundaryFaces) {
    if let [[_, _, cell, opposite]] = *shared {
        found.boundary.push([cell, opposite]);
        return;
    }
    let [origin, q, r] = [p, shared[0][0], shared[0][1]].map(|point| points[point as usize]);
    let normal = (q - origin).cross(r - origin);
    for which in [-1.0, 1.0] {
        let there = shared.iter().filter(|face| side(normal, points[face[3] as usize] - origin) == which);
        if there.clone().count() > 1 {
            found.overlapping.extend(there.map(|face| face[2]));
        }
    }
}

/// The side of a face with this normal on which a corner lies, `apart` from a point of the face: 1 or -1; 0 where rounding
/// could turn it.
pub(crate) fn side(normal: DVec3, apart: DVec3) -> f64 {
    let height = normal.dot(apart);
    let is_clear = height.abs() > FLATNESS_TOLERANCE * normal.length() * apart.length();
    if is_clear { height.signum() } else { 0.0 }
}
