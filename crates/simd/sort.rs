//! A sorting network over columns that lie side by side, a lane each.

use crate::{Lanes, Unsigned};

/// Rows that are put in order in registers.
pub const BLOCK: usize = 16;

type Block<L> = [<L as Lanes>::U; BLOCK];

/// Sorts the first `rows` rows of `COLUMNS` keys, each column for itself, ascending: Batcher's bitonic sorter (Knuth, The Art of
/// Computer Programming 3, section 5.3.4) with all comparators in one direction, so that rows that are not there may count as the
/// largest. Blocks of [`BLOCK`] rows are sorted in registers, then runs of blocks are merged. The rows must lie before as many as
/// fill their last block, which become `u32::MAX`; and the lanes must divide the columns.
#[inline(always)]
pub fn sort_columns<L: Lanes, const COLUMNS: usize>(keys: &mut [u32], rows: usize) {
    const { assert!(COLUMNS.is_multiple_of(L::WIDTH)) };
    if rows < 2 {
        return;
    }
    let rows_of_keys = keys.as_chunks_mut::<COLUMNS>().0;
    let blocks = &mut rows_of_keys.as_chunks_mut::<BLOCK>().0[..rows.div_ceil(BLOCK)];
    if let Some(last) = blocks.last_mut() {
        last[(rows - 1) % BLOCK + 1..].fill([u32::MAX; COLUMNS]);
    }
    each::<L, COLUMNS>(
        blocks,
        inlined!(|block: &mut Block<L>| {
            mirror::<L, 1>(block);
            mirror::<L, 2>(block);
            halve::<L, 1>(block);
            mirror::<L, 4>(block);
            halve::<L, 2>(block);
            halve::<L, 1>(block);
            mirror::<L, 8>(block);
            halve::<L, 4>(block);
            halve::<L, 2>(block);
            halve::<L, 1>(block);
        }),
    );
    let mut run = 1;
    while run < blocks.len() {
        for pair in blocks.chunks_mut(2 * run).filter(|pair| run < pair.len()) {
            merge::<L, COLUMNS>(pair, run);
        }
        run *= 2;
    }
}

/// Makes one run of two, the first of so many blocks, the other of as many or less.
#[inline(always)]
fn merge<L: Lanes, const COLUMNS: usize>(pair: &mut [[[u32; COLUMNS]; BLOCK]], run: usize) {
    let (low, high) = pair.split_at_mut(run);
    // The last block of the first run meets the first of the other, and so outwards.
    for (low, high) in low.iter_mut().rev().zip(high) {
        for (low, high) in low.iter_mut().zip(high.iter_mut().rev()) {
            exchange_rows::<L, COLUMNS>(low, high);
        }
    }
    let mut distance = run / 2;
    while distance > 0 {
        for pair in pair.chunks_mut(2 * distance).filter(|pair| distance < pair.len()) {
            let (low, high) = pair.split_at_mut(distance);
            for (low, high) in low.as_flattened_mut().iter_mut().zip(high.as_flattened_mut()) {
                exchange_rows::<L, COLUMNS>(low, high);
            }
        }
        distance /= 2;
    }
    each::<L, COLUMNS>(
        pair,
        inlined!(|block: &mut Block<L>| {
            halve::<L, 8>(block);
            halve::<L, 4>(block);
            halve::<L, 2>(block);
            halve::<L, 1>(block);
        }),
    );
}

/// Takes each block into registers, as many columns at a time as there are lanes, and puts it back.
#[inline(always)]
fn each<L: Lanes, const COLUMNS: usize>(
    blocks: &mut [[[u32; COLUMNS]; BLOCK]],
    change: impl Fn(&mut Block<L>),
) {
    for rows in blocks {
        for column in (0..COLUMNS).step_by(L::WIDTH) {
            let mut block = [L::U::splat(0); BLOCK];
            for (keys, row) in block.iter_mut().zip(rows.iter()) {
                *keys = L::U::load(&row[column..]);
            }
            change(&mut block);
            for (keys, row) in block.iter().zip(rows.iter_mut()) {
                keys.store(&mut row[column..]);
            }
        }
    }
}

#[inline(always)]
fn exchange_rows<L: Lanes, const COLUMNS: usize>(low: &mut [u32; COLUMNS], high: &mut [u32; COLUMNS]) {
    for column in (0..COLUMNS).step_by(L::WIDTH) {
        let (a, b) = (L::U::load(&low[column..]), L::U::load(&high[column..]));
        a.min(b).store(&mut low[column..]);
        a.max(b).store(&mut high[column..]);
    }
}

#[inline(always)]
fn exchange<L: Lanes>(block: &mut Block<L>, low: usize, high: usize) {
    let (a, b) = (block[low], block[high]);
    (block[low], block[high]) = (a.min(b), a.max(b));
}

/// Compares in every run of 2 N rows the first with the last, and so inwards.
#[inline(always)]
fn mirror<L: Lanes, const N: usize>(block: &mut Block<L>) {
    for row in 0..BLOCK {
        if row & N == 0 {
            exchange::<L>(block, row, row ^ (2 * N - 1));
        }
    }
}

/// Compares in every run of 2 N rows each of the first half with the one N further.
#[inline(always)]
fn halve<L: Lanes, const N: usize>(block: &mut Block<L>) {
    for row in 0..BLOCK {
        if row & N == 0 {
            exchange::<L>(block, row, row + N);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{BLOCK, sort_columns};
    use crate::{Kernel, LaneSet, Lanes, dispatch};

    const COLUMNS: usize = 16;

    struct Sort<'a> {
        keys: &'a mut [u32],
        rows: usize,
    }

    impl Kernel for Sort<'_> {
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
        // What lies behind the rows' last block is not the network's.
        let filling = (rows.next_multiple_of(BLOCK) - rows) * COLUMNS;
        expected.extend(vec![if rows < 2 { 5 } else { u32::MAX }; filling]);
        expected.extend([5; COLUMNS]);
        for lanes in LaneSet::ALL {
            if lanes.is_supported() {
                let mut found = keys.clone();
                found.extend(vec![5; filling + COLUMNS]);
                dispatch(lanes, Sort { keys: &mut found, rows });
                assert!(found == expected, "{rows} rows on {}", lanes.name());
            }
        }
    }

    /// A network that sorts every sequence of zeros and ones sorts every sequence (Knuth, section 5.3.4, theorem Z).
    #[test]
    fn up_to_sixteen_rows_it_sorts_everything() {
        let most = if cfg!(miri) { 5 } else { BLOCK };
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
