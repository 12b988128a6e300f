//! Convexity of a grid: no ray that leaves it meets it again.
//!
//! A closed connected surface that does not cross itself and is convex at each of its places bounds a convex body (van
//! Heijenoort, On locally convex manifolds, 1952; checked likewise by Mehlhorn et al., Checking geometric programs or
//! verification of geometric structures, 1999). Looked at are the edges; that the faces at a point form one ring follows from
//! Euler's formula for one sphere. Cells that overlap, of which a surface that crosses itself is made, are found elsewhere.

use super::corners::face_of;
use super::faces::Faces;
use crate::grid::faces::CoincidentPoints;
use glam::DVec3;

/// A corner behind the plane of the face next to it by less than this share of the grid's diagonal lies in it: rounding, which
/// leaves gaps of this width between a grid and its hull.
const PLANE: f64 = 1e-12;

/// True if the boundary is one convex surface.
pub(super) fn is_convex(
    faces: &Faces,
    points: &[DVec3],
    cells: &[[u32; 4]],
    places: &CoincidentPoints,
) -> bool {
    let corners = |(cell, k): (u32, usize)| face_of(cells[cell as usize], k).map(|p| places.first(p));
    // Of each edge of each outer face: its ends, and the face.
    let mut edges: Vec<([u32; 2], usize)> = Vec::with_capacity(3 * faces.outer.len());
    for (number, face) in faces.outer.iter().enumerate() {
        let [a, b, c] = corners(*face);
        edges.extend([[a, b], [b, c], [c, a]].map(|[p, q]| ([p.min(q), p.max(q)], number)));
    }
    edges.sort_unstable();
    let mut groups = Groups::new(faces.outer.len());
    let mut edge_count = 0;
    for shared in edges.chunk_by(|a, b| a.0 == b.0) {
        let [(ends, one), (_, other)] = *shared else { return false };
        if !is_convex_edge(faces, points, &corners, ends, [one, other]) {
            return false;
        }
        groups.join(one, other);
        edge_count += 1;
    }
    let mut seen: Vec<u32> = edges.iter().flat_map(|(ends, _)| *ends).collect();
    seen.sort_unstable();
    seen.dedup();
    let is_one = (1..faces.outer.len()).all(|face| groups.first(face) == groups.first(0));
    is_one && seen.len() + faces.outer.len() == edge_count + 2
}

/// True if the third corner of one face lies behind the plane of the other, or in it.
fn is_convex_edge(
    faces: &Faces,
    points: &[DVec3],
    corners: &impl Fn((u32, usize)) -> [u32; 3],
    ends: [u32; 2],
    [one, other]: [usize; 2],
) -> bool {
    let at = |p: u32| points[p as usize];
    let third = |face: usize| corners(faces.outer[face]).into_iter().find(|p| !ends.contains(p));
    // From either side: a face without area has no plane.
    [(one, other), (other, one)].into_iter().all(|(face, beside)| {
        let [a, b, c] = corners(faces.outer[face]).map(at);
        let (cell, k) = faces.outer[face];
        let normal = (b - a).cross(c - a);
        let outwards = if faces.is_at_normal(cell, k) { -normal } else { normal };
        third(beside).is_none_or(|p| outwards.dot(at(p) - a) <= PLANE * faces.diagonal * normal.length())
    })
}

/// Connected components of faces (union-find).
struct Groups(Vec<usize>);

impl Groups {
    fn new(count: usize) -> Groups {
        Groups((0..count).collect())
    }

    /// The face that stands for all that hang together with this one.
    fn first(&mut self, mut face: usize) -> usize {
        while self.0[face] != face {
            self.0[face] = self.0[self.0[face]];
            face = self.0[face];
        }
        face
    }

    fn join(&mut self, a: usize, b: usize) {
        let [a, b] = [self.first(a), self.first(b)];
        self.0[a.max(b)] = a.min(b);
    }
}
