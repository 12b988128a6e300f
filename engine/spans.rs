//! Spans: the pixels of a tile that a cell covers, row by row, in closed form.
//!
//! The silhouette of a tetrahedron is the hull of its four projected corners; on one row of pixel centres it is
//! the span between the least and the greatest crossing of its six edges. Each edge is taken from its upper to
//! its lower end (by y, then x), so all cells that share it find the same crossing, bit for bit, and the rules
//! are half-open (a row y belongs to an edge if y₀ ≤ y < y₁, a pixel to a span if ⌈x₀⌉ ≤ x < ⌈x₁⌉): every pixel
//! centre that lies on a shared silhouette edge is given to exactly one of the cells.

use super::record::TILE;
use super::view::Seen;
use voltet_core::lanes::{Double, Float, Lanes, Mask, Unsigned, inlined};

/// Pairs of corners: the edges.
const EDGES: [[usize; 2]; 6] = [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]];

/// See the use.
const GRAIN: f32 = 1.0 / (1 << 17) as f32;

/// Fragments are coded lane << 8 | row << 4 | column.
const SPARE: usize = 32;

/// Codes of fragments: (cell lane, row, column).
pub(crate) struct Fragments {
    /// The codes; the first `count` are meant.
    pub codes: Vec<u16>,
    /// How many.
    pub count: usize,
}

impl Fragments {
    /// Room for the fragments of `lanes` cells in one tile.
    pub fn new(lanes: usize) -> Self {
        Fragments { codes: vec![0; lanes * TILE * TILE + SPARE], count: 0 }
    }

    /// Appends the pixels of rows `rows` of the tile at (`left`, `top`) that the cell covers.
    #[inline(always)]
    pub fn cover<L: Lanes>(
        &mut self,
        corners: [&Seen; 4],
        lane: usize,
        left: usize,
        top: usize,
        rows: std::ops::Range<usize>,
        right: usize,
    ) {
        // Edges, upper end first; without branches: which end is the upper one cannot be predicted.
        let (mut x0, mut y0, mut y1, mut run) = ([0f64; 8], [0f64; 8], [0f64; 8], [0f64; 8]);
        let (x, y) = (corners.map(|c| c.x), corners.map(|c| c.y));
        for (k, &[a, b]) in EDGES.iter().enumerate() {
            let down = (y[a] < y[b]) | ((y[a] == y[b]) & (x[a] <= x[b]));
            let (upper, lower) = if down { (a, b) } else { (b, a) };
            x0[k] = x[upper];
            y0[k] = y[upper];
            y1[k] = y[lower];
            run[k] = x[lower] - x[upper];
        }
        // The first and last row of each edge, and its crossing of the tile's first row, in 64 bits; from there
        // 32 bits carry 16 rows. A horizontal edge has no rows, and its slope is not looked at.
        let (mut first, mut last) = ([0f32; 8], [0f32; 8]);
        let (mut crossing, mut slope) = ([0f32; 8], [0f32; 8]);
        for half in (0..8).step_by(L::D::COUNT) {
            let (upper, lower) = (L::D::load(&y0[half..]), L::D::load(&y1[half..]));
            let (tile_top, tile_left) = (L::D::splat(top as f64), L::D::splat(left as f64));
            let tilt = L::D::load(&run[half..]) / (lower - upper);
            let at_top = (tile_top - upper).mul_add(tilt, L::D::load(&x0[half..]) - tile_left);
            (upper.ceil() - tile_top).store_f32(&mut first[half..]);
            (lower.ceil() - tile_top).store_f32(&mut last[half..]);
            at_top.store_f32(&mut crossing[half..]);
            tilt.store_f32(&mut slope[half..]);
        }
        // Crossings are rounded to 2⁻¹⁷ of a pixel (across the edge): several edges of a face that is seen edge-on
        // lie on one line, and must cross a row at one place although each is rounded in its own way.
        // The grain is a power of two, so its inverse is had from its bits: (2^e)'s are (e + 127) << 23.
        let (mut grain, mut per_grain) = ([0f32; 8], [0f32; 8]);
        for k in 0..EDGES.len() {
            let power = slope[k].abs().clamp(1.0, 1e6).to_bits() & 0x7f80_0000;
            grain[k] = f32::from_bits(power) * GRAIN;
            // Wrapping for the slope of an edge without extent, which is no number and has no rows.
            per_grain[k] = f32::from_bits(0x7f00_0000_u32.wrapping_sub(power)) / GRAIN;
        }
        let top_row = y[0].min(y[1]).min(y[2].min(y[3])).ceil() - top as f64;
        let bottom_row = y[0].max(y[1]).max(y[2].max(y[3])).ceil() - top as f64;
        let start = top_row.max(rows.start as f64) as usize;
        let end = bottom_row.min(rows.end as f64).max(0.0) as usize;
        if start >= end {
            return;
        }

        let splat = L::F::splat;
        let (mut from, mut to) = ([0u32; TILE], [0u32; TILE]);
        let width = splat((right - left) as f32);
        for half in (start / L::WIDTH * L::WIDTH..end).step_by(L::WIDTH) {
            let row = (L::U::iota() + L::U::splat(half as u32)).to_float();
            let (mut least, mut most) = (splat(f32::INFINITY), splat(f32::NEG_INFINITY));
            for k in 0..EDGES.len() {
                let crosses = splat(first[k]).le(row).and(row.lt(splat(last[k])));
                let x = row.mul_add(splat(slope[k]), splat(crossing[k]));
                let x = (x * splat(per_grain[k])).round() * splat(grain[k]);
                least = L::F::select(crosses, x.min(least), least);
                most = L::F::select(crosses, x.max(most), most);
            }
            // ⌈x⌉ = −⌊−x⌋. A row without crossings has least = +∞, most = −∞: from = width, to = 0, no span.
            let bound = inlined(
                #[inline(always)]
                |x: L::F| (-(-x).floor()).max(splat(0.0)).min(width).to_unsigned(),
            );
            bound(least).store(&mut from[half..]);
            bound(most).store(&mut to[half..]);
        }
        for row in start..end {
            let (from, to) = (from[row], to[row]);
            if from < to {
                let code = (lane << 8 | row << 4) as u16 + from as u16;
                let out = &mut self.codes[self.count..self.count + TILE];
                for (k, out) in out.iter_mut().enumerate() {
                    *out = code + k as u16;
                }
                self.count += (to - from) as usize;
            }
        }
    }
}
