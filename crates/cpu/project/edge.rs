//! Crossings of projected edges with rows of pixel centres.

use crate::tile::TILE;
use crate::view::ScreenVertex;

/// 1.5 · 2²³ · 2⁻¹⁷: adding and taking away this times a power of two rounds to 2⁻¹⁷ of that power (up to 32 times
/// it, twice a tile; beyond, where spans are cut off, more coarsely).
pub(crate) const CROSSING_ROUND: f32 = 96.0;

/// Crossing of the edge between two points with the row of a pixel (columns from the left edge of the tile that holds the pixel); `None`
/// where the edge does not cross it. Bit for bit the value that [`crate::fragments::spans`] finds.
pub(crate) fn crossing_of_row(ends: [&ScreenVertex; 2], [i, j]: [usize; 2]) -> Option<f32> {
    let [upper, lower] = if ends[0].y <= ends[1].y { ends } else { [ends[1], ends[0]] };
    let (left, top) = ((i - i % TILE) as f64, (j - j % TILE) as f64);
    let row = (j % TILE) as f32;
    let rows = (upper.y.ceil() - top) as f32..(lower.y.ceil() - top) as f32;
    if !rows.contains(&row) {
        return None;
    }
    let tilt = (lower.x - upper.x) / (lower.y - upper.y);
    let at_top = (top - upper.y).mul_add(tilt, upper.x - left) as f32;
    let slope = tilt as f32;
    let power = f32::from_bits(slope.abs().clamp(1.0, 1e6).to_bits() & 0x7f80_0000);
    let x = row.mul_add(slope, at_top);
    Some((x + power * CROSSING_ROUND) - power * CROSSING_ROUND)
}
