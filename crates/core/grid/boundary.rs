//! The boundary of a grid: the faces that one tetrahedron alone has.

use super::Grid;
use super::faces::{CoincidentPoints, Face, each_face};
use super::grid_surface::{GridSurface, edge_key};
use crate::Result;
use crate::progress::{Progress, refuse_beyond_memory};

/// The corners of a cell's faces, by the corner opposite, counter-clockwise from outside where the fourth corner lies on the positive
/// side of the first three.
const OUTWARD: [[usize; 3]; 4] = [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]];

/// Faces of the drawn cells that no other one shares. Points at one place count as one, each cell keeps its own there.
///
/// Errors: memory ends.
pub fn boundary(grid: &Grid, progress: &dyn Progress) -> Result<GridSurface> {
    let (faces, _) = outer_faces(grid, progress)?;
    let keys: Vec<[u64; 3]> =
        faces.into_iter().map(|(corners, _)| corners.map(|p| edge_key([p; 2]))).collect();
    Ok(GridSurface::of_keys(&keys, |_| 0.0))
}

/// A face's points, and its tetrahedron.
type OuterFace = ([u32; 3], u32);

/// The faces of [`boundary`]: points counter-clockwise from outside, and the tetrahedron of each; and the points by
/// their places.
///
/// Errors: memory ends.
pub(super) fn outer_faces(
    grid: &Grid,
    progress: &dyn Progress,
) -> Result<(Vec<OuterFace>, CoincidentPoints)> {
    // Cells by their points, and their numbers; points by their places.
    let bytes = 16 * (grid.tetrahedra.len() + grid.points.len()) as u64;
    refuse_beyond_memory(progress, || "the boundary of the grid".into(), bytes)?;
    progress.check_cancelled()?;
    let places = CoincidentPoints::find(&grid.points);
    let scale = grid.length_scale();
    let face = |cell: u32, opposite: u32| {
        let corners = grid.tetrahedra[cell as usize];
        let across = corners.iter().position(|&p| places.first(p) == opposite).unwrap_or(0);
        let [p, q, r, s] = grid.corners(cell as usize).map(|p| p * scale);
        let [a, b, c] = OUTWARD[across].map(|k| corners[k]);
        (if (q - p).dot((r - p).cross(s - p)) >= 0.0 { [a, b, c] } else { [a, c, b] }, cell)
    };
    let look = |faces: &mut Vec<_>, _, shared: &[Face]| {
        if let [[_, _, cell, opposite]] = *shared {
            faces.push(face(cell, opposite));
        }
    };
    let join = |mut faces: Vec<_>, others: Vec<_>| {
        faces.extend(others);
        faces
    };
    let faces = each_face(&grid.points, &grid.tetrahedra, &places, Vec::new, look, join);
    Ok((faces, places))
}
