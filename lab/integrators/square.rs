//! Square tables, bilinear between entries: in 64 bits, and in lanes.

use voltet_simd::{Float, Lanes, Unsigned};

/// A place between four entries of a square table in 64 bits.
pub(crate) struct Bilinear {
    first: usize,
    size: usize,
    row: f64,
    column: f64,
}

impl Bilinear {
    /// Row and column in entries; the table's ends hold on beyond.
    #[inline]
    pub fn new(row: f64, column: f64, size: usize) -> Self {
        let last = (size - 1) as f64;
        let split = |place: f64| {
            let place = place.clamp(0.0, last);
            let low = (place as usize).min(size - 2);
            (low, place - low as f64)
        };
        let ((i, row), (j, column)) = (split(row), split(column));
        Bilinear { first: i * size + j, size, row, column }
    }

    #[inline]
    pub fn read(&self, entry: impl Fn(usize) -> f64) -> f64 {
        let mix = |a: f64, b: f64, share: f64| a + share * (b - a);
        let row = |first: usize| mix(entry(first), entry(first + 1), self.column);
        mix(row(self.first), row(self.first + self.size), self.row)
    }
}

/// A square table, each entry with its neighbours in the next column, the next row and both: one load finds what a place lies
/// between.
#[derive(Debug, Clone)]
pub(crate) struct LaneSquare {
    size: usize,
    entries: Vec<[f32; 4]>,
}

impl LaneSquare {
    /// Table of entries row by row, `size` ≥ 2 a side.
    pub fn new(entries: &[f32], size: usize) -> LaneSquare {
        let at = |j: usize, i: usize| entries[j.min(size - 1) * size + i.min(size - 1)];
        let around = |k: usize| {
            let (row, column) = (k / size, k % size);
            [at(row, column), at(row, column + 1), at(row + 1, column), at(row + 1, column + 1)]
        };
        LaneSquare { size, entries: (0..entries.len()).map(around).collect() }
    }

    #[inline(always)]
    pub fn last(&self) -> f32 {
        (self.size - 1) as f32
    }

    pub fn bytes(&self) -> usize {
        size_of_val(self.entries.as_slice())
    }

    /// Position of a row and a column, each from 0 to [`LaneSquare::last`]; valid for every table of that side.
    #[inline(always)]
    pub fn place<L: Lanes>(&self, row: L::F, column: L::F) -> Place<L> {
        let before = L::F::splat(self.last() - 1.0);
        let (i, j) = (row.floor().min(before), column.floor().min(before));
        let first = i.to_unsigned() * L::U::splat(self.size as u32) + j.to_unsigned();
        Place { first, down: row - i, along: column - j }
    }

    #[inline(always)]
    pub fn read<L: Lanes>(&self, place: &Place<L>) -> L::F {
        let around = L::F::gather_parts(&self.entries, place.first);
        let low = place.along.mul_add(around[1] - around[0], around[0]);
        let high = place.along.mul_add(around[3] - around[2], around[2]);
        place.down.mul_add(high - low, low)
    }
}

#[derive(Clone, Copy)]
pub(crate) struct Place<L: Lanes> {
    first: L::U,
    down: L::F,
    along: L::F,
}
