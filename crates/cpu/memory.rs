//! What drawing takes.

use crate::cast::{CELLS_MOST as CAST_MOST, OF_CELL as CAST_OF_CELL};
use crate::cells::MOST_AT_ONCE;
use crate::project::record::{AttributeRecord, Record, TILE};
use crate::sample::{LOST_AT_ONCE, cells_of_window};
use crate::view::Seen;

/// Tiles that a cell touches, on average over the grids that were measured (1 to 3): a number of 4 bytes each.
const TILES_OF_CELL: u64 = 2;

/// Windows that a cell touches, and the room that their lists grow into: 1.2 times 1.4 numbers, measured.
const WINDOWS_OF_CELL: f64 = 1.7;

/// What is kept of a cell between pictures ([`crate::Known`]), and its number among those in view.
const KNOWN_OF_CELL: u64 = 5 + 4;

/// Bytes that drawing takes beside the volume, for so many cells that were not culled: what is kept of each of them for the
/// compositor, the points on the screen, the picture. `attributes`: quantities that segments look at (s, g, further fields,
/// the components of ∇s).
pub fn drawing_bytes(cells: u64, points: u64, attributes: u64, size: [u32; 2]) -> u64 {
    drawing_bytes_of(cells, points, attributes, size, MOST_AT_ONCE, Some(CAST_OF_CELL))
}

/// The same where so many cells are projected at once. `faces`: bytes for the faces of a cell, where rays go by them.
pub(crate) fn drawing_bytes_of(
    cells: u64,
    points: u64,
    attributes: u64,
    [width, height]: [u32; 2],
    most_at_once: usize,
    faces: Option<u64>,
) -> u64 {
    let of = |bytes: usize| bytes as u64;
    let number = of(size_of::<u32>());
    // The record, its corners and its rectangle of tiles.
    let record = of(size_of::<Record>() + size_of::<[u32; 4]>() + size_of::<[u16; 4]>());
    let projected = record
        .saturating_add(attributes.saturating_mul(of(size_of::<AttributeRecord>())))
        .saturating_add(TILES_OF_CELL * number);
    let pixels = u64::from(width) * u64::from(height);
    let tiles = u64::from(width).div_ceil(of(TILE)) * u64::from(height).div_ceil(of(TILE));
    let threads = of(rayon::current_num_threads());
    let by_cell = |most_at_once: usize| {
        if cells <= of(most_at_once) {
            // In each part that is projected by itself a place for each tile.
            let places = tiles.saturating_mul((threads * 4).min(256)).saturating_mul(number);
            cells.saturating_mul(projected).saturating_add(places)
        } else {
            // A window cannot be less than a tile.
            let window = (2 * of(cells_of_window(most_at_once))).max(cells / tiles.max(1)).min(cells);
            let listed = (cells as f64 * WINDOWS_OF_CELL * number as f64) as u64;
            listed.saturating_add(threads.saturating_mul(window).saturating_mul(projected))
        }
    };
    // Where rays go from cell to cell: half-faces, the faces that cells share, places of cells; the points in steps.
    let drawn = if let Some(faces) = faces.filter(|_| cells <= of(CAST_MOST)) {
        let fours = 1 + attributes.saturating_sub(1).div_ceil(4);
        let points = points.saturating_mul(fours).saturating_mul(of(size_of::<[f32; 4]>()));
        // Beside them projected cells for tiles where rays are lost.
        let cast = cells.saturating_mul(faces).saturating_add(points);
        by_cell(most_at_once).max(cast.saturating_add(by_cell(most_at_once.min(LOST_AT_ONCE))))
    } else {
        by_cell(most_at_once)
    };
    drawn
        .saturating_add(cells.saturating_mul(KNOWN_OF_CELL))
        .saturating_add(points.saturating_mul(of(size_of::<Seen>())))
        .saturating_add(pixels * of(size_of::<[f32; 4]>()))
}
