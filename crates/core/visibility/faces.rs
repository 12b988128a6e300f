//! Neighbours of each cell across its faces, and the cell's side of each face: found once a grid, whatever the camera.
//!
//! A convex grid has no gaps: no ray that leaves it meets it again.
//! A closed connected surface that does not cross itself and is convex at each of its places bounds a convex body (van
//! Heijenoort, On locally convex manifolds, 1952; checked likewise by Mehlhorn et al., Checking geometric programs or
//! verification of geometric structures, 1999). Checked are the edges; that the faces at a point form one ring follows from
//! Euler's formula for one sphere. Overlapping cells, of which a surface that crosses itself consists, are found elsewhere.

use crate::grid::Grid;
use crate::grid::faces::{CoincidentPoints, Face, each_face, face_of};
use crate::grid::overlap::side;
use glam::DVec3;
use rayon::prelude::*;

/// No cell: beyond the face is none.
pub(super) const NO_CELL: u32 = u32::MAX;

/// Cells of a chunk of work.
pub(super) const CHUNK: usize = 1 << 12;

/// The cells of a grid with their neighbours. Takes 18 bytes a cell.
#[derive(Debug)]
pub struct Faces {
    /// For each corner of a cell the cell beyond the face opposite it; [`NO_CELL`] at the boundary.
    pub(super) neighbours: Vec<[u32; 4]>,
    /// For each corner, two bits: which corner of that neighbour is opposite the same face.
    theirs: Vec<u8>,
    /// True if the last corner lies on the side of the others that their normal, by the rule of the right hand, points to. Of
    /// a cell without volume: as its neighbours would have it.
    is_right_handed: Vec<bool>,
    /// The faces of one cell alone: the cell, and which of its corners is opposite.
    pub(super) outer: Vec<(u32, usize)>,
    /// Faces of three cells and more.
    pub(super) crowded: u64,
    /// Faces with both cells on one side.
    pub(super) folded: u64,
    /// True if no ray that leaves the grid meets it again.
    pub(super) is_convex: bool,
    /// The grid's diagonal.
    pub(super) diagonal: f64,
}

/// Faces matched in a range of points.
#[derive(Default)]
struct FaceMatches {
    /// A face of two cells, as each of them has it.
    pairs: Vec<[Face; 2]>,
    outer: Vec<Face>,
    crowded: u64,
}

impl Faces {
    /// Finds the faces of a grid.
    pub fn new(grid: &Grid) -> Faces {
        let (points, cells) = (&grid.points[..], &grid.tetrahedra[..]);
        let places = CoincidentPoints::find(points);
        let look = |found: &mut FaceMatches, _, shared: &[Face]| match *shared {
            [face] => found.outer.push(face),
            [a, b] => found.pairs.push([a, b]),
            _ => found.crowded += 1,
        };
        let found = each_face(points, cells, &places, FaceMatches::default, look, |mut all, mut more| {
            all.pairs.append(&mut more.pairs);
            all.outer.append(&mut more.outer);
            all.crowded += more.crowded;
            all
        });
        let corner = |face: &Face| {
            let corners = cells[face[2] as usize];
            corners.iter().position(|&p| places.first(p) == face[3]).unwrap_or_default()
        };
        let mut neighbours = vec![[NO_CELL; 4]; cells.len()];
        let mut theirs = vec![0u8; cells.len()];
        for [a, b] in &found.pairs {
            for (own, other) in [(a, b), (b, a)] {
                let (cell, k) = (own[2] as usize, corner(own));
                neighbours[cell][k] = other[2];
                theirs[cell] |= (corner(other) as u8) << (2 * k);
            }
        }
        let mut outer: Vec<(u32, usize)> = found.outer.iter().map(|face| (face[2], corner(face))).collect();
        outer.sort_unstable();
        let diagonal = grid.bounds().map_or(0.0, |[low, high]| (high - low).length());
        let mut faces = Faces {
            neighbours,
            theirs,
            is_right_handed: Vec::new(),
            outer,
            crowded: found.crowded,
            folded: 0,
            is_convex: false,
            diagonal,
        };
        faces.orient(points, cells, &places);
        let boundary_face = |&(cell, k): &(u32, usize)| BoundaryFace {
            corners: face_of(cells[cell as usize], k).map(|p| places.first(p)),
            is_cell_at_normal: faces.is_at_normal(cell, k),
        };
        let boundary: Vec<BoundaryFace> = faces.outer.iter().map(boundary_face).collect();
        faces.is_convex = is_convex(&boundary, points, diagonal);
        faces
    }

    /// Corner of the neighbour beyond the face opposite corner `k` that is opposite the same face.
    pub(super) fn theirs(&self, cell: u32, k: usize) -> usize {
        usize::from(self.theirs[cell as usize] >> (2 * k)) & 3
    }

    /// True if the cell lies on the side of its face opposite corner `k` to which the normal of [`crate::grid::faces::face_of`] points.
    pub(super) fn is_at_normal(&self, cell: u32, k: usize) -> bool {
        // Each corner on takes the others once more out of their turn.
        self.is_right_handed[cell as usize] == (k % 2 == 1)
    }

    /// Finds the cells' hands, and the faces that are folded.
    fn orient(&mut self, points: &[DVec3], cells: &[[u32; 4]], places: &CoincidentPoints) {
        let hand = |&cell: &[u32; 4]| {
            let [a, b, c, d] = cell.map(|p| points[p as usize]);
            side((b - a).cross(c - a), d - a)
        };
        let mut hands: Vec<f64> = cells.par_iter().with_min_len(CHUNK).map(hand).collect();
        // Whether two cells count the corners of a face that they share alike, or the other way round.
        let counts_alike = |cell: u32, k: usize, other: u32, r: usize| {
            let [own, other] = [(cell, k), (other, r)]
                .map(|(cell, k)| face_of(cells[cell as usize], k).map(|p| places.first(p)));
            (0..3).any(|turn| (0..3).all(|i| own[i] == other[(i + turn) % 3]))
        };
        // What the other cell of a face has for a hand where this one has 1.
        let beyond = |faces: &Faces, cell: u32, k: usize| {
            let (other, r) = (faces.neighbours[cell as usize][k], faces.theirs(cell, k));
            let same = (k % 2 == r % 2) == counts_alike(cell, k, other, r);
            (other, if same { -1.0 } else { 1.0 })
        };
        // Cells without volume take it from a neighbour that has it, from cell to cell.
        let flat = |hands: &[f64], cell: &u32| hands[*cell as usize] == 0.0;
        let mut open: Vec<u32> = (0..cells.len() as u32).filter(|cell| flat(&hands, cell)).collect();
        while !open.is_empty() {
            let before = open.len();
            open.retain(|&cell| {
                let known = (0..4).filter(|&k| self.neighbours[cell as usize][k] != NO_CELL).find_map(|k| {
                    let (other, factor) = beyond(self, cell, k);
                    (hands[other as usize] != 0.0).then(|| hands[other as usize] * factor)
                });
                hands[cell as usize] = known.unwrap_or(0.0);
                known.is_none()
            });
            if open.len() == before {
                // Nothing but cells without volume, which draw nothing.
                break;
            }
        }
        self.folded = (0..cells.len() as u32)
            .into_par_iter()
            .with_min_len(CHUNK)
            .map(|cell| {
                let later = |k: &usize| {
                    let other = self.neighbours[cell as usize][*k];
                    other != NO_CELL && cell < other
                };
                let is_folded = |k: &usize| {
                    let (other, factor) = beyond(self, cell, *k);
                    hands[cell as usize] * factor * hands[other as usize] < 0.0
                };
                (0..4).filter(later).filter(is_folded).count() as u64
            })
            .sum();
        self.is_right_handed = hands.into_iter().map(|hand| hand > 0.0).collect();
    }
}

/// Distance of a corner from the plane of the adjacent face (fraction of the grid's diagonal) below which it lies in it: rounding,
/// which leaves gaps of this width between a grid and its hull.
const PLANE_TOLERANCE: f64 = 1e-12;

/// Face of one cell alone.
struct BoundaryFace {
    /// Corners, as the first points at their places.
    pub corners: [u32; 3],
    /// True if the cell is on the side to which the corners' normal points.
    pub is_cell_at_normal: bool,
}

/// True if the boundary is one convex surface. `diagonal`: that of the grid (world units).
fn is_convex(boundary: &[BoundaryFace], points: &[DVec3], diagonal: f64) -> bool {
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
