//! Spans: the pixels of a tile that a cell covers, row by row, in closed form.
//!
//! The silhouette of a tetrahedron is the hull of its four projected corners; on one row of pixel centres it is
//! the span between the least and the greatest crossing of its six edges. Each edge is taken from its upper to
//! its lower end, so all cells that share it find the same crossing, bit for bit, and the rules
//! are half-open (a row y belongs to an edge if y₀ ≤ y < y₁, a pixel to a span if ⌈x₀⌉ ≤ x < ⌈x₁⌉): every pixel
//! centre that lies on a shared silhouette edge is given to exactly one of the cells.

use crate::fragments::batch::MAX_LANES;
use crate::project::edge_on::CROSSING_ROUND;
use crate::tile::{PIXELS, TILE};
use crate::view::ScreenVertex;
use voltet_simd::{Double, Float, Lanes, Mask, Unsigned, array, inlined};

/// Pairs of corners: the edges.
const EDGES: [[usize; 2]; 6] = [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]];

/// Codes behind the last fragment that a vector may read.
const PADDING: usize = 32;

/// Shift of the length of a span beside its first code.
const LENGTH_SHIFT: u32 = 16;

/// Fragments of a packet of cells in a tile.
pub(crate) struct Fragments {
    /// Codes, lane of the cell << 8 | row << 4 | column; the first `count` are valid.
    pub codes: Vec<u16>,
    /// Slot of each in the lists, where there are any.
    pub slots: Vec<u32>,
    pub count: usize,
    /// See [`Edges::spans`], row by row.
    spans: CellLanes<TILE, u32>,
}

/// Edges of a packet of cells on one tile, cells side by side.
pub(crate) struct Edges {
    x: [[f64; MAX_LANES]; 4],
    y: [[f64; MAX_LANES]; 4],
    /// First row of the tile that each edge crosses, and the first that it does not cross any more.
    first: CellLanes<6>,
    last: CellLanes<6>,
    /// Column at which it crosses the tile's first row, and its slope (columns a row).
    crossing: CellLanes<6>,
    slope: CellLanes<6>,
    /// See [`CROSSING_ROUND`].
    round: CellLanes<6>,
    /// First and last row of each cell.
    bounds: CellLanes<2>,
}

/// Numbers of cells side by side, aligned to cache lines.
#[derive(Clone, Copy)]
#[repr(align(64))]
struct CellLanes<const N: usize, T = f32>([[T; MAX_LANES]; N]);

impl Edges {
    pub fn new() -> Self {
        let rows = CellLanes([[0.0; MAX_LANES]; 6]);
        Edges {
            x: [[0.0; MAX_LANES]; 4],
            y: [[0.0; MAX_LANES]; 4],
            first: rows,
            last: rows,
            crossing: rows,
            slope: rows,
            round: rows,
            bounds: CellLanes([[0.0; MAX_LANES]; 2]),
        }
    }

    #[inline(always)]
    pub fn take(&mut self, lane: usize, corners: [&ScreenVertex; 4]) {
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
            let load = inlined!(|rows: &[[f64; MAX_LANES]; 4]| {
                let row = inlined!(|k: usize| L::D::load(&rows[k][half..]));
                [row(0), row(1), row(2), row(3)]
            });
            let (x, y) = (load(&self.x), load(&self.y));
            // The first and last row of each edge, and its crossing of the tile's first row, in 64 bits; from there
            // 32 bits carry 16 rows. A horizontal edge has no rows: neither its direction nor its slope matters.
            let row: [L::D; 4] = array!(|k| y[k].ceil() - tile_top);
            for (k, &[a, b]) in EDGES.iter().enumerate() {
                // The slope is the same whichever end is the upper one, bit for bit.
                let tilt = (x[b] - x[a]) / (y[b] - y[a]);
                let down = y[a].le(y[b]);
                let upper = [L::D::select(down, x[a], x[b]), y[a].min(y[b])];
                let at_top = (tile_top - upper[1]).mul_add(tilt, upper[0] - tile_left);
                row[a].min(row[b]).store_f32(&mut self.first.0[k][half..]);
                row[a].max(row[b]).store_f32(&mut self.last.0[k][half..]);
                at_top.store_f32(&mut self.crossing.0[k][half..]);
                tilt.store_f32(&mut self.slope.0[k][half..]);
            }
            let min = row[0].min(row[1]).min(row[2].min(row[3]));
            let max = row[0].max(row[1]).max(row[2].max(row[3]));
            let (from, to) = (splat(rows.start as f64), splat(rows.end as f64));
            min.max(from).min(to).store_f32(&mut self.bounds.0[0][half..]);
            max.min(to).max(from).store_f32(&mut self.bounds.0[1][half..]);
        }
        // Crossings are rounded to 2⁻¹⁷ of a pixel (across the edge): several edges of a face that is seen edge-on
        // lie on one line, and must cross a row at one place although each is rounded in its own way.
        for (slope, round) in self.slope.0.iter().zip(&mut self.round.0) {
            let steep = L::F::load(slope).abs().max(L::F::splat(1.0)).min(L::F::splat(1e6));
            let power = L::F::from_bits(steep.to_bits().and(L::U::splat(0x7f80_0000)));
            (power * L::F::splat(CROSSING_ROUND)).store(round);
        }
    }

    /// The pixels of rows `rows`, of a tile `width` pixels wide, that each cell covers: their code in [`Fragments::codes`] at the
    /// first, and their number in the upper half.
    #[inline(always)]
    fn spans<L: Lanes>(&self, rows: std::ops::Range<usize>, width: usize, spans: &mut CellLanes<TILE, u32>) {
        let splat = L::F::splat;
        let width = splat(width as f32);
        let lanes = L::U::iota().shl::<8>();
        for row in rows {
            let y = splat(row as f32);
            let (mut min, mut max) = (splat(f32::INFINITY), splat(f32::NEG_INFINITY));
            for k in 0..EDGES.len() {
                let edge = inlined!(|rows: &CellLanes<6>| L::F::load(&rows.0[k]));
                let crosses = edge(&self.first).le(y).and(y.lt(edge(&self.last)));
                let x = y.mul_add(edge(&self.slope), edge(&self.crossing));
                let x = (x + edge(&self.round)) - edge(&self.round);
                min = L::F::select(crosses, x.min(min), min);
                max = L::F::select(crosses, x.max(max), max);
            }
            // ⌈x⌉ = −⌊−x⌋. A row without crossings has least = +∞, most = −∞: from = width, to = 0, no span.
            let bound = inlined!(|x: L::F| (-(-x).floor()).max(splat(0.0)).min(width));
            let (from, to) = (bound(min), bound(max));
            let length = (to - from).max(splat(0.0)).to_unsigned().shl::<LENGTH_SHIFT>();
            let code = lanes + L::U::splat((row << 4) as u32) + from.to_unsigned();
            length.or(code).store(&mut spans.0[row]);
        }
    }
}

impl Fragments {
    /// Room for the fragments of `lanes` cells in one tile.
    pub fn new(lanes: usize) -> Self {
        let room = lanes * TILE * TILE + PADDING;
        Fragments {
            codes: vec![0; room],
            slots: vec![0; room],
            count: 0,
            spans: CellLanes([[0; MAX_LANES]; TILE]),
        }
    }

    /// Finds the pixels, of a tile `width` pixels wide, that each of the first `cells` cells covers. Each takes the
    /// `next` slot of its pixel's list, where there are lists.
    #[inline(always)]
    pub fn cover<L: Lanes>(
        &mut self,
        edges: &Edges,
        cells: usize,
        width: usize,
        next: Option<&mut NextSlots>,
    ) {
        let (mut starts, mut ends) = ([0u32; MAX_LANES], [0u32; MAX_LANES]);
        L::F::load(&edges.bounds.0[0]).to_unsigned().store(&mut starts);
        L::F::load(&edges.bounds.0[1]).to_unsigned().store(&mut ends);
        let rows = || starts.iter().zip(&ends).take(cells).filter(|(start, end)| start < end);
        let first = rows().map(|(&start, _)| start).min().unwrap_or(0) as usize;
        let last = rows().map(|(_, &end)| end).max().unwrap_or(0) as usize;
        edges.spans::<L>(first..last, width, &mut self.spans);

        let rows = [starts, ends];
        self.list::<L>(rows, cells, next);
    }

    /// Codes from spans, cell by cell, and slots of lists.
    #[inline(always)]
    fn list<L: Lanes>(
        &mut self,
        [starts, ends]: [[u32; MAX_LANES]; 2],
        cells: usize,
        mut next: Option<&mut NextSlots>,
    ) {
        let Fragments { codes, slots, spans, .. } = self;
        let (codes, slots) = (codes.as_mut_slice(), slots.as_mut_slice());
        let mut count = 0;
        for (lane, (&start, &end)) in starts.iter().zip(&ends).take(cells).enumerate() {
            for row in start as usize..(end as usize).min(TILE) {
                let span = spans.0[row][lane];
                let (code, length) = (span as u16, (span >> LENGTH_SHIFT) as usize);
                let from = usize::from(code) % TILE;
                let out = &mut codes[count..count + TILE];
                for (k, out) in out.iter_mut().enumerate() {
                    *out = code.wrapping_add(k as u16);
                }
                if let Some(next) = &mut next {
                    take_slots::<L>(next, row, from..from + length, &mut slots[count..count + TILE]);
                }
                count += length;
            }
        }
        self.count = count;
        if next.is_some() {
            // A vector may read past the end.
            slots[count..count + MAX_LANES].fill(DUMMY_SLOT);
        }
    }
}

/// Takes a slot for each column of a span, in the first of `slots`; those that follow are not valid.
#[inline(always)]
fn take_slots<L: Lanes>(next: &mut NextSlots, row: usize, span: std::ops::Range<usize>, slots: &mut [u32]) {
    if L::WIDTH == TILE {
        // No load spans what two stores wrote.
        let of_row = &mut next.0[row * TILE..][..TILE];
        let (from, to) = (L::U::splat(span.start as u32), L::U::splat(span.end as u32));
        let value = L::U::load(of_row);
        value.permute((L::U::iota() + from).and(L::U::splat(TILE as u32 - 1))).store(slots);
        taken_of::<L>(value, 0, from, to).store(of_row);
        return;
    }
    slots.copy_from_slice(&next.0[row * TILE + span.start..][..TILE]);
    let (from, to) = (L::U::splat(span.start as u32), L::U::splat(span.end as u32));
    for half in (0..TILE).step_by(L::WIDTH) {
        let of_half = &mut next.0[row * TILE + half..];
        taken_of::<L>(L::U::load(of_half), half, from, to).store(of_half);
    }
}

/// Counters of the columns from `half` on, one more in `from..to`.
#[inline(always)]
fn taken_of<L: Lanes>(value: L::U, half: usize, from: L::U, to: L::U) -> L::U {
    let column = L::U::iota() + L::U::splat(half as u32);
    // Not below a number: the larger of both is the column.
    let (not_before, behind) = (column.max(from).equal(column), column.max(to).equal(column));
    L::U::select(not_before.and(behind.not()), value + L::U::splat(1), value)
}

/// Segments that a pixel's list holds; a tile that needs more is drawn again with lists that grow.
pub(crate) const MAX_LIST_LENGTH: usize = 1024;

/// Bits of a slot's number within its list.
pub(crate) const SLOT_BITS: u32 = 10;

/// Slots of a pixel: each cell of a vector may take one before the lengths are checked. An odd number of cache lines, so that the lists
/// of pixels do not meet in the same sets of a cache.
pub(crate) const SLOTS_PER_PIXEL: usize = MAX_LIST_LENGTH + 20;
const _: () = assert!(SLOTS_PER_PIXEL * size_of::<[f32; 4]>() / 64 % 2 == 1);

/// Slot of fragments that belong to no pixel.
pub(crate) const DUMMY_SLOT: u32 = (PIXELS * SLOTS_PER_PIXEL) as u32;

/// Next free slot of each pixel, row by row; then room to read a whole vector from any of them.
#[derive(Clone, Copy)]
#[repr(align(64))]
pub(crate) struct NextSlots(pub [u32; PIXELS + TILE]);

pub(crate) const FIRST_SLOTS: NextSlots = {
    let mut first = [0; PIXELS + TILE];
    let mut pixel = 0;
    while pixel < first.len() {
        first[pixel] = (pixel * SLOTS_PER_PIXEL) as u32;
        pixel += 1;
    }
    NextSlots(first)
};

impl Default for NextSlots {
    fn default() -> Self {
        FIRST_SLOTS
    }
}
