//! Adjacency tables: the tetrahedra around a point, and the points that share an edge with it; made on demand, in parallel, always in
//! the same order.

use super::Grid;
use super::faces::{CoincidentPoints, Face, each_face};
use rayon::prelude::*;
use std::sync::atomic::{AtomicU32, Ordering};

/// Rows of numbers, side by side in one array.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Csr {
    /// Row i is `items[starts[i] .. starts[i + 1]]`.
    pub starts: Vec<usize>,
    /// All rows.
    pub items: Vec<u32>,
}

impl Csr {
    /// Row `i`.
    #[inline]
    pub fn row(&self, i: usize) -> &[u32] {
        &self.items[self.starts[i]..self.starts[i + 1]]
    }

    /// Number of rows.
    pub fn count(&self) -> usize {
        self.starts.len().saturating_sub(1)
    }
}

/// Parts of these lengths, one behind the other.
pub(super) fn split_lengths<T>(mut rest: &mut [T], lengths: impl Iterator<Item = usize>) -> Vec<&mut [T]> {
    lengths.map(|length| rest.split_off_mut(..length).expect("the lengths add up to no more")).collect()
}

/// Tetrahedra whose lowest and highest point number are looked at together.
const BLOCK: usize = 4096;

/// The tetrahedra by ranges of points.
///
/// Every task takes a range of points and reads the tetrahedra, skipping blocks of them that lie outside its range;
/// so no two tasks write to the same place, and the order in which a point meets its tetrahedra (ascending) does not
/// depend on the number of threads.
struct TetrahedraByPointRange<'a> {
    tetrahedra: &'a [[u32; 4]],
    /// Lowest and highest point number of every block of tetrahedra.
    spans: Vec<(u32, u32)>,
    task_points: usize,
}

impl<'a> TetrahedraByPointRange<'a> {
    fn new(grid: &'a Grid) -> Self {
        let tetrahedra = &grid.tetrahedra[..];
        let spans = tetrahedra
            .par_chunks(BLOCK)
            .map(|block| block.iter().fold((u32::MAX, 0), |(low, high), t| (low.min(t[0]), high.max(t[3]))))
            .collect();
        // Two tasks a thread even out their loads; more would read the tetrahedra more often.
        let tasks = 2 * rayon::current_num_threads();
        TetrahedraByPointRange { tetrahedra, spans, task_points: grid.points.len().div_ceil(tasks).max(1024) }
    }

    /// Calls `f(tetrahedron, its corners)` for every tetrahedron that may use one of the `count` points from `first`.
    #[inline]
    fn each(&self, first: usize, count: usize, mut f: impl FnMut(usize, &[u32; 4])) {
        for (b, block) in self.tetrahedra.chunks(BLOCK).enumerate() {
            let (low, high) = self.spans[b];
            if (high as usize) < first || low as usize >= first + count {
                continue;
            }
            for (i, t) in block.iter().enumerate() {
                // Corners ascend.
                if (t[3] as usize) >= first && (t[0] as usize) < first + count {
                    f(b * BLOCK + i, t);
                }
            }
        }
    }
}

/// For every point the tetrahedra that use it, ascending.
pub fn cells_of_points(grid: &Grid) -> Csr {
    let point_count = grid.points.len();
    let ranges = TetrahedraByPointRange::new(grid);
    let task_points = ranges.task_points;
    let mut starts = vec![0_usize; point_count + 1];
    starts[1..].par_chunks_mut(task_points).enumerate().for_each(|(task, counts)| {
        let first = task * task_points;
        ranges.each(first, counts.len(), |_, t| {
            for &p in t {
                if let Some(count) = counts.get_mut((p as usize).wrapping_sub(first)) {
                    *count += 1;
                }
            }
        });
    });
    for i in 0..point_count {
        starts[i + 1] += starts[i];
    }
    let mut items = vec![0_u32; starts[point_count]];
    let tasks =
        (0..point_count).step_by(task_points).map(|first| (first, task_points.min(point_count - first)));
    let lengths = tasks.clone().map(|(first, count)| starts[first + count] - starts[first]);
    let slots: Vec<_> = tasks.zip(split_lengths(&mut items, lengths)).collect();
    slots.into_par_iter().for_each(|((first, count), items)| {
        let mut next: Vec<usize> =
            starts[first..first + count].iter().map(|&start| start - starts[first]).collect();
        ranges.each(first, count, |cell, t| {
            for &p in t {
                if let Some(next) = next.get_mut((p as usize).wrapping_sub(first)) {
                    items[*next] = cell as u32;
                    *next += 1;
                }
            }
        });
    });
    Csr { starts, items }
}

/// For every point the sum of `term` over the tetrahedra that use it, in ascending order: `add` is called for each
/// corner with what `term` gave for the tetrahedron. Needs no list of the cells of each point.
pub fn sum_over_cells<S, T>(
    grid: &Grid,
    term: impl Fn(usize) -> Option<T> + Sync,
    add: impl Fn(&mut S, &T) + Sync,
) -> Vec<S>
where
    S: Clone + Default + Send,
{
    let ranges = TetrahedraByPointRange::new(grid);
    let mut sums = vec![S::default(); grid.points.len()];
    sums.par_chunks_mut(ranges.task_points).enumerate().for_each(|(task, sums)| {
        let first = task * ranges.task_points;
        ranges.each(first, sums.len(), |cell, t| {
            if t.iter().all(|&p| (p as usize).wrapping_sub(first) >= sums.len()) {
                return;
            }
            if let Some(term) = term(cell) {
                for &p in t {
                    if let Some(sum) = sums.get_mut((p as usize).wrapping_sub(first)) {
                        add(sum, &term);
                    }
                }
            }
        });
    });
    sums
}

/// For every face of the tetrahedra (four each, by the corner opposite) the face of the tetrahedron that shares its points:
/// 4 × tetrahedron + corner; `u32::MAX` where none or several others do, or where the numbers leave 32 bits.
pub fn cells_of_faces(grid: &Grid) -> Vec<u32> {
    let tetrahedra = &grid.tetrahedra[..];
    let none: Vec<AtomicU32> = (0..4 * tetrahedra.len()).map(|_| AtomicU32::new(u32::MAX)).collect();
    if u32::try_from(none.len()).is_ok() {
        let place = |[_, _, cell, opposite]: Face| {
            let corner = tetrahedra[cell as usize].iter().position(|p| *p == opposite).unwrap_or(0);
            4 * cell + corner as u32
        };
        let look = |_: &mut (), _, shared: &[Face]| {
            if let [one, other] = *shared {
                let [one, other] = [place(one), place(other)];
                none[one as usize].store(other, Ordering::Relaxed);
                none[other as usize].store(one, Ordering::Relaxed);
            }
        };
        each_face(&grid.points, tetrahedra, &CoincidentPoints(None), || (), look, |(), ()| ());
    }
    none.into_iter().map(AtomicU32::into_inner).collect()
}

/// For every point the points it shares an edge of a tetrahedron with, each once, in order of first appearance.
pub fn points_of_points(grid: &Grid, cells_of_points: &Csr) -> Csr {
    rows(grid.points.len(), |neighbours, p| neighbours.around(grid, cells_of_points, p))
}

/// For every point its neighbours, then theirs, each once.
pub fn second_rings(neighbours_of_points: &Csr) -> Csr {
    rows(neighbours_of_points.starts.len() - 1, |neighbours, p| {
        neighbours.second_ring(neighbours_of_points, p)
    })
}

/// The rows that `row` gives for each point.
fn rows(point_count: usize, row: impl for<'a> Fn(&'a mut Neighbours, usize) -> &'a [u32] + Sync) -> Csr {
    const TASK: usize = 1024;
    let parts: Vec<(Vec<u32>, Vec<u32>)> = (0..point_count.div_ceil(TASK))
        .into_par_iter()
        .map_init(Neighbours::default, |neighbours, task| {
            // A point of a tetrahedral grid has some 14 neighbours.
            let (mut counts, mut items) = (Vec::with_capacity(TASK), Vec::with_capacity(16 * TASK));
            for p in task * TASK..((task + 1) * TASK).min(point_count) {
                let row = row(neighbours, p);
                counts.push(row.len() as u32);
                items.extend_from_slice(row);
            }
            (counts, items)
        })
        .collect();
    let mut starts = Vec::with_capacity(point_count + 1);
    starts.push(0);
    let mut sum = 0;
    for &count in parts.iter().flat_map(|(counts, _)| counts) {
        sum += count as usize;
        starts.push(sum);
    }
    let mut items = vec![0; sum];
    let slots = split_lengths(&mut items, parts.iter().map(|(_, part)| part.len()));
    slots.into_par_iter().zip(&parts).for_each(|(slot, (_, part))| slot.copy_from_slice(part));
    Csr { starts, items }
}

/// Finds the neighbours of one point after another; holds the memory for it.
#[derive(Debug, Default)]
pub struct Neighbours {
    found: Vec<u32>,
    /// Open hash table of the numbers in `found` plus 1; 0 is free. All free between calls.
    table: Vec<u32>,
    /// 32 − log₂ of the table's length.
    shift: u32,
}

impl Neighbours {
    /// The points that share an edge with `point`, each once, in order of first appearance.
    pub fn around(&mut self, grid: &Grid, cells_of_points: &Csr, point: usize) -> &[u32] {
        self.clear();
        let cells = cells_of_points.row(point);
        self.make_room(3 * cells.len());
        self.insert(point as u32);
        for &cell in cells {
            for &p in &grid.tetrahedra[cell as usize] {
                self.insert(p);
            }
        }
        &self.found[1..]
    }

    /// Neighbours of a point, and their neighbours.
    pub fn second_ring(&mut self, neighbours_of_points: &Csr, point: usize) -> &[u32] {
        self.clear();
        let first = neighbours_of_points.row(point);
        self.make_room(first.iter().map(|&p| neighbours_of_points.row(p as usize).len()).sum());
        self.insert(point as u32);
        for &p in first {
            self.insert(p);
        }
        for &p in first {
            for &q in neighbours_of_points.row(p as usize) {
                self.insert(q);
            }
        }
        &self.found[1..]
    }

    fn clear(&mut self) {
        if self.table.len() <= 4 * self.found.len() {
            self.table.fill(0);
        } else {
            for i in 0..self.found.len() {
                // The slots on the way to a number are all taken by other numbers of `found`.
                let mut slot = self.first_slot(self.found[i]);
                while self.table[slot] != 0 {
                    self.table[slot] = 0;
                    slot = (slot + 1) & (self.table.len() - 1);
                }
            }
        }
        self.found.clear();
    }

    fn make_room(&mut self, count: usize) {
        let wanted = (2 * (count + 1)).next_power_of_two().clamp(128, 1 << 31);
        if self.table.len() < wanted {
            self.table = vec![0; wanted];
            self.shift = 32 - wanted.trailing_zeros();
        }
    }

    #[inline]
    fn first_slot(&self, p: u32) -> usize {
        // Fibonacci hashing (Knuth, volume 3, section 6.4): the top bits of p × 2³²/φ.
        (p.wrapping_mul(0x9E37_79B9) >> self.shift) as usize
    }

    #[inline]
    fn insert(&mut self, p: u32) {
        let mut slot = self.first_slot(p);
        loop {
            let held = self.table[slot];
            if held == p.wrapping_add(1) {
                return;
            }
            if held == 0 {
                self.table[slot] = p.wrapping_add(1);
                self.found.push(p);
                return;
            }
            slot = (slot + 1) & (self.table.len() - 1);
        }
    }
}
