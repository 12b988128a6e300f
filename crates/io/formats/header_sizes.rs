//! Sizes of the grids of tetrahedra that pieces of a file become, by headers alone: by their kind of grid, by the corners that cells have on
//! average where headers tell them, otherwise by the numbers of points and cells.

use super::contents::{Dataset, Geometry, Piece, Stored, StoredCells, StoredFaces};
use crate::memory::GridSize;

/// Mean number of a cell's corners, and of the tetrahedra that it becomes: surfaces, tetrahedra, pyramids, wedges, hexahedra; quadratic
/// tetrahedra and hexahedra at one subdivision.
const SPLIT: [(f64, f64); 8] =
    [(3.0, 0.0), (4.0, 1.0), (5.0, 2.0), (6.0, 3.0), (8.0, 6.0), (10.0, 8.0), (20.0, 32.0), (27.0, 32.0)];

/// Tetrahedra that cells of unknown kinds are split into at most, on average, by cell and by point: of hexahedra as many as 6 by either.
const MAX_SPLIT: u64 = 6;

/// Size of each piece, in order.
pub(super) fn sizes(dataset: &Dataset) -> Vec<GridSize> {
    dataset.pieces.iter().map(size).collect()
}

fn size(piece: &Piece) -> GridSize {
    let &Piece { point_count: points, cell_count: cells, .. } = piece;
    let structured = GridSize { points, tetrahedra: cells.saturating_mul(MAX_SPLIT), split: Some(0) };
    let (corners, faces) = match &piece.geometry {
        Geometry::Curvilinear { .. } | Geometry::Rectilinear { .. } | Geometry::Uniform { .. } => {
            return structured;
        }
        Geometry::Adaptive(_) => (Some(cells.saturating_mul(8)), 0),
        Geometry::Added(_) => (None, 0),
        Geometry::Unstructured { cells: stored, .. } => match &**stored {
            StoredCells::Offsets { connectivity, faces, .. } => {
                (connectivity.value_count(), face_values(faces))
            }
            // Each cell has its count before its points.
            StoredCells::Counted { list, .. } => (list.value_count().map(|all| all.saturating_sub(cells)), 0),
            StoredCells::Converted(_) => (None, 0),
        },
    };
    let by_points = points.saturating_mul(MAX_SPLIT).max(cells);
    let at_most = cells.saturating_mul(MAX_SPLIT).min(by_points);
    // Corners of polyhedra say little of what they become.
    let tetrahedra = match corners.filter(|_| faces == 0 && cells > 0) {
        Some(corners) => (cells as f64 * tetrahedra_of(corners as f64 / cells as f64)) as u64,
        None => at_most,
    };
    let is_plain = corners == cells.checked_mul(4) && faces == 0;
    // Connectivity in 32 bits, offsets in 64, types in 8.
    let bytes =
        corners.unwrap_or(0).saturating_add(faces).saturating_mul(4).saturating_add(cells.saturating_mul(9));
    GridSize { points, tetrahedra, split: (!is_plain).then_some(bytes) }
}

/// Tetrahedra that a cell becomes, by the mean number of its corners.
fn tetrahedra_of(corners: f64) -> f64 {
    let after = SPLIT.partition_point(|known| known.0 < corners);
    match (after.checked_sub(1), SPLIT.get(after)) {
        (None, _) => 0.0,
        (Some(last), None) => SPLIT[last].1,
        (Some(before), Some(&(high, most))) => {
            let (low, least) = SPLIT[before];
            least + (most - least) * (corners - low) / (high - low)
        }
    }
}

/// Numbers that faces of polyhedra are stored as; 0 where headers tell none.
fn face_values(faces: &StoredFaces) -> u64 {
    let count = |stored: &Stored| stored.value_count().unwrap_or(0);
    match faces {
        StoredFaces::Stream { faces, .. } => count(faces),
        StoredFaces::Indexed { points, faces, .. } => count(points).saturating_add(count(faces)),
        StoredFaces::None | StoredFaces::InConnectivity => 0,
    }
}
