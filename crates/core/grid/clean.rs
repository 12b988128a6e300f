//! Removal of unused points, and flags of values that are not finite.

use super::Array;
use super::file_cells::UNUSED;
use super::parts::{Association, RawGrid};
use crate::SharedSlice;
use crate::{Error, Result};
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};

/// Values that one task looks at.
const CHUNK: usize = 1 << 15;

/// Marks the points whose position, scalar or further value is not finite; `None` where all are finite.
pub(super) fn points_not_finite(parts: &RawGrid) -> Option<Vec<bool>> {
    let mut marks = LazyBitSet::new(parts.points.len());
    if !parts.points.par_iter().with_min_len(CHUNK).all(|p| p.is_finite()) {
        marks.mark(|i| !parts.points[i].is_finite());
    }
    if let Some(scalar) = &parts.scalar
        && scalar.association == Association::Point
    {
        marks.mark_values(&scalar.values, 1);
    }
    for array in parts.point_arrays.values() {
        marks.mark_values(&array.values, array.component_count);
    }
    marks.marks
}

/// Marks the cells whose scalar or further value is not finite; `None` where all are finite.
pub(super) fn cells_not_finite(parts: &RawGrid) -> Option<Vec<bool>> {
    let mut marks = LazyBitSet::new(parts.cells.count());
    if let Some(scalar) = &parts.scalar
        && scalar.association == Association::Cell
    {
        marks.mark_values(&scalar.values, 1);
    }
    for array in parts.cell_arrays.values() {
        marks.mark_values(&array.values, array.component_count);
    }
    marks.marks
}

/// Marks that are only allocated once there is something to mark.
struct LazyBitSet {
    count: usize,
    marks: Option<Vec<bool>>,
}

impl LazyBitSet {
    fn new(count: usize) -> Self {
        LazyBitSet { count, marks: None }
    }

    fn mark(&mut self, not_finite: impl Fn(usize) -> bool + Sync) {
        let marks = self.marks.get_or_insert_with(|| vec![false; self.count]);
        marks.par_iter_mut().with_min_len(CHUNK).enumerate().for_each(|(i, mark)| *mark |= not_finite(i));
    }

    fn mark_values(&mut self, values: &[f64], component_count: usize) {
        if !values.par_iter().with_min_len(CHUNK).all(|v| v.is_finite()) {
            let n = component_count.max(1);
            self.mark(|i| !values[i * n..(i + 1) * n].iter().all(|v| v.is_finite()));
        }
    }
}

/// Drops the points that no tetrahedron uses, with their values; keeps the order of the others, so that ascending
/// point numbers stay ascending. Gives each point's new number, [`UNUSED`] for those that are dropped; `None` where all stay.
pub(super) fn drop_unused_points(
    parts: &mut RawGrid,
    tetrahedra: &mut [[u32; 4]],
) -> Result<Option<Vec<u32>>> {
    let point_count = parts.points.len();
    let used: Vec<AtomicBool> = (0..point_count).map(|_| AtomicBool::new(false)).collect();
    tetrahedra.par_iter().with_min_len(CHUNK).for_each(|t| {
        for &p in t {
            // Looking first keeps cache lines shared between cores that meet at the same points.
            if !used[p as usize].load(Ordering::Relaxed) {
                used[p as usize].store(true, Ordering::Relaxed);
            }
        }
    });
    let used: Vec<bool> = used.into_iter().map(AtomicBool::into_inner).collect();
    let used_count = used.iter().filter(|&&u| u).count();
    if used_count == point_count {
        return Ok(None);
    }
    let mut new_number = vec![0_u32; point_count];
    let mut next = 0_u32;
    for (slot, &used) in new_number.iter_mut().zip(&used) {
        *slot = if used { next } else { UNUSED };
        next += u32::from(used);
    }
    tetrahedra
        .par_iter_mut()
        .with_min_len(CHUNK)
        .for_each(|t| t.iter_mut().for_each(|p| *p = new_number[*p as usize]));
    keep(&mut parts.points, 1, &used);
    if let Some(scalar) = &mut parts.scalar {
        if scalar.association != Association::Point || scalar.values.len() != point_count {
            return Err(Error::run("a scalar does not sit on the points").at_item(&scalar.name));
        }
        keep(&mut scalar.values, 1, &used);
    }
    for Array { component_count, values } in parts.point_arrays.values_mut() {
        keep(values, *component_count, &used);
    }
    Ok(Some(new_number))
}

/// Keeps the tuples that are used, in place.
fn keep<T: Copy>(values: &mut SharedSlice<T>, component_count: usize, used: &[bool]) {
    let values = values.make_mut();
    let n = component_count.max(1);
    let mut at = 0;
    for (i, _) in used.iter().enumerate().filter(|&(_, &used)| used) {
        values.copy_within(i * n..(i + 1) * n, at);
        at += n;
    }
    values.truncate(at);
    values.shrink_to_fit();
}
