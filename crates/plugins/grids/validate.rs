//! Checks of a grid that a plug-in wrote: every number is there, and cells are valid.

use super::buffers::{Buffers, MixedCells};
use super::head::Head;
use crate::sentinel::Sentinel;
use crate::status::CallLabel;
use rayon::prelude::*;
use voltet_core::glam::DVec3;
use voltet_core::grid::{CellSet, CellType, Cells, code};
use voltet_core::{Error, Result};

/// Numbers in a unit of parallel work.
const CHUNK: usize = 1 << 14;

/// A grid, or the requested parts of it.
pub(crate) struct GridContents {
    pub points: Option<Vec<DVec3>>,
    pub cells: Option<Cells>,
    /// One for each array of the head.
    pub arrays: Vec<Option<Vec<f64>>>,
}

impl Buffers {
    /// The contents of the buffers. `point_count`: points that cells may name.
    ///
    /// Errors: a number that was not written; an invalid cell.
    pub fn validate(self, head: &Head, point_count: usize, label: CallLabel) -> Result<GridContents> {
        if let Some(points) = &self.points {
            refuse_unset::<f64>(bytemuck::cast_slice(points), 3, "the positions of points", label)?;
        }
        let cells = match (self.tetrahedra, self.cells) {
            (Some(tetrahedra), _) => {
                refuse_unset::<u32>(tetrahedra.as_flattened(), 4, "the tetrahedra", label)?;
                refuse_out_of_range(tetrahedra.as_flattened(), point_count, "tetrahedra", label)?;
                Some(Cells::Tetrahedra(tetrahedra))
            }
            (None, Some(mixed)) => Some(Cells::Mixed(validate_cells(mixed, point_count, label)?)),
            (None, None) => None,
        };
        for (buffer, array) in self.arrays.iter().zip(&head.arrays) {
            if let Some(buffer) = buffer {
                let name = format!("the array '{}'", array.name);
                refuse_unset(buffer, array.component_count, &name, label)?;
            }
        }
        Ok(GridContents { points: self.points, cells, arrays: self.arrays })
    }
}

/// Errors: a number that was not written.
fn refuse_unset<T: Sentinel>(numbers: &[T], components: usize, what: &str, label: CallLabel) -> Result<()> {
    let Some(first) = numbers.par_iter().with_min_len(CHUNK).position_first(T::is_unset) else {
        return Ok(());
    };
    let missing = numbers.par_iter().with_min_len(CHUNK).filter(|number| number.is_unset()).count();
    let tuple = first / components;
    let found = format!("{missing} of {} numbers unset, the first of tuple {tuple}", numbers.len());
    Err(label.error(&format!("did not write all of {what}")).got(found).expected("every number"))
}

/// Errors: a point number that is too large.
fn refuse_out_of_range(numbers: &[u32], point_count: usize, what: &str, label: CallLabel) -> Result<()> {
    let is_wrong = |&number: &u32| number as usize >= point_count;
    match numbers.par_iter().with_min_len(CHUNK).position_first(is_wrong) {
        None => Ok(()),
        Some(i) => Err(out_of_range(label, &format!("{what}[{i}]"), numbers[i])
            .expected(format!("a point number below {point_count}"))),
    }
}

fn out_of_range(label: CallLabel, what: &str, found: impl std::fmt::Display) -> Error {
    label.error(&format!("gave a number that is out of range: {what}")).got(found)
}

fn validate_cells(mixed: MixedCells, point_count: usize, label: CallLabel) -> Result<CellSet> {
    let MixedCells { types, offsets, connectivity } = mixed;
    refuse_unset(&types, 1, "the types", label)?;
    refuse_unset(&offsets, 1, "the offsets", label)?;
    refuse_unset(&connectivity, 1, "the connectivity", label)?;
    let is_wrong = |&cell: &u8| cell == code::POLYHEDRON || CellType::from_code(cell).is_none();
    if let Some(i) = types.par_iter().with_min_len(CHUNK).position_first(is_wrong) {
        let error = out_of_range(label, &format!("types[{i}]"), types[i]);
        return Err(error.expected("a code of VTK's cells, polyhedra (42) excepted"));
    }
    let correction = |i: usize| match i {
        0 => (offsets[0] != 0).then(|| "0".to_string()),
        i if offsets[i] < offsets[i - 1] => Some(format!("at least {}, the one before", offsets[i - 1])),
        i if i + 1 == offsets.len() && offsets[i] != connectivity.len() as i64 => {
            Some(format!("{}, the count of the connectivity", connectivity.len()))
        }
        _ => None,
    };
    if let Some((i, expected)) = (0..offsets.len()).find_map(|i| Some((i, correction(i)?))) {
        return Err(out_of_range(label, &format!("offsets[{i}]"), offsets[i]).expected(expected));
    }
    let is_wrong = |i: &usize| {
        let expected = CellType::from_code(types[*i]).and_then(|cell| cell.point_count);
        expected.is_some_and(|expected| offsets[i + 1] - offsets[*i] != i64::from(expected))
    };
    if let Some(i) = (0..types.len()).into_par_iter().with_min_len(CHUNK).find_first(is_wrong) {
        let cell = CellType::from_code(types[i]).and_then(|cell| Some((cell.name, cell.point_count?)));
        let (name, expected) = cell.unwrap_or_default();
        let error = label.error(&format!("gave cell {i}, a {name}, another number of points than it has"));
        return Err(error.got(offsets[i + 1] - offsets[i]).expected(expected));
    }
    refuse_out_of_range(&connectivity, point_count, "connectivity_u32", label)?;
    let offsets = offsets.into_iter().map(|offset| offset as u64).collect();
    Ok(CellSet { types, offsets, connectivity, polyhedra: Vec::new() })
}
