//! Percentiles of a field by volume, exact within cells.
//!
//! A field is linear in each cell, so the volume where it is below a value has a closed form
//! ([`Distribution`]). The percentile is found by halving an interval of values; cells that lie on one side of it are
//! summed once and not looked at again, so that after a few rounds only those are left that the value passes through.

use super::CELLS_PER_CHECK;
use super::sub_tetrahedron::{Distribution, scaled_volume};
use crate::grid::Grid;
use crate::grid::extent::range;
use crate::progress::{Progress, StageProgress, refuse_beyond_memory};
use crate::{Error, Result, counted};
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};

/// Cells that one task looks at: sums are made in a fixed order, the same on any number of cores.
const CHUNK: usize = 1 << 13;
/// Halvings before a list of the cells that are left is made.
const ROUNDS_OVER_ALL: usize = 3;
/// Volumes of a billion cells add up to within some 1e-13 of their sum; where a share is met to this, it is met.
const ROUNDING: f64 = 1e-12;

/// The volume where a field is below some value, for the cells of a grid.
pub struct Volumes {
    cells: Vec<CellSpan>,
    /// From the scale to world units cubed.
    world: f64,
    total: f64,
}

#[derive(Clone, Copy)]
struct CellSpan {
    /// In the grid's own scale.
    volume: f64,
    /// The values at its corners, rising.
    values: [f64; 4],
}

impl CellSpan {
    fn below(&self, value: f64) -> f64 {
        let [low, .., high] = self.values;
        match value {
            _ if value <= low => 0.0,
            _ if value > high => self.volume,
            _ => self.volume * Distribution::new(self.values).below(value),
        }
    }
}

fn sum(cells: &[CellSpan], of: impl Fn(&CellSpan) -> f64 + Sync) -> f64 {
    let parts: Vec<f64> = cells.par_chunks(CHUNK).map(|part| part.iter().map(&of).sum()).collect();
    parts.iter().sum()
}

impl Volumes {
    /// Distribution of a field, one value a point. Cells with a value that is not finite are ignored.
    ///
    /// Errors: no cell with a volume has finite values; memory ends; a stopped run.
    pub fn new(grid: &Grid, values: &[f64], progress: &dyn Progress) -> Result<Volumes> {
        grid.check_values("a field", values)?;
        let count = grid.tetrahedra.len();
        let bytes = (count * (size_of::<CellSpan>() + size_of::<CellSpan>() / 2)) as u64;
        let what = || format!("the distribution of a field over {}", counted(count, "tetrahedron"));
        refuse_beyond_memory(progress, what, bytes)?;
        let scale = grid.length_scale();
        let (sorted, stopped) = (StageProgress::new(progress, "distribution", count), AtomicBool::new(false));
        let cell = |i: usize| {
            if stopped.load(Ordering::Relaxed) {
                return None;
            }
            if i.is_multiple_of(CELLS_PER_CHECK) {
                sorted.advance(CELLS_PER_CHECK.min(count - i));
                stopped.fetch_or(progress.cancelled(), Ordering::Relaxed);
            }
            let mut values = grid.tetrahedra[i].map(|p| values[p as usize]);
            values.sort_unstable_by(f64::total_cmp);
            let volume = scaled_volume(grid, i, scale);
            (volume > 0.0 && values.iter().all(|v| v.is_finite())).then_some(CellSpan { volume, values })
        };
        let cells: Vec<CellSpan> = (0..count).into_par_iter().filter_map(cell).collect();
        progress.check_cancelled()?;
        let total = sum(&cells, |cell| cell.volume);
        match total > 0.0 {
            true => Ok(Volumes { cells, world: (1.0 / scale).powi(3), total }),
            false => {
                Err(Error::run("a percentile is asked of cells without volume or without finite values")
                    .expected("cells with a volume and values"))
            }
        }
    }

    /// Volume of all cells, world units cubed.
    pub fn total(&self) -> f64 {
        self.total * self.world
    }

    /// The volume where the field is below `value`, world units cubed.
    pub fn below(&self, value: f64) -> f64 {
        sum(&self.cells, |cell| cell.below(value)) * self.world
    }

    /// Volume below each of several ascending values. Errors: a stopped run.
    pub fn below_each(&self, values: &[f64], progress: &dyn Progress) -> Result<Vec<f64>> {
        let none = || vec![0.0; values.len()];
        let parts: Vec<Vec<f64>> = (self.cells.par_chunks(self.cells.len().div_ceil(16).max(1)))
            .map(|part| {
                let (mut sums, mut above) = (none(), none());
                let chunks = part.chunks(CELLS_PER_CHECK).take_while(|_| !progress.cancelled());
                for cell in chunks.flatten() {
                    let first = values.partition_point(|&value| value <= cell.values[0]);
                    let last = values.partition_point(|&value| value <= cell.values[3]);
                    let distribution = Distribution::new(cell.values);
                    for (sum, &value) in sums[first..last].iter_mut().zip(&values[first..last]) {
                        *sum += cell.volume * distribution.below(value);
                    }
                    // Whole from here on.
                    if let Some(above) = above.get_mut(last) {
                        *above += cell.volume;
                    }
                }
                let mut whole = 0.0;
                for (sum, above) in sums.iter_mut().zip(above) {
                    whole += above;
                    *sum += whole;
                }
                sums
            })
            .collect();
        progress.check_cancelled()?;
        let mut sums = none();
        parts.iter().for_each(|part| sums.iter_mut().zip(part).for_each(|(sum, part)| *sum += part));
        sums.iter_mut().for_each(|sum| *sum *= self.world);
        Ok(sums)
    }

    /// The least value that the field has or falls below in so many percent of the volume: the least of all for 0, the largest
    /// for 100. Where no volume lies between two values, the lower one.
    pub fn percentile(&self, percent: f64, progress: &dyn Progress) -> Result<f64> {
        let mut low = self.cells.iter().map(|cell| cell.values[0]).fold(f64::INFINITY, f64::min);
        let mut high = self.cells.iter().map(|cell| cell.values[3]).fold(f64::NEG_INFINITY, f64::max);
        if percent <= 0.0 {
            return Ok(low);
        }
        if percent >= 100.0 || low == high {
            return Ok(high);
        }
        let wanted = (percent / 100.0 - ROUNDING) * self.total;
        // What lies whole below the interval, and the cells that may not; all of them at first.
        let (mut under, mut left): (f64, Option<Vec<CellSpan>>) = (0.0, None);
        // The volume up to and with `low` is too little (or `low` is the least), that up to and with `high` is enough.
        if sum(&self.cells, |cell| cell.below(low.next_up())) >= wanted {
            return Ok(low);
        }
        for round in 0.. {
            progress.check_cancelled()?;
            let middle = 0.5 * low + 0.5 * high;
            if middle <= low || middle >= high {
                break;
            }
            let cells = left.as_ref().unwrap_or(&self.cells);
            let volume = under + sum(cells, |cell| cell.below(middle.next_up()));
            if volume >= wanted {
                high = middle
            } else {
                low = middle
            }
            // What lies whole on one side is known for good. At first that is little, and a list would be as long as that of all.
            if round >= ROUNDS_OVER_ALL {
                let sure = |cell: &CellSpan| cell.values[3] <= low;
                under += sum(cells, |cell| if sure(cell) { cell.volume } else { 0.0 });
                left = Some(
                    cells.iter().filter(|cell| !sure(cell) && cell.values[0] <= high).copied().collect(),
                );
            }
        }
        Ok(high)
    }
}

/// The least and the largest value of a field; an error where none is finite or their difference is not.
pub fn value_range(values: &[f64]) -> Result<[f64; 2]> {
    match range(values) {
        Some([low, high]) if (high - low).is_finite() => Ok([low, high]),
        Some([low, high]) => Err(Error::run("the range of a field is beyond 64-bit floats")
            .got(format!("{low:?} to {high:?}"))
            .expected("values below 8e307")),
        None => Err(Error::run("a field has no finite values, so nothing can be relative to them")),
    }
}
