//! Cells that overlap their neighbours: on the same side of a shared face.
//!
//! Two cells of a grid that fills space once lie on different sides of the face that they share. Cells that are there twice,
//! that are folded over, or that are joined three to a face are found by that; [`super::within`] finds those that overlap and
//! share no face. Points at one place count as one, so that pieces that hold the same cells are seen.

use glam::DVec3;
use rayon::prelude::*;
use std::sync::atomic::{AtomicU32, Ordering};

/// A tetrahedron whose height over a face is less than this share of the distance of its fourth corner has no side that
/// rounding could not turn.
const FLAT: f64 = 1e-9;

/// Cells of a chunk of work.
const CHUNK: usize = 1 << 13;

/// What the faces of a grid say.
#[derive(Debug, PartialEq)]
pub(super) struct Faces {
    /// The tetrahedra that lie on the same side of a face as another one does, ascending.
    pub overlapping: Vec<u32>,
    /// The faces of one cell alone, the grid's boundary: the cell and the point opposite (the first at its place),
    /// ascending.
    pub boundary: Vec<[u32; 2]>,
}

/// Looks at all faces of tetrahedra (corners ascending).
pub(super) fn faces(points: &[DVec3], tetrahedra: &[[u32; 4]]) -> Faces {
    let first_at_place = points_at_one_place(points);
    let corners = |cell: u32| {
        let mut corners = tetrahedra[cell as usize];
        if let Some(first) = &first_at_place {
            corners = corners.map(|p| first[p as usize]);
            corners.sort_unstable();
        }
        corners
    };
    // Each cell at its lowest corner, where three of its faces have theirs, and at the next, where the fourth has.
    let starts = starts(points.len(), tetrahedra.len(), &corners);
    let cells = by_point(&starts, tetrahedra.len(), &corners);
    let none = || Faces { overlapping: Vec::new(), boundary: Vec::new() };
    let mut found = (0..points.len())
        .into_par_iter()
        .with_min_len(CHUNK)
        .fold(
            || (Vec::new(), none()),
            |(mut faces, mut found), p| {
                let around = &cells[starts[p] as usize..starts[p + 1] as usize];
                look_at(points, p as u32, around, &corners, &mut faces, &mut found);
                (faces, found)
            },
        )
        .map(|(_, found)| found)
        .reduce(none, |mut all, mut more| {
            all.overlapping.append(&mut more.overlapping);
            all.boundary.append(&mut more.boundary);
            all
        });
    found.overlapping.par_sort_unstable();
    found.overlapping.dedup();
    found.boundary.par_sort_unstable();
    found
}

/// A face of a cell that begins at a given point: its other corners, the cell, and the corner opposite.
type Face = [u32; 4];

/// Adds the cells around a point that lie on one side of a face with another one, and the faces of one cell.
fn look_at(
    points: &[DVec3],
    p: u32,
    around: &[u32],
    corners: &impl Fn(u32) -> [u32; 4],
    faces: &mut Vec<Face>,
    found: &mut Faces,
) {
    faces.clear();
    for &cell in around {
        let [a, b, c, d] = corners(cell);
        if a == p {
            faces.extend([[b, c, cell, d], [b, d, cell, c], [c, d, cell, b]]);
        } else {
            faces.push([c, d, cell, a]);
        }
    }
    faces.sort_unstable();
    for shared in faces.chunk_by(|a, b| a[..2] == b[..2]) {
        if let [[_, _, cell, opposite]] = *shared {
            found.boundary.push([cell, opposite]);
            continue;
        }
        let [origin, q, r] = [p, shared[0][0], shared[0][1]].map(|point| points[point as usize]);
        let normal = (q - origin).cross(r - origin);
        let side = |face: &Face| {
            let apart = points[face[3] as usize] - origin;
            let height = normal.dot(apart);
            let is_clear = height.abs() > FLAT * normal.length() * apart.length();
            if is_clear { height.signum() } else { 0.0 }
        };
        for which in [-1.0, 1.0] {
            let there = shared.iter().filter(|face| side(face) == which);
            if there.clone().count() > 1 {
                found.overlapping.extend(there.map(|face| face[2]));
            }
        }
    }
}

/// Where each point's cells begin; one more entry than points.
fn starts(point_count: usize, cell_count: usize, corners: &(impl Fn(u32) -> [u32; 4] + Sync)) -> Vec<u64> {
    let counts: Vec<AtomicU32> = (0..point_count).map(|_| AtomicU32::new(0)).collect();
    (0..cell_count as u32).into_par_iter().with_min_len(CHUNK).for_each(|cell| {
        for p in at(corners(cell)) {
            counts[p as usize].fetch_add(1, Ordering::Relaxed);
        }
    });
    let mut sum = 0;
    let before = counts.into_iter().map(|count| {
        let start = sum;
        sum += u64::from(count.into_inner());
        start
    });
    let mut starts: Vec<u64> = before.collect();
    starts.push(sum);
    starts
}

/// The cells at each point, in any order.
fn by_point(starts: &[u64], cell_count: usize, corners: &(impl Fn(u32) -> [u32; 4] + Sync)) -> Vec<u32> {
    let taken: Vec<AtomicU32> = (0..starts.len() - 1).map(|_| AtomicU32::new(0)).collect();
    let total = starts[starts.len() - 1] as usize;
    let cells: Vec<AtomicU32> = (0..total).map(|_| AtomicU32::new(0)).collect();
    (0..cell_count as u32).into_par_iter().with_min_len(CHUNK).for_each(|cell| {
        for p in at(corners(cell)) {
            let place = starts[p as usize] + u64::from(taken[p as usize].fetch_add(1, Ordering::Relaxed));
            cells[place as usize].store(cell, Ordering::Relaxed);
        }
    });
    cells.into_iter().map(AtomicU32::into_inner).collect()
}

/// The points at which a cell is looked at; none where it has corners at one place, and so no volume.
fn at([a, b, c, d]: [u32; 4]) -> impl Iterator<Item = u32> {
    let is_cell = a < b && b < c && c < d;
    [a, b].into_iter().filter(move |_| is_cell)
}

/// For each point the first one at its place; `None` where no two points are at one place.
fn points_at_one_place(points: &[DVec3]) -> Option<Vec<u32>> {
    // Zero and minus zero are one place.
    let place = |point: u32| (points[point as usize] + 0.0).to_array().map(f64::to_bits);
    let key = |point: u32| {
        place(point).into_iter().fold(0u64, |key, bits| {
            // Multiplicative hashing by the golden ratio (Knuth 1998, The Art of Computer Programming 3, section 6.4).
            (key.rotate_left(29) ^ bits).wrapping_mul(0x9e37_79b9_7f4a_7c15)
        })
    };
    let mut keys: Vec<(u64, u32)> =
        (0..points.len() as u32).into_par_iter().map(|point| (key(point), point)).collect();
    keys.par_sort_unstable();
    let shared = keys.chunk_by(|a, b| a.0 == b.0).filter(|shared| shared.len() > 1);
    let mut first: Option<Vec<u32>> = None;
    for shared in shared {
        for (k, &(_, point)) in shared.iter().enumerate() {
            let same = shared[..k].iter().find(|(_, before)| place(*before) == place(point));
            if let Some(&(_, before)) = same {
                let first = first.get_or_insert_with(|| (0..points.len() as u32).collect());
                first[point as usize] = first[before as usize];
            }
        }
    }
    first
}
