//! Grids of a file's own cells alone, to write them in another format: no tetrahedra are made, and every point and value stays as it is.
//! Of cells that several pieces hold, the owner's is left.

use super::cell_set::CellSet;
use super::cell_types::code;
use super::cell_values::gather;
use super::parts::{Cells, FileCells, OWNED, RawGrid, as_given};
use super::polyhedra::Polyhedra;
use super::source::Source;
use super::{Array, Grid};
use crate::parallel::all_or_first;
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
    let count = if are_plain(&parts) { 0 } else { parts.cells.count() };
    let check = |number: usize| source.check(&source.cell(number, &mut [0; 8])?);
    let chunks = (0..count.div_ceil(CELL_CHUNK)).into_par_iter().map(|chunk| chunk * CELL_CHUNK);
    all_or_first(chunks.map(|first| (first..count.min(first + CELL_CHUNK)).try_for_each(check)))?;
    if let Cells::Mixed(set) = &parts.cells {
        check_polyhedra(set, &source.polyhedra)?;
    }
    drop(source);
    let mut origin = std::mem::take(&mut parts.origin);
    origin.cells_ghost = drop_owned_ghosts(&mut parts);
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
            ghost: parts.ghost.map(|flags| flags.into_iter().map(as_given).collect()),
            degrees: parts.degrees,
        })),
        origin: Arc::new(origin),
        ..Grid::default()
    })
}

/// True for tetrahedra alone whose points are there, which needs no look at each cell.
fn are_plain(parts: &RawGrid) -> bool {
    let Cells::Tetrahedra(tetrahedra) = &parts.cells else { return false };
    let last =
        tetrahedra.par_chunks(CELL_CHUNK).map(|part| part.as_flattened().iter().fold(0, |a, &b| a.max(b)));
    last.max().is_none_or(|last| (last as usize) < parts.points.len())
}

/// Leaves out the ghost cells whose originals are there; gives their number.
fn drop_owned_ghosts(parts: &mut RawGrid) -> u64 {
    let Some(ghost) = &mut parts.ghost else { return 0 };
    let kept: Vec<u32> = (0..ghost.len() as u32).filter(|&cell| ghost[cell as usize] & OWNED == 0).collect();
    let count = (ghost.len() - kept.len()) as u64;
    if count == 0 {
        return 0;
    }
    *ghost = kept.iter().map(|&cell| ghost[cell as usize]).collect();
    if ghost.iter().all(|&flags| flags == 0) {
        parts.ghost = None;
    }
    match &mut parts.cells {
        Cells::Tetrahedra(own) => *own = kept.iter().map(|&cell| own[cell as usize]).collect(),
        Cells::Mixed(set) => *set = set.subset(&kept, |point| point),
        // Pieces of structured grids have become sets.
        Cells::Structured(_) => {}
    }
    if let Some(degrees) = &mut parts.degrees {
        *degrees = kept.iter().map(|&cell| degrees[cell as usize]).collect();
    }
    for Array { component_count, values } in parts.kept_cell_arrays.values_mut() {
        *values = gather(values, *component_count, &kept).into();
    }
    count
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

fn counts(cells: &Cells) -> BTreeMap<u8, u64> {
    let mut by_type = [0_u64; 256];
    match cells {
        Cells::Mixed(set) => set.types.iter().for_each(|&code| by_type[usize::from(code)] += 1),
        Cells::Tetrahedra(own) => by_type[usize::from(code::TETRA)] = own.len() as u64,
        Cells::Structured(_) => by_type[usize::from(code::VOXEL)] = cells.count() as u64,
    }
    (0..=255).zip(by_type).filter(|&(_, count)| count > 0).collect()
}
