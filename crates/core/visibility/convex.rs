//! Convexity of a grid: no ray that leaves a convex one meets it again.
//!
//! A closed connected surface that does not cross itself and is convex at each of its places bounds a convex body (van
//! Heijenoort, On locally convex manifolds, 1952; checked likewise by Mehlhorn et al., Checking geometric programs or
//! verification of geometric structures, 1999). Checked are the edges; that the faces at a point form one ring follows from
//! Euler's formula for one sphere. Overlapping cells, of which a surface that crosses itself consists, are found elsewhere.

use glam::DVec3;

/// Distance of a corner from the plane of the adjacent face (fraction of the grid's diagonal) below which it lies in it: rounding,
/// which leaves gaps of this width between a grid and its hull.
const PLANE_TOLERANCE: f64 = 1e-12;

/// Face of one cell alone.
pub(super) struct BoundaryFace {
    /// Corners, as the first points at their places.
    pub corners: [u32; 3],
    /// True if the cell is on the side to which the corners' normal points.
    pub is_cell_at_normal: bool,
}

/// True if the boundary is one convex surface. `diagonal`: that of the grid (world units).
pub(super) fn is_convex(boundary: &[BoundaryFace], points: &[DVec3], diagonal: f64) -> bool {
    // Ends of each edge of each face, and the face.
    let mut edges: Vec<([u32; 2], usize)> = Vec::with_capacity(3 * boundary.len());
    for (number, face) in boundary.iter().enumerate() {
        let [a, b, c] = face.corners;
        edges.extend([[a, b], [b, c], [c, a]].map(|[p, q]| ([p.min(q), p.max(q)], number)));
    }
    edges.sort_unstable();
    let mut groups = Groups::new(boundary.len());
    let mut edge_count = 0;
    for shared in edges.chunk_by(|a, b| a.0 == b.0) {
        let [(ends, one), (_, other)] = *shared else { return false };
        if !is_convex_edge(boundary, points, diagonal, ends, [one, other]) {
            return false;
        }
        groups.join(one, other);
        edge_count += 1;
    }
    let mut seen: Vec<u32> = edges.iter().flat_map(|(ends, _)| *ends).collect();
    seen.sort_unstable();
    seen.dedup();
    let is_one = (1..boundary.len()).all(|face| groups.first(face) == groups.first(0));
    is_one && seen.len() + boundary.len() == edge_count + 2
}

/// True if the third corner of each face lies behind the plane of the other, or in it.
fn is_convex_edge(
    boundary: &[BoundaryFace],
    points: &[DVec3],
    diagonal: f64,
    ends: [u32; 2],
    [one, other]: [usize; 2],
) -> bool {
    let at = |p: u32| points[p as usize];
    let third = |face: usize| boundary[face].corners.into_iter().find(|p| !ends.contains(p));
    // From either side: a face without area has no plane.
    [(one, other), (other, one)].into_iter().all(|(face, beside)| {
        let [a, b, c] = boundary[face].corners.map(at);
        let normal = (b - a).cross(c - a);
        let outwards = if boundary[face].is_cell_at_normal { -normal } else { normal };
        third(beside).is_none_or(|p| outwards.dot(at(p) - a) <= PLANE_TOLERANCE * diagonal * normal.length())
    })
}

/// Connected components of faces (union-find).
struct Groups(Vec<usize>);

impl Groups {
    fn new(count: usize) -> Groups {
        Groups((0..count).collect())
    }

    /// Representative of the component of a face.
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
