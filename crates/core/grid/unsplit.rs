//! Grids of a file's own cells alone, to write them in another format: no tetrahedra are made, and every point and value stays as it is.

use super::cell_types::code;
use super::parts::{CellSet, Cells, FileCells, RawGrid};
use super::polyhedra::Polyhedra;
use super::source::Source;
use super::{Array, Grid};
use crate::{Error, Result};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Cells that one task looks at.
const CELL_CHUNK: usize = 8192;

/// The grid of parts without a scalar and without cell arrays that become point arrays; their lengths have been checked.
///
/// Errors: a damaged cell.
pub(super) fn unsplit(mut parts: RawGrid) -> Result<Grid> {
    let source = Source {
        cells: &parts.cells,
        point_count: parts.points.len(),
        ghost: None,
        point_not_finite: None,
        cell_not_finite: None,
        degrees: None,
        curved: Default::default(),
        polyhedra: match &parts.cells {
            Cells::Mixed(set) => Polyhedra::index(set, parts.points.len())?,
            _ => Polyhedra::default(),
        },
    };
    let count = parts.cells.count();
    (0..count).into_par_iter().with_min_len(CELL_CHUNK).try_for_each(|number| {
        let mut buffer = [0; 8];
        source.check(&source.cell(number, &mut buffer)?)
    })?;
    if let Cells::Mixed(set) = &parts.cells {
        check_polyhedra(set, &source.polyhedra)?;
    }
    let mut origin = std::mem::take(&mut parts.origin);
    origin.cells_by_type = counts(&parts.cells);
    let shared = |arrays: BTreeMap<String, Array>| {
        arrays.into_iter().map(|(name, array)| (name, Arc::new(array))).collect()
    };
    Ok(Grid {
        points: parts.points.clone(),
        point_arrays: shared(parts.point_arrays),
        cell_arrays: shared(parts.kept_cell_arrays),
        file_cells: Some(Arc::new(FileCells {
            cells: parts.cells,
            points: parts.points,
            numbers: None,
            joined_points: parts.joined_points,
            ghost: parts.ghost.map(|flags| flags.into_iter().map(super::parts::as_given).collect()),
            degrees: parts.degrees,
        })),
        origin: Arc::new(origin),
        ..Grid::default()
    })
}

/// Refuses polyhedra without faces, and faces of cells that are none.
fn check_polyhedra(set: &CellSet, polyhedra: &Polyhedra) -> Result<()> {
    let is_polyhedron = |cell: usize| set.types.get(cell) == Some(&code::POLYHEDRON);
    if let Some(wrong) = set.polyhedra.iter().find(|polyhedron| !is_polyhedron(polyhedron.cell as usize)) {
        let error = Error::run("there are faces of a cell that is no polyhedron").got(wrong.cell);
        return Err(error.expected("the number of a polyhedron"));
    }
    let cells = 0..set.types.len();
    match cells.into_iter().find(|&cell| is_polyhedron(cell) && polyhedra.polyhedron(set, cell).is_none()) {
        Some(cell) => Err(Error::run(format!("cell {cell}, a polyhedron, has no faces"))
            .expected("the faces of every polyhedron")),
        None => Ok(()),
    }
}

/// Counts of the cells by type.
fn counts(cells: &Cells) -> BTreeMap<u8, u64> {
    let mut by_type = [0_u64; 256];
    match cells {
        Cells::Mixed(set) => set.types.iter().for_each(|&code| by_type[usize::from(code)] += 1),
        Cells::Tetrahedra(own) => by_type[usize::from(code::TETRA)] = own.len() as u64,
        Cells::Structured(_) => by_type[usize::from(code::VOXEL)] = cells.count() as u64,
    }
    (0..=255).zip(by_type).filter(|&(_, count)| count > 0).collect()
}
