//! Edges of a grid's cells on its boundary, as the file has the cells: without the diagonals of faces that were split.

use super::Grid;
use super::boundary::outer_faces;
use super::cell_set::{CellSet, Polyhedron};
use super::cell_types::{CellType, code};
use super::parts::{Cells, FileCells, structured_corners};
use super::split;
use crate::Result;
use crate::progress::Progress;
use rayon::prelude::*;
use std::collections::HashMap;

/// Edges of cells on the boundary.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct BoundaryEdges {
    /// Points of the grid, ascending; of points at one place the first.
    pub edges: Vec<[u32; 2]>,
    /// True if some cells are not known as the file has them, so that all edges of the triangles of their faces are among these.
    pub has_diagonals: bool,
}

/// Edges of the faces of cells that no other cell shares, each once. Cells other than tetrahedra are known where the grid keeps
/// those of its file; of curved cells all edges of the pieces that they are drawn as are taken.
///
/// # Errors
/// - memory ends.
pub fn boundary_edges(grid: &Grid, progress: &dyn Progress) -> Result<BoundaryEdges> {
    let (faces, places) = outer_faces(grid, progress)?;
    let cells = SplitCells::new(grid);
    let of_face = |(corners, tetrahedron): &([u32; 3], u32)| {
        let [a, b, c] = *corners;
        let cell = grid.source_cell(*tetrahedron as usize);
        [[a, b], [b, c], [c, a]].map(|edge| {
            let [a, b] = edge.map(|p| places.first(p));
            (cells.has_edge(cell, edge), [a.min(b), a.max(b)])
        })
    };
    let found: Vec<(Option<bool>, [u32; 2])> = faces.par_iter().flat_map_iter(of_face).collect();
    let has_diagonals = found.iter().any(|(is_edge, _)| is_edge.is_none());
    let mut edges: Vec<[u32; 2]> =
        found.into_iter().filter(|(is_edge, _)| *is_edge != Some(false)).map(|(_, edge)| edge).collect();
    edges.par_sort_unstable();
    edges.dedup();
    Ok(BoundaryEdges { edges, has_diagonals })
}

/// Cells of a file that tetrahedra are parts of.
enum SplitCells<'a> {
    /// Each is a tetrahedron.
    Tetrahedra,
    /// The grid does not keep them.
    Unknown,
    /// Cells of the file, and its polyhedra by their cells.
    File(&'a FileCells, HashMap<u32, &'a Polyhedron>),
}

impl<'a> SplitCells<'a> {
    fn new(grid: &'a Grid) -> SplitCells<'a> {
        let is_plain = |code: &u8| {
            *code == code::TETRA
                || CellType::from_code(*code).is_some_and(|cell_type| cell_type.dimension < 3)
        };
        match &grid.file_cells {
            _ if grid.source_cells.is_none() => SplitCells::Tetrahedra,
            Some(file) => {
                let polyhedra = if let Cells::Mixed(set) = &file.cells { &*set.polyhedra } else { &[] };
                SplitCells::File(
                    file,
                    polyhedra.iter().map(|polyhedron| (polyhedron.cell, polyhedron)).collect(),
                )
            }
            None if grid.origin.cells_by_type.keys().all(is_plain) => SplitCells::Tetrahedra,
            None => SplitCells::Unknown,
        }
    }

    /// True if two points of the grid are the ends of an edge of a cell; none where that is not known.
    fn has_edge(&self, cell: usize, ends: [u32; 2]) -> Option<bool> {
        let (file, polyhedra) = match self {
            SplitCells::Tetrahedra => return Some(true),
            SplitCells::Unknown => return None,
            SplitCells::File(file, polyhedra) => (file, polyhedra),
        };
        let is_end = |corner: u32, end: u32| file.grid_point(corner as usize) == Some(end as usize);
        let is_edge = |[a, b]: [u32; 2]| {
            is_end(a, ends[0]) && is_end(b, ends[1]) || is_end(a, ends[1]) && is_end(b, ends[0])
        };
        let is_side =
            |face: &[u32]| face.iter().zip(face.iter().cycle().skip(1)).any(|(&a, &b)| is_edge([a, b]));
        match &file.cells {
            Cells::Tetrahedra(_) => Some(true),
            Cells::Structured(points) => Some(voxel_edges(structured_corners(*points, cell)).any(is_edge)),
            Cells::Mixed(set) => {
                let (code, corners) = corners(set, cell)?;
                match code {
                    code::TETRA => Some(true),
                    code::VOXEL => Some(voxel_edges(corners.try_into().ok()?).any(is_edge)),
                    code::HEXAHEDRON => Some(voxel_edges(split::voxel_order(corners)).any(is_edge)),
                    code::POLYHEDRON => {
                        Some(polyhedra.get(&(cell as u32))?.faces.iter().any(|face| is_side(face)))
                    }
                    _ => {
                        let face = |face: &[usize]| face.iter().map(|&k| corners[k]).collect::<Vec<u32>>();
                        Some(faces(code)?.iter().any(|of_type| is_side(&face(of_type))))
                    }
                }
            }
        }
    }
}

/// Type and points of a cell that a grid was built from.
fn corners(set: &CellSet, cell: usize) -> Option<(u8, &[u32])> {
    let [start, end] = [set.offsets.get(cell)?, set.offsets.get(cell + 1)?].map(|&at| at as usize);
    Some((*set.types.get(cell)?, set.connectivity.get(start..end)?))
}

/// Faces of linear cells that no other rule tells.
fn faces(code: u8) -> Option<&'static [&'static [usize]]> {
    match code {
        code::WEDGE => Some(split::WEDGE_FACES),
        code::PYRAMID => Some(split::PYRAMID_FACES),
        code::PENTAGONAL_PRISM => Some(split::PENTAGONAL_PRISM_FACES),
        code::HEXAGONAL_PRISM => Some(split::HEXAGONAL_PRISM_FACES),
        _ => None,
    }
}

/// The twelve edges of a voxel: corners whose numbers differ in one bit.
fn voxel_edges(corners: [u32; 8]) -> impl Iterator<Item = [u32; 2]> {
    (0..8).flat_map(move |corner| {
        let others = [1, 2, 4].map(|bit| corner | bit);
        others
            .into_iter()
            .filter(move |&other| other != corner)
            .map(move |other| [corners[corner], corners[other]])
    })
}
