//! Points whose gradient is needed: corners of cells that a widget may meet by their values of s, whatever g is there.

use rayon::prelude::*;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use voltet_core::Result;
use voltet_core::grid::{Grid, extent};
use voltet_cpu::NEGLIGIBLE_DEPTH;
use voltet_graph::TransferFunctionSpec;

/// Smallest grid for which a selection pays: all gradients of smaller ones take less than a millisecond or two.
const MIN_CELLS: usize = 1 << 15;

/// One cell of so many tells: a prime, so that rows of 2ⁿ cells are met at all their places.
const SAMPLED: usize = 61;

/// Share of those cells that may be touched at most: a cell has points that others have too.
const MAX_TOUCHED: f64 = 0.6;

/// Cells of a chunk of work.
const CHUNK: usize = 1 << 13;

/// The points, ascending; `None` where looking for them does not pay: of small grids, and where a sample of cells says that they are
/// most.
///
/// Errors: an extent beyond 64-bit floats.
pub fn points(grid: &Grid, s: &[f64], looks: &[Arc<TransferFunctionSpec>]) -> Result<Option<Vec<u32>>> {
    if grid.tetrahedra.len() < MIN_CELLS {
        return Ok(None);
    }
    let length = extent::scene_length(extent::bounds(&grid.points))?;
    let of =
        |look: &Arc<TransferFunctionSpec>| look.for_diagonal(length).intervals_of_s(length, NEGLIGIBLE_DEPTH);
    let intervals: Vec<[f64; 2]> = looks.iter().flat_map(of).collect();
    let is_touched = |corners: &[u32; 4]| {
        let values = corners.map(|p| s[p as usize]);
        let low = values.into_iter().fold(f64::INFINITY, f64::min);
        let high = values.into_iter().fold(f64::NEG_INFINITY, f64::max);
        intervals.iter().any(|interval| interval[0] <= high && low <= interval[1])
    };
    let sample = grid.tetrahedra.par_iter().step_by(SAMPLED).with_min_len(CHUNK);
    let (asked, touched) = (sample.len(), sample.filter(|corners| is_touched(corners)).count());
    if MAX_TOUCHED * (asked as f64) < touched as f64 {
        return Ok(None);
    }
    let wanted: Vec<AtomicBool> = grid.points.iter().map(|_| AtomicBool::new(false)).collect();
    grid.tetrahedra.par_iter().with_min_len(CHUNK).filter(|corners| is_touched(corners)).for_each(
        |corners| {
            for &p in corners {
                wanted[p as usize].store(true, Ordering::Relaxed);
            }
        },
    );
    let number = |(p, wanted): (usize, AtomicBool)| wanted.into_inner().then_some(p as u32);
    Ok(Some(wanted.into_iter().enumerate().filter_map(number).collect()))
}
