//! Spans: the pixels of a tile that a cell covers, row by row, in closed form.
//!
//! The silhouette of a tetrahedron is the hull of its four projected corners; on one row of pixel centres it is
//! the span between the least and the greatest crossing of its six edges. Each edge is taken from its upper to
//! its lower end (by y, then x), so all cells that share it find the same crossing, bit for bit, and the rules
//! are half-open (a row y belongs to an edge if y₀ ≤ y < y₁, a pixel to a span if ⌈x₀⌉ ≤ x < ⌈x₁⌉): every pixel
//! centre that lies on a shared silhouette edge is given to exactly one of the cells.

use super::lanes::{Double, Lanes, Mask, inlined};
use super::record::TILE;
use super::view::Seen;

/// Pairs of corners: the edges.
const EDGES: [[usize; 2]; 6] = [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]];

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
        // Edges, upper end first.
        let (mut x0, mut y0, mut y1, mut slope) = ([0f64; 8], [0f64; 8], [0f64; 8], [0f64; 8]);
        let mut rise = [1f64; 8];
        for (k, [a, b]) in EDGES.iter().enumerate() {
            let (a, b) = (corners[*a], corners[*b]);
            let down = (a.y, a.x) <= (b.y, b.x);
            let (upper, lower) = if down { (a, b) } else { (b, a) };
            x0[k] = upper.x;
            y0[k] = upper.y;
            y1[k] = lower.y;
            slope[k] = lower.x - upper.x;
            rise[k] = lower.y - upper.y;
        }
        for half in (0..8).step_by(L::D::COUNT) {
            (L::D::load(&slope[half..]) / L::D::load(&rise[half..])).store(&mut slope[half..]);
        }
        let y_top = corners.iter().fold(f64::INFINITY, |y, c| y.min(c.y));
        let y_bottom = corners.iter().fold(f64::NEG_INFINITY, |y, c| y.max(c.y));
        let first = ((y_top.ceil() - top as f64).max(rows.start as f64)) as usize;
        let last = ((y_bottom.ceil() - top as f64).min(rows.end as f64)).max(0.0) as usize;

        let iota: [f64; 8] = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0];
        let (mut from, mut to) = ([0i32; 8], [0i32; 8]);
        let mut row = first;
        while row < last {
            let y = L::D::load(&iota) + L::D::splat((top + row) as f64);
            let mut least = L::D::splat(f64::INFINITY);
            let mut most = L::D::splat(f64::NEG_INFINITY);
            for k in 0..EDGES.len() {
                let crosses = L::D::splat(y0[k]).le(y).and(y.lt(L::D::splat(y1[k])));
                let x = (y - L::D::splat(y0[k])).mul_add(L::D::splat(slope[k]), L::D::splat(x0[k]));
                least = L::D::select(crosses, x.min(least), least);
                most = L::D::select(crosses, x.max(most), most);
            }
            let bound = inlined(
                #[inline(always)]
                |x: L::D| {
                    let x = (x - L::D::splat(left as f64)).ceil();
                    x.max(L::D::splat(0.0)).min(L::D::splat((right - left) as f64))
                },
            );
            // A row without crossings has least = +∞, most = −∞: from = width, to = 0, an empty span.
            bound(least).store_i32(&mut from);
            bound(most).store_i32(&mut to);
            let rows_here = (last - row).min(L::D::COUNT);
            for (i, (&from, &to)) in from.iter().zip(&to).enumerate().take(rows_here) {
                if from < to {
                    let code = (lane << 8 | (row + i) << 4) as u16 + from as u16;
                    let out = &mut self.codes[self.count..self.count + TILE];
                    for (k, out) in out.iter_mut().enumerate() {
                        *out = code + k as u16;
                    }
                    self.count += (to - from) as usize;
                }
            }
            row += L::D::COUNT;
        }
    }
}
