//! Pieces put together into one grid: points side by side, point numbers shifted.

use super::piece::Piece;
use glam::DVec3;
use rayon::prelude::*;
use voltet_core::grid::{CellSet, Cells, code};
use voltet_core::{Error, Result};

/// Requested contents of one piece.
pub(super) struct Loaded {
    pub points: Vec<DVec3>,
    pub cells: Cells,
    pub ghost: Option<Vec<bool>>,
    pub degrees: Option<Vec<[u8; 3]>>,
    /// One entry a choice.
    pub columns: Vec<Vec<f64>>,
}

/// Puts pieces together; a single one is handed through.
pub(super) fn merge(mut pieces: Vec<Loaded>, from: &[&Piece]) -> Result<Loaded> {
    if pieces.len() == 1 {
        return Ok(pieces.remove(0));
    }
    let all_tetrahedra = pieces.iter().all(|piece| matches!(piece.cells, Cells::Tetrahedra(_)));
    let has_ghost = pieces.iter().any(|piece| piece.ghost.is_some());
    let has_degrees = pieces.iter().any(|piece| piece.degrees.is_some());
    let mut points = Vec::new();
    let mut tetrahedra = Vec::new();
    let mut set = CellSet { offsets: vec![0], ..CellSet::default() };
    let mut ghost = has_ghost.then(Vec::new);
    let mut degrees = has_degrees.then(Vec::new);
    let mut columns: Vec<Vec<f64>> = Vec::new();
    for (mut piece, from) in pieces.into_iter().zip(from) {
        let shift = u32::try_from(points.len())
            .ok()
            .filter(|shift| u64::from(*shift) + from.point_count <= u64::from(u32::MAX))
            .ok_or_else(|| {
                Error::run("the grid has too many points")
                    .expected(format_args!("at most {} in all", u32::MAX))
            })?;
        let cell_count = piece.cells.count();
        check_numbers(&piece.cells, piece.points.len())?;
        match piece.cells {
            Cells::Tetrahedra(own) if all_tetrahedra => {
                tetrahedra
                    .par_extend(own.into_par_iter().map(|corners: [u32; 4]| corners.map(|c| c + shift)));
            }
            cells => append(&mut set, into_set(cells), shift),
        }
        points.append(&mut piece.points);
        if let Some(ghost) = &mut ghost {
            ghost.extend(piece.ghost.unwrap_or_else(|| vec![false; cell_count]));
        }
        if let Some(degrees) = &mut degrees {
            degrees.extend(piece.degrees.unwrap_or_else(|| vec![[0; 3]; cell_count]));
        }
        columns.resize_with(piece.columns.len(), Vec::new);
        for (all, own) in columns.iter_mut().zip(&mut piece.columns) {
            all.append(own);
        }
    }
    let cells = if all_tetrahedra { Cells::Tetrahedra(tetrahedra) } else { Cells::Mixed(set) };
    Ok(Loaded { points, cells, ghost, degrees, columns })
}

/// That cells name points of their own piece, before the numbers are shifted into another one's.
fn check_numbers(cells: &Cells, point_count: usize) -> Result<()> {
    let wrong = |&&corner: &&u32| corner as usize >= point_count;
    let found = match cells {
        Cells::Tetrahedra(tetrahedra) => tetrahedra.as_flattened().iter().find(wrong),
        Cells::Mixed(set) => {
            let faces = set.polyhedra.iter().flat_map(|polyhedron| polyhedron.faces.iter().flatten());
            set.connectivity.iter().chain(faces).find(wrong)
        }
        Cells::Structured(_) => None,
    };
    match found {
        None => Ok(()),
        Some(corner) => Err(Error::run("a cell names a point that its piece does not hold")
            .got(corner)
            .expected(format_args!("a point number below {point_count}"))),
    }
}

fn append(to: &mut CellSet, own: CellSet, shift: u32) {
    let (first_cell, begin) = (to.types.len() as u32, to.connectivity.len() as u64);
    to.types.extend(own.types);
    to.offsets.extend(own.offsets[1..].iter().map(|offset| offset + begin));
    to.connectivity.extend(own.connectivity.iter().map(|corner| corner + shift));
    for mut polyhedron in own.polyhedra {
        polyhedron.cell += first_cell;
        polyhedron.faces.iter_mut().flatten().for_each(|corner| *corner += shift);
        to.polyhedra.push(polyhedron);
    }
}

/// Any cells as a set.
fn into_set(cells: Cells) -> CellSet {
    match cells {
        Cells::Mixed(set) => set,
        Cells::Tetrahedra(tetrahedra) => CellSet {
            types: vec![code::TETRA; tetrahedra.len()],
            offsets: (0..=tetrahedra.len() as u64).map(|number| 4 * number).collect(),
            connectivity: tetrahedra.into_flattened(),
            polyhedra: Vec::new(),
        },
        Cells::Structured(dimensions) => {
            let count = Cells::Structured(dimensions).count();
            CellSet {
                types: vec![code::VOXEL; count],
                offsets: (0..=count as u64).map(|number| 8 * number).collect(),
                connectivity: (0..count)
                    .flat_map(|number| structured_corners(dimensions, number))
                    .map(|corner| corner as u32)
                    .collect(),
                polyhedra: Vec::new(),
            }
        }
    }
}

/// The points of a cell of a structured grid, in a voxel's order.
pub(super) fn structured_corners([nx, ny, _]: [usize; 3], number: usize) -> [usize; 8] {
    let (i, rest) = (number % (nx - 1), number / (nx - 1));
    let (j, k) = (rest % (ny - 1), rest / (ny - 1));
    std::array::from_fn(|corner| {
        (i + (corner & 1)) + nx * ((j + (corner >> 1 & 1)) + ny * (k + (corner >> 2)))
    })
}
