//! Sizes of the grids of tetrahedra that pieces of a file become, by headers alone: by their kind of grid, by the corners that cells have on
//! average where headers tell them, otherwise by the numbers of points and cells.

use super::contents::{Dataset, Geometry, Piece, StoredCells, StoredFaces};
use crate::memory::{GridSize, MAX_CORNERS, tetrahedra_by_corners};

/// Tetrahedra that cells of unknown kinds are split into at most, on average, by cell and by point: of hexahedra as many as 6 by either.
const MAX_SPLIT: u64 = 6;

/// Size of each piece, in order.
pub(super) fn sizes(dataset: &Dataset) -> Vec<GridSize> {
    dataset.pieces.iter().map(size).collect()
}

fn size(piece: &Piece) -> GridSize {
    let &Piece { point_count: points, cell_count: cells, .. } = piece;
    let structured = GridSize { points, tetrahedra: cells.saturating_mul(MAX_SPLIT), split: Some(0) };
    // Points of all cells, numbers that faces of polyhedra take beside them, and whether faces may stand among the points.
    let (corners, faces, has_streams) = match &piece.geometry {
        Geometry::Curvilinear { .. } | Geometry::Rectilinear { .. } | Geometry::Uniform { .. } => {
            return structured;
        }
        Geometry::Adaptive(_) => (Some(cells.saturating_mul(8)), 0, false),
        Geometry::Open(_) => (None, 0, false),
        Geometry::Unstructured { cells: stored, .. } => match &**stored {
            StoredCells::Offsets { connectivity, faces, .. } => {
                let has_streams = matches!(faces, StoredFaces::InConnectivity);
                (connectivity.value_count(), faces.value_count(), has_streams)
            }
            // Each cell has its count before its points.
            StoredCells::Counted { list, .. } => {
                (list.value_count().map(|all| all.saturating_sub(cells)), 0, true)
            }
            StoredCells::Converted(_) => (None, 0, false),
        },
    };
    let by_points = points.saturating_mul(MAX_SPLIT).max(cells);
    let at_most = cells.saturating_mul(MAX_SPLIT).min(by_points);
    let numbers = corners.filter(|_| cells > 0).map(|corners| corners as f64 / cells as f64);
    let mean = numbers.map(|numbers| if has_streams { corners_of_stream(numbers) } else { numbers });
    let tetrahedra = mean.map_or(at_most, |mean| (cells as f64 * tetrahedra_by_corners(mean)) as u64);
    // The points of cells beside their streams.
    let beside = mean.filter(|_| mean < numbers).map_or(0, |mean| (cells as f64 * mean) as u64);
    let is_plain = corners == cells.checked_mul(4) && faces == 0;
    // Connectivity in 32 bits, offsets in 64, types in 8.
    let stored = [corners.unwrap_or(0), faces, beside].into_iter().fold(0, u64::saturating_add);
    let bytes = stored.saturating_mul(4).saturating_add(cells.saturating_mul(9));
    GridSize { points, tetrahedra, split: (!is_plain).then_some(bytes) }
}

/// Corners of a cell that a legacy file stores as so many numbers. More than any other type of cell has are the stream of a polyhedron:
/// the number of its faces, and of each face the number of its points and these. Where three edges meet at each of n corners, as
/// in cells of Voronoi, there are n/2 + 2 faces with 3n points.
fn corners_of_stream(count: f64) -> f64 {
    if count > MAX_CORNERS { (count - 3.0) / 3.5 } else { count }
}
