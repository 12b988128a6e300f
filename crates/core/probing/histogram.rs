//! The distribution of the data over the plane of two fields, weighted by volume and exact within each cell.
//!
//! s and g are linear in a tetrahedron, so the volume that falls into a bin is that of the tetrahedron cut by four
//! half-spaces. A cell is cut into columns of bins along the axis on which it touches fewer; within a column each piece
//! has a distribution along the other axis in closed form ([`Distribution`]). Most cells touch few bins.
//!
//! Values are measured in bins from the lower end of the axis, so that edges are whole numbers. Volumes are summed in
//! a fixed order: the same data give the same bits on any number of cores.

use super::CELLS_PER_CHECK;
use super::sub_tetrahedron::scaled_volume;
use super::sub_tetrahedron::{Distribution, SubTetrahedron};
use crate::grid::Grid;
use crate::grid::extent::range;
use crate::progress::{Progress, StageProgress};
use crate::{Error, Result};
use rayon::prelude::*;

/// The bins along one field: `bins` of equal width from `low` to `high`; `high` itself belongs to the last.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Axis {
    /// Lower end.
    pub low: f64,
    /// Upper end, > `low`.
    pub high: f64,
    /// Number of bins, ≥ 1.
    pub bins: usize,
}

/// Volumes by bin.
#[derive(Debug, Clone, PartialEq)]
pub struct Histogram {
    /// The axes of s and g.
    pub axes: [Axis; 2],
    /// Volume in each bin, world units cubed; bins of s side by side, rows in rising g.
    pub volumes: Vec<f64>,
    /// Volume of all cells.
    pub total: f64,
    /// Volume where a value lies beyond the axes.
    pub outside: f64,
    /// Volume of the cells with a value that is not finite.
    pub not_finite: f64,
}

impl Histogram {
    /// Along the second axis, over all of the first: below what nearly all of the volume lies, all but a thousandth. What lies beyond
    /// is of few cells, mostly slivers, whose gradients are many times those of the others.
    pub fn nearly_all(&self) -> f64 {
        const RANGE_TOLERANCE: f64 = 1e-3;
        let axis = &self.axes[1];
        let all: f64 = self.volumes.iter().sum();
        let mut below = 0.0;
        let last = self.volumes.chunks(self.axes[0].bins.max(1)).position(|row| {
            row.iter().for_each(|volume| below += volume);
            below >= (1.0 - RANGE_TOLERANCE) * all
        });
        last.map_or(axis.high, |row| axis.edge(row + 1))
    }
}

impl Axis {
    /// From the smallest to the largest finite value; a constant field gets an axis around it.
    pub fn over(values: &[f64], bins: usize) -> Axis {
        let [low, high] = range(values).unwrap_or([0.0, 1.0]);
        if low < high {
            return Axis { low, high, bins };
        }
        // A thousandth of the value, or 1 about 0.
        let half = if low == 0.0 { 0.5 } else { 5e-4 * low.abs() };
        Axis { low: low - half, high: low + half, bins }
    }

    /// The lower edge of bin `i`.
    pub fn edge(&self, i: usize) -> f64 {
        let (count, above) = (self.bins as f64, i as f64);
        let edge = (self.low * (count - above) + self.high * above) / count;
        if edge.is_finite() { edge } else { self.low * (1.0 - above / count) + self.high * (above / count) }
    }

    /// The value in bins.
    fn position(&self, value: f64) -> f64 {
        // Halves, since the width may leave the number range.
        (0.5 * value - 0.5 * self.low) / (0.5 * self.high - 0.5 * self.low) * self.bins as f64
    }

    fn check(&self) -> Result<()> {
        let ordered = self.low.is_finite() && self.high.is_finite() && self.low < self.high;
        match ordered && (1..=4096).contains(&self.bins) {
            true => Ok(()),
            false => Err(Error::usage("an axis of the histogram is out of range")
                .got(format!("{} bins from {} to {}", self.bins, self.low, self.high))
                .expected("1 to 4096 bins, the lower end first")),
        }
    }
}

/// Memory that the partial sums may take, bytes.
const BUDGET: usize = 1 << 27;

/// The histogram of two fields, one value a point each.
pub fn histogram(
    grid: &Grid,
    fields: [&[f64]; 2],
    axes: [Axis; 2],
    progress: &dyn Progress,
) -> Result<Histogram> {
    axes.iter().try_for_each(Axis::check)?;
    fields.iter().try_for_each(|values| grid.check_values("a field of the histogram", values))?;
    let scale = grid.length_scale();
    let count = axes[0].bins * axes[1].bins;
    let cells = grid.tetrahedra.len();
    let tasks = (BUDGET / (8 * count)).clamp(4, 64);
    let per_task = cells.div_ceil(tasks).max(1);
    let summed = StageProgress::new(progress, "histogram", cells);
    let parts: Vec<Histogram> = (0..cells.div_ceil(per_task))
        .into_par_iter()
        .map(|task| {
            let volumes = vec![0.0; count];
            let mut sums = Histogram { axes, volumes, total: 0.0, outside: 0.0, not_finite: 0.0 };
            let end = ((task + 1) * per_task).min(cells);
            for first in (task * per_task..end).step_by(CELLS_PER_CHECK) {
                if progress.cancelled() {
                    break;
                }
                let chunk = first..(first + CELLS_PER_CHECK).min(end);
                for i in chunk.clone() {
                    let at = grid.tetrahedra[i].map(|p| p as usize);
                    sums.add_cell(scaled_volume(grid, i, scale), at.map(|p| [fields[0][p], fields[1][p]]));
                }
                summed.advance(chunk.len());
            }
            sums
        })
        .collect();
    progress.check_cancelled()?;
    let world = |volume: f64| volume / scale / scale / scale;
    let mut volumes = vec![0.0; count];
    volumes.par_iter_mut().with_min_len(1 << 12).enumerate().for_each(|(bin, volume)| {
        *volume = world(parts.iter().map(|part| part.volumes[bin]).sum());
    });
    let sum = |of: fn(&Histogram) -> f64| world(parts.iter().map(of).sum());
    Ok(Histogram {
        axes,
        volumes,
        total: sum(|part| part.total),
        outside: sum(|part| part.outside),
        not_finite: sum(|part| part.not_finite),
    })
}

/// Sums of one task: volumes in the grid's scale.
impl Histogram {
    fn add_cell(&mut self, volume: f64, corners: [[f64; 2]; 4]) {
        self.total += volume;
        if volume <= 0.0 {
            return;
        }
        if !corners.as_flattened().iter().all(|v| v.is_finite()) {
            self.not_finite += volume;
            return;
        }
        let places = corners.map(|[s, g]| [self.axes[0].position(s), self.axes[1].position(g)]);
        let whole = SubTetrahedron { volume_fraction: volume, corners: places };
        let beyond =
            |axis: usize| places.iter().any(|p| p[axis] < 0.0 || p[axis] > self.axes[axis].bins as f64);
        if !beyond(0) && !beyond(1) {
            return self.add(&whole);
        }
        let mut pieces = vec![whole];
        let mut cut = Vec::new();
        for (axis, end, sign) in [(0, false, 1.0), (0, true, -1.0), (1, false, 1.0), (1, true, -1.0)] {
            let bound = if end { self.axes[axis].bins as f64 } else { 0.0 };
            cut.clear();
            for piece in &pieces {
                let f = piece.corners.map(|p| sign * (p[axis] - bound));
                // A face of the axes' rectangle belongs to it, so what lies in it whole is kept.
                match f.iter().all(|&f| f >= 0.0) {
                    true => cut.push(*piece),
                    false => piece.clip_to_level(f, |part| cut.push(part)),
                }
            }
            std::mem::swap(&mut pieces, &mut cut);
        }
        let inside: f64 = pieces.iter().map(|piece| piece.volume_fraction).sum();
        self.outside += (volume - inside).max(0.0);
        pieces.iter().for_each(|piece| self.add(piece));
    }

    /// First and last bin that a piece touches along an axis.
    fn bins_touched(&self, corners: &[[f64; 2]; 4], axis: usize) -> (usize, usize) {
        let at = corners.map(|c| c[axis]);
        let low = at.iter().copied().fold(f64::INFINITY, f64::min);
        let high = at.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let most = self.axes[axis].bins - 1;
        let first = (low.max(0.0) as usize).min(most);
        (first, ((high.ceil().max(1.0) as usize) - 1).clamp(first, most))
    }

    /// Adds a piece that lies within the axes.
    fn add(&mut self, piece: &SubTetrahedron<2>) {
        let touched = [self.bins_touched(&piece.corners, 0), self.bins_touched(&piece.corners, 1)];
        let [s, g] = touched.map(|(first, last)| last - first);
        let across = if s <= g { 0 } else { 1 };
        let (first, last) = touched[across];
        if first == last {
            return self.add_column(piece, across, first);
        }
        for column in first..=last {
            let above = piece.corners.map(|c| c[across] - column as f64);
            let mut part = |part: SubTetrahedron<2>| {
                if column == last {
                    return self.add_column(&part, across, column);
                }
                let below = part.corners.map(|c| (column + 1) as f64 - c[across]);
                part.clip_to_level(below, |part| self.add_column(&part, across, column));
            };
            if column == first { part(*piece) } else { piece.clip_to_level(above, part) }
        }
    }

    /// Adds a piece that lies within one column of bins, the column being a bin of the axis `across`.
    fn add_column(&mut self, piece: &SubTetrahedron<2>, across: usize, column: usize) {
        let along = 1 - across;
        let (first, last) = self.bins_touched(&piece.corners, along);
        let width = self.axes[0].bins;
        let bin = |row: usize| if across == 0 { row * width + column } else { column * width + row };
        if first == last {
            self.volumes[bin(first)] += piece.volume_fraction;
            return;
        }
        let distribution = Distribution::new(piece.corners.map(|c| c[along]));
        let mut below = 0.0;
        for row in first..=last {
            // Rounding must not make a volume negative.
            let next = if row == last { 1.0 } else { distribution.below((row + 1) as f64).max(below) };
            self.volumes[bin(row)] += piece.volume_fraction * (next - below);
            below = next;
        }
    }
}
