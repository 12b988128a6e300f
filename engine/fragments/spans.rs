//! Spans: the pixels of a tile that a cell covers, row by row, in closed form.
//!
//! The silhouette of a tetrahedron is the hull of its four projected corners; on one row of pixel centres it is
//! the span between the least and the greatest crossing of its six edges. Each edge is taken from its upper to
//! its lower end, so all cells that share it find the same crossing, bit for bit, and the rules
//! are half-open (a row y belongs to an edge if y₀ ≤ y < y₁, a pixel to a span if ⌈x₀⌉ ≤ x < ⌈x₁⌉): every pixel
//! centre that lies on a shared silhouette edge is given to exactly one of the cells.

use crate::project::record::TILE;
use crate::view::Seen;
use voltet_lanes::{Double, Float, Lanes, Mask, Unsigned, inlined};

/// Pairs of corners: the edges.
const EDGES: [[usize; 2]; 6] = [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]];

/// Most lanes of any set.
const MOST: usize = crate::fragments::batch::LANES_MOST;

/// 1.5 · 2²³ · 2⁻¹⁷: adding and taking away this times a power of two rounds to 2⁻¹⁷ of that power (up to 32 times
/// it, twice a tile; beyond, where spans are cut off, more coarsely).
const ROUND: f32 = 96.0;

/// Fragments are coded lane << 8 | row << 4 | column.
const SPARE: usize = 32;

/// Codes of fragments: (cell lane, row, column).
pub(crate) struct Fragments {
    /// The codes; the first `count` are meant.
    pub codes: Vec<u16>,
    /// How many.
    pub count: usize,
}

/// The edges of a group of cells on one tile, cells side by side.
pub(crate) struct Edges {
    x: [[f64; MOST]; 4],
    y: [[f64; MOST]; 4],
    /// First row of the tile that each edge crosses, and the first that it does not cross any more.
    first: [[f32; MOST]; 6],
    last: [[f32; MOST]; 6],
    /// Where it crosses the tile's first row, columns, and its slope, columns a row.
    crossing: [[f32; MOST]; 6],
    slope: [[f32; MOST]; 6],
    /// See [`ROUND`].
    round: [[f32; MOST]; 6],
    /// First and last row of each cell.
    start: [f32; MOST],
    end: [f32; MOST],
}

impl Edges {
    pub fn new() -> Self {
        let rows = [[0.0; MOST]; 6];
        Edges {
            x: [[0.0; MOST]; 4],
            y: [[0.0; MOST]; 4],
            first: rows,
            last: rows,
            crossing: rows,
            slope: rows,
            round: rows,
            start: [0.0; MOST],
            end: [0.0; MOST],
        }
    }

    /// Takes the corners of the cell in a lane.
    #[inline(always)]
    pub fn take(&mut self, lane: usize, corners: [&Seen; 4]) {
        for (k, corner) in corners.iter().enumerate() {
            self.x[k][lane] = corner.x;
            self.y[k][lane] = corner.y;
        }
    }

    /// Finds the edges of all lanes on rows `rows` of the tile at (`left`, `top`).
    #[inline(always)]
    pub fn find<L: Lanes>(&mut self, left: usize, top: usize, rows: &std::ops::Range<usize>) {
        let splat = L::D::splat;
        let (tile_top, tile_left) = (splat(top as f64), splat(left as f64));
        for half in (0..L::WIDTH).step_by(L::D::COUNT) {
            let load = inlined(
                #[inline(always)]
                |rows: &[[f64; MOST]; 4]| {
                    let row = inlined(
                        #[inline(always)]
                        |k: usize| L::D::load(&rows[k][half..]),
                    );
                    [row(0), row(1), row(2), row(3)]
                },
            );
            let (x, y) = (load(&self.x), load(&self.y));
            // The first and last row of each edge, and its crossing of the tile's first row, in 64 bits; from there
            // 32 bits carry 16 rows. A horizontal edge has no rows: neither its direction nor its slope matters.
            for (k, &[a, b]) in EDGES.iter().enumerate() {
                let down = y[a].le(y[b]);
                let upper = [L::D::select(down, x[a], x[b]), L::D::select(down, y[a], y[b])];
                let lower = [L::D::select(down, x[b], x[a]), L::D::select(down, y[b], y[a])];
                let tilt = (lower[0] - upper[0]) / (lower[1] - upper[1]);
                let at_top = (tile_top - upper[1]).mul_add(tilt, upper[0] - tile_left);
                (upper[1].ceil() - tile_top).store_f32(&mut self.first[k][half..]);
                (lower[1].ceil() - tile_top).store_f32(&mut self.last[k][half..]);
                at_top.store_f32(&mut self.crossing[k][half..]);
                tilt.store_f32(&mut self.slope[k][half..]);
            }
            let least = y[0].min(y[1]).min(y[2].min(y[3])).ceil() - tile_top;
            let most = y[0].max(y[1]).max(y[2].max(y[3])).ceil() - tile_top;
            let (from, to) = (splat(rows.start as f64), splat(rows.end as f64));
            least.max(from).min(to).store_f32(&mut self.start[half..]);
            most.min(to).max(from).store_f32(&mut self.end[half..]);
        }
        // Crossings are rounded to 2⁻¹⁷ of a pixel (across the edge): several edges of a face that is seen edge-on
        // lie on one line, and must cross a row at one place although each is rounded in its own way.
        for (slope, round) in self.slope.iter().zip(&mut self.round) {
            let steep = L::F::load(slope).abs().max(L::F::splat(1.0)).min(L::F::splat(1e6));
            let power = L::F::from_bits(steep.to_bits().and(L::U::splat(0x7f80_0000)));
            (power * L::F::splat(ROUND)).store(round);
        }
    }
}

/// Where the edge between two points crosses a row of pixel centres, columns from the left edge of the tile that holds the pixel;
/// `None` where it does not. Bit for bit what [`Edges`] and [`Fragments::cover`] find.
pub(crate) fn crossing_of_row(ends: [&Seen; 2], [i, j]: [usize; 2]) -> Option<f32> {
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
    Some((x + power * ROUND) - power * ROUND)
}

impl Fragments {
    /// Room for the fragments of `lanes` cells in one tile.
    pub fn new(lanes: usize) -> Self {
        Fragments { codes: vec![0; lanes * TILE * TILE + SPARE], count: 0 }
    }

    /// Appends the pixels, of a tile `width` pixels wide, that the cell in a lane covers; if `MASKED`, those that are `open`, a bit
    /// a column.
    #[inline(always)]
    pub fn cover<L: Lanes, const MASKED: bool>(
        &mut self,
        edges: &Edges,
        lane: usize,
        width: usize,
        open: &[u16],
    ) {
        let (start, end) = (edges.start[lane] as usize, edges.end[lane] as usize);
        if start >= end {
            return;
        }
        let splat = L::F::splat;
        let (mut from, mut to) = ([0u32; TILE], [0u32; TILE]);
        let width = splat(width as f32);
        for half in (start / L::WIDTH * L::WIDTH..end).step_by(L::WIDTH) {
            let row = (L::U::iota() + L::U::splat(half as u32)).to_float();
            let (mut least, mut most) = (splat(f32::INFINITY), splat(f32::NEG_INFINITY));
            for k in 0..EDGES.len() {
                let crosses = splat(edges.first[k][lane]).le(row).and(row.lt(splat(edges.last[k][lane])));
                let round = splat(edges.round[k][lane]);
                let x = row.mul_add(splat(edges.slope[k][lane]), splat(edges.crossing[k][lane]));
                let x = (x + round) - round;
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
            if MASKED {
                let mut open = u32::from(open[row]) & ((1 << to) - 1) & (u32::MAX << from.min(31));
                while open != 0 {
                    self.codes[self.count] = (lane << 8 | row << 4) as u16 + open.trailing_zeros() as u16;
                    self.count += 1;
                    open &= open - 1;
                }
            } else if from < to {
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
