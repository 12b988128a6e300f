//! What drawing takes.

use crate::project::record::{AttributeRecord, Record, TILE};
use crate::view::Seen;

/// Tiles that a cell touches, on average over the grids that were measured (1 to 3): a number of 4 bytes each.
const TILES_OF_CELL: u64 = 2;

/// Bytes that drawing takes beside the volume, for so many cells that were not culled: what is kept of each of them for the
/// compositor, the points on the screen, the picture. `attributes`: quantities that segments look at (s, g, further fields,
/// the components of ∇s).
pub fn drawing_bytes(cells: u64, points: u64, attributes: u64, [width, height]: [u32; 2]) -> u64 {
    let of = |bytes: usize| bytes as u64;
    // The record, its corners and its rectangle of tiles, its number among those kept.
    let record = of(size_of::<Record>() + size_of::<[u32; 4]>() + size_of::<[u16; 4]>() + size_of::<u32>());
    let cell = record
        .saturating_add(attributes.saturating_mul(of(size_of::<AttributeRecord>())))
        .saturating_add(TILES_OF_CELL * of(size_of::<u32>()));
    let pixels = u64::from(width) * u64::from(height);
    // In each part that is projected by itself a count and a place for each tile.
    let parts = of((rayon::current_num_threads() * 4).min(256));
    let tiles = pixels / of(TILE * TILE) * parts * of(2 * size_of::<u32>());
    cells
        .saturating_mul(cell)
        .saturating_add(points.saturating_mul(of(size_of::<Seen>())))
        .saturating_add(pixels * of(size_of::<[f32; 4]>()))
        .saturating_add(tiles)
}
