//! What was written, judged: all that was to be written is there, and cells are cells.

use super::buffers::{Buffers, Fresh, Mixed};
use super::head::Head;
use crate::outcome::Whose;
use rayon::prelude::*;
use voltet_core::glam::DVec3;
use voltet_core::grid::{CellSet, CellType, Cells, code};
use voltet_core::{Error, Result};

/// A grid, or the parts of it that were asked for.
pub(crate) struct Made {
    pub points: Option<Vec<DVec3>>,
    pub cells: Option<Cells>,
    /// One an array of the head.
    pub arrays: Vec<Option<Vec<f64>>>,
}

impl Buffers {
    /// Errors: something was left out; a cell that is none. `point_count`: of the points that cells may name.
    pub fn judged(self, head: &Head, point_count: usize, whose: Whose) -> Result<Made> {
        if let Some(points) = &self.points {
            whole::<f64>(bytemuck::cast_slice(points), 3, "the positions of points", whose)?;
        }
        let cells = match (self.tetrahedra, self.cells) {
            (Some(tetrahedra), _) => {
                whole::<u32>(tetrahedra.as_flattened(), 4, "the tetrahedra", whose)?;
                within(tetrahedra.as_flattened(), point_count, "tetrahedra", whose)?;
                Some(Cells::Tetrahedra(tetrahedra))
            }
            (None, Some(mixed)) => Some(Cells::Mixed(judged_cells(mixed, point_count, whose)?)),
            (None, None) => None,
        };
        for (own, array) in self.arrays.iter().zip(&head.arrays) {
            if let Some(own) = own {
                whole(own, array.component_count, &format!("the array '{}'", array.name), whose)?;
            }
        }
        Ok(Made { points: self.points, cells, arrays: self.arrays })
    }
}

/// Errors: a number that was not written.
fn whole<T: Fresh>(numbers: &[T], each: usize, what: &str, whose: Whose) -> Result<()> {
    let Some(first) = numbers.par_iter().with_min_len(1 << 14).position_first(T::is_unset) else {
        return Ok(());
    };
    let missing = numbers.par_iter().with_min_len(1 << 14).filter(|number| number.is_unset()).count();
    let found = format!("{missing} of {} numbers unset, the first of tuple {}", numbers.len(), first / each);
    Err(whose.error(&format!("did not write all of {what}")).got(found).expected("every number"))
}

/// Errors: a number of no point.
fn within(numbers: &[u32], point_count: usize, what: &str, whose: Whose) -> Result<()> {
    let wrong = |&number: &u32| number as usize >= point_count;
    match numbers.par_iter().with_min_len(1 << 14).position_first(wrong) {
        None => Ok(()),
        Some(at) => Err(out_of_range(whose, &format!("{what}[{at}]"), numbers[at])
            .expected(format!("a point number below {point_count}"))),
    }
}

fn out_of_range(whose: Whose, what: &str, found: impl std::fmt::Display) -> Error {
    whose.error(&format!("gave a number that is out of range: {what}")).got(found)
}

fn judged_cells(mixed: Mixed, point_count: usize, whose: Whose) -> Result<CellSet> {
    let Mixed { types, offsets, connectivity } = mixed;
    whole(&types, 1, "the types", whose)?;
    whole(&offsets, 1, "the offsets", whose)?;
    whole(&connectivity, 1, "the connectivity", whose)?;
    let wrong = |&cell: &u8| cell == code::POLYHEDRON || CellType::from_code(cell).is_none();
    if let Some(at) = types.par_iter().with_min_len(1 << 14).position_first(wrong) {
        let error = out_of_range(whose, &format!("types[{at}]"), types[at]);
        return Err(error.expected("a code of VTK's cells, polyhedra (42) excepted"));
    }
    let accepted = |at: usize| match at {
        0 => (offsets[0] != 0).then(|| "0".to_string()),
        at if offsets[at] < offsets[at - 1] => Some(format!("at least {}, the one before", offsets[at - 1])),
        at if at + 1 == offsets.len() && offsets[at] != connectivity.len() as i64 => {
            Some(format!("{}, the count of the connectivity", connectivity.len()))
        }
        _ => None,
    };
    if let Some((at, accepted)) = (0..offsets.len()).find_map(|at| Some((at, accepted(at)?))) {
        return Err(out_of_range(whose, &format!("offsets[{at}]"), offsets[at]).expected(accepted));
    }
    let wrong = |at: &usize| {
        let wanted = CellType::from_code(types[*at]).and_then(|cell| cell.point_count);
        wanted.is_some_and(|wanted| offsets[at + 1] - offsets[*at] != i64::from(wanted))
    };
    if let Some(at) = (0..types.len()).into_par_iter().with_min_len(1 << 14).find_first(wrong) {
        let wanted = CellType::from_code(types[at]).and_then(|cell| Some((cell.name, cell.point_count?)));
        let (name, wanted) = wanted.unwrap_or_default();
        let error = whose.error(&format!("gave cell {at}, a {name}, another number of points than it has"));
        return Err(error.got(offsets[at + 1] - offsets[at]).expected(wanted));
    }
    within(&connectivity, point_count, "connectivity_u32", whose)?;
    let offsets = offsets.into_iter().map(|offset| offset as u64).collect();
    Ok(CellSet { types, offsets, connectivity, polyhedra: Vec::new() })
}
