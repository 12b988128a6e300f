//! Memory that drawing takes.

use crate::cast::{BYTES_PER_CELL, MAX_CELLS};
use crate::project::cells::{AttributePlane, ProjectedCell};
use crate::projection::{MAX_RESIDENT_CELLS_OF_FALLBACK, cells_of_region};
use crate::selection::MAX_RESIDENT_CELLS;
use crate::tile::TILE;
use crate::view::ScreenVertex;

/// Tiles that a cell touches, on average over the measured grids (1 to 3): a number of 4 bytes each.
const TILES_PER_CELL: u64 = 2;

/// Regions that a cell touches, and the spare capacity of their lists: 1.2 times 1.4 numbers, measured.
const REGIONS_PER_CELL: f64 = 1.7;

/// Bytes of a cell in the volume's cache ([`crate::VolumeCache`]), and its number among those in view.
const CACHED_BYTES_PER_CELL: u64 = 5 + 4;

/// Bytes that drawing takes beside the volume, for a number of cells that were not culled: projected cells or faces, the points on the
/// screen, the picture. `attributes`: quantities that segments carry (s, g, further fields, the components of ∇s).
pub fn drawing_bytes(cells: u64, points: u64, attributes: u64, size: [u32; 2]) -> u64 {
    drawing_bytes_of(cells, points, attributes, size, MAX_RESIDENT_CELLS, Some(BYTES_PER_CELL))
}

/// Like [`drawing_bytes`], with a number of resident cells. `faces`: bytes for the faces of a cell, where rays are cast.
pub(crate) fn drawing_bytes_of(
    cells: u64,
    points: u64,
    attributes: u64,
    [width, height]: [u32; 2],
    max_resident_cells: usize,
    faces: Option<u64>,
) -> u64 {
    let of = |bytes: usize| bytes as u64;
    let number = of(size_of::<u32>());
    // The record, its corners and its rectangle of tiles.
    let record = of(size_of::<ProjectedCell>() + size_of::<[u32; 4]>() + size_of::<[u16; 4]>());
    let projected = record
        .saturating_add(attributes.saturating_mul(of(size_of::<AttributePlane>())))
        .saturating_add(TILES_PER_CELL * number);
    let pixels = u64::from(width) * u64::from(height);
    let tiles = u64::from(width).div_ceil(of(TILE)) * u64::from(height).div_ceil(of(TILE));
    let threads = of(rayon::current_num_threads());
    let by_cell = |max_resident_cells: usize| {
        if cells <= of(max_resident_cells) {
            // A count for each tile in each part that is projected by itself.
            let counts = tiles.saturating_mul((threads * 4).min(256)).saturating_mul(number);
            cells.saturating_mul(projected).saturating_add(counts)
        } else {
            // A region cannot be less than a tile.
            let region = (2 * of(cells_of_region(max_resident_cells))).max(cells / tiles.max(1)).min(cells);
            let listed = (cells as f64 * REGIONS_PER_CELL * number as f64) as u64;
            listed.saturating_add(threads.saturating_mul(region).saturating_mul(projected))
        }
    };
    // Where rays are cast: half-faces, shared faces, indices of cells; the points in steps.
    let drawn = if let Some(faces) = faces.filter(|_| cells <= of(MAX_CELLS)) {
        let quads = 1 + attributes.saturating_sub(1).div_ceil(4);
        let points = points.saturating_mul(quads).saturating_mul(of(size_of::<[f32; 4]>()));
        // Beside them projected cells for tiles where rays are mistracked.
        let cast = cells.saturating_mul(faces).saturating_add(points);
        by_cell(max_resident_cells)
            .max(cast.saturating_add(by_cell(max_resident_cells.min(MAX_RESIDENT_CELLS_OF_FALLBACK))))
    } else {
        by_cell(max_resident_cells)
    };
    drawn
        .saturating_add(cells.saturating_mul(CACHED_BYTES_PER_CELL))
        .saturating_add(points.saturating_mul(of(size_of::<ScreenVertex>())))
        .saturating_add(pixels * of(size_of::<[f32; 4]>()))
}
