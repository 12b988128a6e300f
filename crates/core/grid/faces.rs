//! The faces of a grid's tetrahedra, with the cells that have each of them.
//!
//! Points at one place count as one, so that pieces that meet point by point share faces.

use glam::DVec3;
use rayon::prelude::*;
use std::sync::atomic::{AtomicU32, Ordering};

/// Cells of a chunk of work.
const CHUNK: usize = 1 << 13;

/// A face of a cell that begins at a given point: its other corners, the cell, and the corner opposite.
pub(crate) type Face = [u32; 4];

/// For each point the first one at its place; `None`: points at one place count each for itself.
pub(crate) struct CoincidentPoints(pub(super) Option<Vec<u32>>);

impl CoincidentPoints {
    pub fn find(points: &[DVec3]) -> CoincidentPoints {
        CoincidentPoints(points_at_one_place(points))
    }

    /// The first point at the place of this one.
    pub fn first(&self, point: u32) -> u32 {
        self.0.as_ref().map_or(point, |first| first[point as usize])
    }

    /// The corners of a cell by the first points at their places, ascending.
    fn corners(&self, cell: [u32; 4]) -> [u32; 4] {
        if self.0.is_none() {
            return cell;
        }
        let mut corners = cell.map(|p| self.first(p));
        corners.sort_unstable();
        corners
    }
}

/// Looks at every face of tetrahedra (corners ascending) once: `look` is given its lowest point and the face as each of its
/// cells has it, all by the first points at their places. Cells with corners at one place have no faces. What is found comes
/// in the order of the points.
pub(crate) fn each_face<T: Send>(
    points: &[DVec3],
    tetrahedra: &[[u32; 4]],
    places: &CoincidentPoints,
    none: impl Fn() -> T + Sync + Send,
    look: impl Fn(&mut T, u32, &[Face]) + Sync + Send,
    join: impl Fn(T, T) -> T + Sync + Send,
) -> T {
    let corners = |cell: u32| places.corners(tetrahedra[cell as usize]);
    // Each cell at its lowest corner, where three of its faces have theirs, and at the next, where the fourth has.
    let starts = starts(points.len(), tetrahedra.len(), &corners);
    let cells = by_point(&starts, tetrahedra.len(), &corners);
    (0..points.len())
        .into_par_iter()
        .with_min_len(CHUNK)
        .fold(
            || (Vec::new(), none()),
            |(mut faces, mut found), p| {
                let around = &cells[starts[p] as usize..starts[p + 1] as usize];
                faces_at(p as u32, around, &corners, &mut faces);
                for shared in faces.chunk_by(|a: &Face, b| a[..2] == b[..2]) {
                    look(&mut found, p as u32, shared);
                }
                (faces, found)
            },
        )
        .map(|(_, found)| found)
        .reduce(&none, join)
}

/// The faces that have their lowest point here, those of one place side by side.
fn faces_at(p: u32, around: &[u32], corners: &impl Fn(u32) -> [u32; 4], faces: &mut Vec<Face>) {
    faces.clear();
    for &cell in around {
        let [a, b, c, d] = corners(cell);
        if a == p {
            faces.extend([[b, c, cell, d], [b, d, cell, c], [c, d, cell, b]]);
        } else {
            faces.push([c, d, cell, a]);
        }
    }
    // As one number: compared without a branch for each of the four.
    faces.sort_unstable_by_key(|face| face.iter().fold(0, |key, &word| key << 32 | u128::from(word)));
}

/// Start of each point's cells; one more entry than points.
fn starts(point_count: usize, cell_count: usize, corners: &(impl Fn(u32) -> [u32; 4] + Sync)) -> Vec<u64> {
    let counts: Vec<AtomicU32> = (0..point_count).map(|_| AtomicU32::new(0)).collect();
    (0..cell_count as u32).into_par_iter().with_min_len(CHUNK).for_each(|cell| {
        for p in points_of_cell(corners(cell)) {
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
        for p in points_of_cell(corners(cell)) {
            let place = starts[p as usize] + u64::from(taken[p as usize].fetch_add(1, Ordering::Relaxed));
            cells[place as usize].store(cell, Ordering::Relaxed);
        }
    });
    cells.into_iter().map(AtomicU32::into_inner).collect()
}

/// The points at which a cell is looked at; none where it has corners at one place, and so no volume.
fn points_of_cell([a, b, c, d]: [u32; 4]) -> impl Iterator<Item = u32> {
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
