//! A sorting network over columns that lie side by side, a lane each.

use crate::{Lanes, Unsigned};

/// Sorts the first `rows` rows of `COLUMNS` keys, each column for itself, ascending: Batcher's merge exchange (Knuth, The
/// Art of Computer Programming 3, section 5.2.2, algorithm M), which needs no padding to a power of two. There must be as
/// many rows, and the lanes must divide the columns.
#[inline(always)]
pub fn sort_columns<L: Lanes, const COLUMNS: usize>(keys: &mut [u32], rows: usize) {
    const { assert!(COLUMNS.is_multiple_of(L::WIDTH)) };
    if rows < 2 {
        return;
    }
    let top = 1usize << (usize::BITS - 1 - (rows - 1).leading_zeros());
    let keys = &mut keys[..rows * COLUMNS];
    let mut p = top;
    while p > 0 {
        let (mut q, mut r, mut d) = (top, 0, p);
        loop {
            // All i < rows − d with i & p == r, in runs of p.
            let mut start = r;
            while start < rows - d {
                for i in start..(start + p).min(rows - d) {
                    for column in (0..COLUMNS).step_by(L::WIDTH) {
                        let (low, high) = (i * COLUMNS + column, (i + d) * COLUMNS + column);
                        let (a, b) = (L::U::load(&keys[low..]), L::U::load(&keys[high..]));
                        a.min(b).store(&mut keys[low..]);
                        a.max(b).store(&mut keys[high..]);
                    }
                }
                start += 2 * p;
            }
            if q == p {
                break;
            }
            (d, q, r) = (q - p, q / 2, p);
        }
        p /= 2;
    }
}

#[cfg(test)]
mod tests {
    use super::sort_columns;
    use crate::{Kernel, LaneSet, Lanes, dispatch};

    const COLUMNS: usize = 16;

    struct Sort<'a> {
        keys: &'a mut [u32],
        rows: usize,
    }

    impl Kernel for Sort<'_> {
        type Output = ();
        #[inline(always)]
        fn run<L: Lanes>(self) {
            sort_columns::<L, COLUMNS>(self.keys, self.rows);
        }
    }

    /// Sorts on every lane set and compares with the standard library, column by column.
    fn check(rows: usize, key: impl Fn(usize, usize) -> u32) {
        let keys: Vec<u32> = (0..rows * COLUMNS).map(|at| key(at / COLUMNS, at % COLUMNS)).collect();
        let mut expected = keys.clone();
        for column in 0..COLUMNS {
            let mut sorted: Vec<u32> = keys.iter().skip(column).step_by(COLUMNS).copied().collect();
            sorted.sort_unstable();
            for (row, key) in sorted.into_iter().enumerate() {
                expected[row * COLUMNS + column] = key;
            }
        }
        // What lies behind the rows is not the network's.
        expected.extend([5; COLUMNS]);
        for lanes in LaneSet::ALL {
            if lanes.is_supported() {
                let mut found = keys.clone();
                found.extend([5; COLUMNS]);
                dispatch(lanes, Sort { keys: &mut found, rows });
                assert!(found == expected, "{rows} rows on {}", lanes.name());
            }
        }
    }

    /// A network that sorts every sequence of zeros and ones sorts every sequence (Knuth, section 5.3.4, theorem Z).
    #[test]
    fn up_to_fourteen_rows_it_sorts_everything() {
        let most = if cfg!(miri) { 5 } else { 14 };
        for rows in 0..=most {
            for first in (0..1usize << rows).step_by(COLUMNS) {
                check(rows, |row, column| if (first + column) >> row & 1 == 1 { u32::MAX } else { 0 });
            }
        }
    }

    #[test]
    fn it_sorts_any_number_of_rows() {
        let mut state = 7u32;
        let sizes: Vec<usize> = if cfg!(miri) { vec![15, 16, 17, 33] } else { (15..=1025).collect() };
        for rows in sizes {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let random = |row: usize, column: usize| {
                (row * COLUMNS + column) as u32 ^ state.wrapping_mul(2 * (row * COLUMNS + column) as u32 + 1)
            };
            // Sorted, reversed, all equal, few different, one step from zeros to ones, unused slots; the rest at random.
            check(rows, |row, column| match column {
                0 => row as u32,
                1 => u32::MAX - row as u32,
                2 => 0x8000_0000,
                3 => random(row, column) % 3,
                4 => u32::from((row * 7 + rows / 2) % rows >= state as usize % rows),
                5 if row % 3 == 0 => u32::MAX,
                _ => random(row, column),
            });
        }
    }
}
