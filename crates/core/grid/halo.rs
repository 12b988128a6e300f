//! Cells of a piece near the points that other pieces hold, and the grid of some pieces with such cells of the others around it.
//!
//! Two cells are neighbours where they share a point; a hanging point of an adaptive grid brings in the corners that it depends on.
//! A way from a piece into another one goes through a shared point, so cells within some layers of a part of the grid lie within as
//! many layers of shared points of their own piece.

use super::cell_set::Polyhedron;
use super::cell_types::CellType;
use super::curved::is_curved;
use super::parts::{
    Array, Association, BoundaryValues, Cells, HangingPoint, RawGrid, Scalar, corners, is_left_out,
};
use super::pieces::{JoinedPiece, join_pieces, prepare};
use super::shared_points::{PointHolder, SharedPoint, SharedPoints};
use crate::{Result, SharedSlice};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, HashMap};

/// Cells that one task looks at.
const CHUNK: usize = 1 << 13;

/// Cells of a piece within some layers of its shared points, with their points and values, and further points whose values count for
/// other pieces.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Halo {
    grid: RawGrid,
    /// Numbers of the points in the piece, ascending.
    points: Vec<u32>,
    layers: usize,
}

impl Halo {
    /// The cells of piece `index` within `layers` layers of its shared points; `None` where there is nothing. A piece with curved cells
    /// has a layer more: the cells around a curved one decide how the points are numbered that it adds on its surface. Cells of a
    /// structured grid are brought into a set.
    ///
    /// # Errors
    /// As [`super::join`] of the piece.
    pub fn from_piece(
        piece: &mut RawGrid,
        shared: &SharedPoints,
        index: usize,
        layers: usize,
    ) -> Result<Option<Halo>> {
        if shared.of_piece(index).is_empty() {
            return Ok(None);
        }
        prepare(piece, index)?;
        let piece = &*piece;
        let has_curved =
            matches!(&piece.cells, Cells::Mixed(set) if set.types.iter().any(|&code| is_curved(code)));
        let mut own = CellLayers::new(piece);
        shared.of_piece(index).iter().for_each(|shared| own.reach(shared.point));
        let layers = layers + usize::from(has_curved);
        for _ in 0..layers {
            own.grow();
        }
        let cells = own.taken_cells();
        let mut is_kept = own.points_of(&cells);
        drop(own);
        // Of points with ids the values of one piece count; others have equal values.
        if piece.global_ids.is_some() {
            let sources = shared.of_piece(index).iter().filter(|shared| shared.is_source);
            sources.for_each(|shared| is_kept[shared.point as usize] = true);
        }
        let points = numbers_of(&is_kept);
        let grid = subset(piece, &cells, &points);
        Ok((!points.is_empty()).then_some(Halo { grid, points, layers }))
    }

    /// Memory that it takes.
    pub fn byte_count(&self) -> u64 {
        let RawGrid { points, cells, ghost, global_ids, scalar, degrees, hanging, .. } = &self.grid;
        let cells = match cells {
            Cells::Tetrahedra(own) => size_of_val(&own[..]),
            Cells::Mixed(set) => {
                let faces = set.polyhedra.iter().flat_map(|own| &own.faces);
                size_of_val(&set.types[..])
                    + size_of_val(&set.offsets[..])
                    + size_of_val(&set.connectivity[..])
                    + faces.map(|face| size_of_val(&face[..]) + size_of::<Vec<u32>>()).sum::<usize>()
            }
            Cells::Structured(_) => 0,
        };
        let arrays = [&self.grid.point_arrays, &self.grid.cell_arrays, &self.grid.kept_cell_arrays];
        let arrays = arrays.into_iter().flat_map(BTreeMap::values).map(|array| &array.values);
        let values: usize =
            arrays.chain(scalar.iter().map(|scalar| &scalar.values)).map(|own| size_of_val(&own[..])).sum();
        let boundary: usize = self.grid.boundary_values.values().map(BoundaryValues::byte_count).sum();
        let rest = size_of_val(&points[..])
            + size_of_val(&self.points[..])
            + ghost.as_deref().map_or(0, size_of_val)
            + global_ids.as_deref().map_or(0, size_of_val)
            + degrees.as_deref().map_or(0, size_of_val)
            + hanging.as_deref().map_or(0, size_of_val);
        (cells + values + boundary + rest) as u64
    }
}

/// Puts some pieces of a grid together, as [`super::join`] puts all, with the cells of the halos of the others within their layers as
/// ghosts. Numbers and values of points are those of the whole grid; cells of the pieces follow each other as there. `own`: pieces with
/// their numbers; `halos`: of all pieces; `first_cells`: the number in the whole grid of the first cell of each piece.
///
/// # Errors
/// As [`super::join`].
pub fn join_part(
    own: Vec<(usize, RawGrid)>,
    halos: &[Option<Halo>],
    shared: &SharedPoints,
    first_cells: &[u64],
) -> Result<RawGrid> {
    let mut is_reached = vec![false; shared.count()];
    let mut is_own = vec![false; halos.len()];
    let mut joined = Vec::new();
    for (piece, mut grid) in own {
        prepare(&mut grid, piece)?;
        shared.of_piece(piece).iter().for_each(|point| is_reached[point.rank as usize] = true);
        is_own[piece] = true;
        joined.push(JoinedPiece { piece, grid, originals: None, is_halo: false });
    }
    let others = halos.iter().enumerate().filter(|&(piece, _)| !is_own[piece]);
    let mut others: Vec<HaloLayers> = others
        .filter_map(|(piece, halo)| halo.as_ref().map(|halo| HaloLayers::new(piece, halo, shared)))
        .collect();
    for layer in 0..others.iter().map(|own| own.halo.layers).max().unwrap_or(0) {
        // Points that hang bring in others, which may be shared with further pieces.
        loop {
            others.par_iter_mut().for_each(|own| own.enter(&is_reached));
            if others.iter().map(|own| own.leave(&mut is_reached)).sum::<usize>() == 0 {
                break;
            }
        }
        let grown = others.par_iter_mut().filter(|own| own.is_entered && own.halo.layers > layer);
        grown.for_each(|own| own.layers.grow());
        others.iter().for_each(|own| _ = own.leave(&mut is_reached));
    }
    joined.par_extend(others.into_par_iter().filter_map(|own| own.part(&is_reached)));
    joined.sort_unstable_by_key(|own| own.piece);
    let mut own_cells = Vec::new();
    let mut begin = 0;
    for own in &joined {
        if !own.is_halo {
            own_cells.push([begin, first_cells[own.piece]]);
        }
        begin += own.grid.cells.count() as u64;
    }
    let mut part = join_pieces(joined, shared)?;
    part.origin.first_cells = own_cells;
    Ok(part)
}

/// Cells of a grid that are taken layer by layer.
struct CellLayers<'a> {
    grid: &'a RawGrid,
    /// Polyhedra by their cells.
    polyhedra: HashMap<u32, &'a Polyhedron>,
    /// Corners of each hanging point.
    hanging: HashMap<u32, [u32; 4]>,
    /// True at points from which the next layer goes on.
    is_reached: Vec<bool>,
    is_taken: Vec<bool>,
}

impl<'a> CellLayers<'a> {
    fn new(grid: &'a RawGrid) -> CellLayers<'a> {
        let polyhedra = match &grid.cells {
            Cells::Mixed(set) => set.polyhedra.iter().map(|own| (own.cell, own)).collect(),
            _ => HashMap::new(),
        };
        let hanging = grid.hanging.iter().flatten().map(|own| (own.point, own.corners)).collect();
        let (is_reached, is_taken) = (vec![false; grid.points.len()], vec![false; grid.cells.count()]);
        CellLayers { grid, polyhedra, hanging, is_reached, is_taken }
    }

    /// Marks a point, and those that its values depend on.
    fn reach(&mut self, point: u32) {
        let mut open = vec![point];
        while let Some(point) = open.pop() {
            if !std::mem::replace(&mut self.is_reached[point as usize], true) {
                open.extend(self.hanging.get(&point).into_iter().flatten());
            }
        }
    }

    fn points(&self, cell: usize) -> impl Iterator<Item = u32> {
        let faces = self.polyhedra.get(&(cell as u32)).map(|own| own.faces.iter().flatten());
        corners(&self.grid.cells, cell).iter().chain(faces.into_iter().flatten()).copied()
    }

    /// True if a cell serves means or gradients: it has a volume and is not left out.
    fn serves(&self, cell: usize) -> bool {
        let is_volume = match &self.grid.cells {
            Cells::Mixed(set) => CellType::from_code(set.types[cell]).is_none_or(|own| own.dimension == 3),
            _ => true,
        };
        is_volume && self.grid.ghost.as_ref().is_none_or(|flags| !is_left_out(flags[cell]))
    }

    /// Takes the cells at the points that are reached, which are reached then, too.
    fn grow(&mut self) {
        let is_next = |&cell: &usize| {
            !self.is_taken[cell]
                && self.points(cell).any(|point| self.is_reached[point as usize])
                && self.serves(cell)
        };
        let cells = (0..self.is_taken.len()).into_par_iter().with_min_len(CHUNK);
        let next: Vec<usize> = cells.filter(is_next).collect();
        let mut points: Vec<u32> = next.iter().flat_map(|&cell| self.points(cell)).collect();
        points.sort_unstable();
        points.dedup();
        next.into_iter().for_each(|cell| self.is_taken[cell] = true);
        points.into_iter().for_each(|point| self.reach(point));
    }

    fn taken_cells(&self) -> Vec<u32> {
        numbers_of(&self.is_taken)
    }

    /// True at the points of cells.
    fn points_of(&self, cells: &[u32]) -> Vec<bool> {
        let mut is_used = vec![false; self.grid.points.len()];
        let points = cells.iter().flat_map(|&cell| self.points(cell as usize));
        points.for_each(|point| is_used[point as usize] = true);
        is_used
    }
}

/// Numbers of the flags that are set.
fn numbers_of(flags: &[bool]) -> Vec<u32> {
    flags.iter().zip(0..).filter(|flag| *flag.0).map(|flag| flag.1).collect()
}

/// A halo whose cells are taken for a part of the grid.
struct HaloLayers<'a> {
    piece: usize,
    halo: &'a Halo,
    /// Its shared points, by their numbers in the halo.
    shared: Vec<SharedPoint>,
    layers: CellLayers<'a>,
    /// True once one of its points is reached.
    is_entered: bool,
}

impl<'a> HaloLayers<'a> {
    fn new(piece: usize, halo: &'a Halo, all: &SharedPoints) -> HaloLayers<'a> {
        let mut shared = Vec::new();
        let (count, originals) = (halo.points.len(), Some(&halo.points[..]));
        all.each(&PointHolder { piece, count, originals, ids: &[] }, |point, own, _| {
            shared.extend(own.map(|own| SharedPoint { point: point as u32, ..own }));
        });
        HaloLayers { piece, halo, shared, layers: CellLayers::new(&halo.grid), is_entered: false }
    }

    /// Reaches its points that others have reached.
    fn enter(&mut self, is_reached: &[bool]) {
        for shared in self.shared.iter().filter(|shared| is_reached[shared.rank as usize]) {
            self.is_entered = true;
            self.layers.reach(shared.point);
        }
    }

    /// Marks its points that are reached for the others; gives the number of those that were not yet.
    fn leave(&self, is_reached: &mut [bool]) -> usize {
        let own = self.shared.iter().filter(|shared| self.layers.is_reached[shared.point as usize]);
        own.filter(|shared| !std::mem::replace(&mut is_reached[shared.rank as usize], true)).count()
    }

    /// The cells that are taken, and the points whose values count for the part.
    fn part(self, is_reached: &[bool]) -> Option<JoinedPiece> {
        let Halo { grid, points, .. } = self.halo;
        let cells = self.layers.taken_cells();
        let mut is_kept = self.layers.points_of(&cells);
        if grid.global_ids.is_some() {
            let sources = self.shared.iter().filter(|own| own.is_source && is_reached[own.rank as usize]);
            sources.for_each(|own| is_kept[own.point as usize] = true);
        }
        let kept = numbers_of(&is_kept);
        if kept.is_empty() {
            return None;
        }
        let originals = Some(kept.iter().map(|&point| points[point as usize]).collect());
        Some(JoinedPiece { piece: self.piece, grid: subset(grid, &cells, &kept), originals, is_halo: true })
    }
}

/// Some cells of a grid, and some points: those of the cells, and maybe further ones; all ascending.
fn subset(whole: &RawGrid, cells: &[u32], points: &[u32]) -> RawGrid {
    const NONE: u32 = u32::MAX;
    let mut numbers = vec![NONE; whole.points.len()];
    points.iter().zip(0..).for_each(|(&point, number)| numbers[point as usize] = number);
    let number = |point: u32| numbers[point as usize];
    let own_cells = match &whole.cells {
        Cells::Mixed(set) => Cells::Mixed(set.subset(cells, number)),
        own => {
            let corners = |&cell: &u32| std::array::from_fn(|i| number(corners(own, cell as usize)[i]));
            Cells::Tetrahedra(cells.iter().map(corners).collect())
        }
    };
    let tuples = |values: &[f64], n: usize, kept: &[u32]| -> SharedSlice<f64> {
        kept.iter().flat_map(|&i| &values[i as usize * n..][..n]).copied().collect()
    };
    let arrays = |arrays: &BTreeMap<String, Array>, kept: &[u32]| {
        let own = arrays.iter().map(|(name, array)| {
            let n = array.component_count;
            (name.clone(), Array { component_count: n, values: tuples(&array.values, n, kept) })
        });
        own.collect()
    };
    let scalar = whole.scalar.as_ref().map(|scalar| {
        let kept = if scalar.association == Association::Point { points } else { cells };
        Scalar { values: tuples(&scalar.values, 1, kept), ..scalar.clone() }
    });
    let hanging = |all: &Vec<HangingPoint>| {
        let own = all.iter().filter(|own| own.numbers().into_iter().all(|point| number(point) != NONE));
        own.map(|own| own.renumbered(number)).collect()
    };
    let components = |name: &String| whole.cell_arrays.get(name).map_or(1, |array| array.component_count);
    let boundary = |(name, own): (&String, &BoundaryValues)| {
        let number = |point: u32| Some(number(point)).filter(|&number| number != NONE);
        (name.clone(), own.of_points(components(name), number))
    };
    RawGrid {
        ghost: whole.ghost.as_ref().map(|own| cells.iter().map(|&cell| own[cell as usize]).collect()),
        degrees: whole.degrees.as_ref().map(|own| cells.iter().map(|&cell| own[cell as usize]).collect()),
        global_ids: whole.global_ids.as_ref().map(|own| points.iter().map(|&p| own[p as usize]).collect()),
        block: whole.block,
        scalar,
        point_arrays: arrays(&whole.point_arrays, points),
        cell_arrays: arrays(&whole.cell_arrays, cells),
        kept_cell_arrays: arrays(&whole.kept_cell_arrays, cells),
        boundary_values: whole.boundary_values.iter().map(boundary).collect(),
        hanging: whole.hanging.as_ref().map(hanging),
        ..RawGrid::new(points.iter().map(|&p| whole.points[p as usize]).collect::<Vec<_>>(), own_cells)
    }
}
