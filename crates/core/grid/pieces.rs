//! Pieces of a grid put together as the grid that was cut, whole or in part: points of different pieces that are one are joined
//! ([`super::shared_points`]), and ghost cells that are another piece's serve nothing.
//!
//! The rule: docs/src/explanation/optics.md, section 2.

use super::cell_set::CellSet;
use super::parts::{
    Array, Association, BoundaryValues, Cells, DUPLICATE, HangingPoint, NEIGHBOUR, OWNED, RawGrid, Scalar,
    corners, is_drawn, is_ghost, number, structured_corners,
};
use super::shared_points::{PointHolder, PointNumbers, SharedPoints, shared_points};
use super::{CellType, code};
use crate::{Error, Result, SharedSlice, counted};
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};

/// Tuples that one task handles.
const CHUNK: usize = 1 << 13;

/// Puts the pieces of a grid together. Points of different pieces of a block are one where their global ids are equal; where a piece
/// has no ids, at equal positions with equal values. Points of different blocks stay apart. Linear in time and memory, but for a sort
/// of the points that may be shared.
///
/// # Errors
/// - an array that a piece lacks, or has with other components;
/// - a cell that names a point beyond its piece;
/// - more points or cells than 32 bits number.
pub fn join(pieces: Vec<RawGrid>) -> Result<RawGrid> {
    join_by(pieces, None)
}

/// Like [`join`], by the shared points of the pieces with cells where they were found before ([`SharedPoints::by_values`]).
///
/// # Errors
/// As of [`join`]; the shared points are those of another number of pieces with cells.
pub fn join_by(mut pieces: Vec<RawGrid>, shared: Option<SharedPoints>) -> Result<RawGrid> {
    if pieces.iter().any(|piece| piece.cells.count() > 0) {
        pieces.retain(|piece| piece.cells.count() > 0);
    }
    if pieces.len() < 2 {
        let none = || Error::usage("there is nothing to join").expected("at least one piece of a grid");
        return pieces.pop().ok_or_else(none);
    }
    for (index, piece) in pieces.iter_mut().enumerate() {
        prepare(piece, index)?;
    }
    let shared = shared.unwrap_or_else(|| shared_points(&pieces));
    if shared.piece_count() != pieces.len() {
        let error = Error::usage("the shared points are those of other pieces").got(shared.piece_count());
        return Err(error.expected(format_args!("{}, those with cells", counted(pieces.len(), "piece"))));
    }
    let whole = |(piece, grid)| JoinedPiece { piece, grid, originals: None, is_halo: false };
    join_pieces(pieces.into_iter().enumerate().map(whole).collect(), &shared)
}

/// Checks a piece, and brings cells of a structured grid into a set.
pub(super) fn prepare(piece: &mut RawGrid, index: usize) -> Result<()> {
    let checked = piece.check_lengths().and_then(|()| check_cells(piece));
    checked.map_err(|error| error.at_item(format!("piece {index}")))?;
    if let Cells::Structured(_) = piece.cells {
        piece.cells = Cells::Mixed(into_set(std::mem::take(&mut piece.cells)));
    }
    Ok(())
}

/// A piece, whole or a part of it, on its way into a grid.
pub(super) struct JoinedPiece {
    pub piece: usize,
    pub grid: RawGrid,
    /// Numbers of its points in the piece, ascending; `None`: all are there.
    pub originals: Option<Vec<u32>>,
    /// True if its cells are ghosts for those of others.
    pub is_halo: bool,
}

/// Puts pieces together that were prepared, ascending by their numbers.
pub(super) fn join_pieces(joined: Vec<JoinedPiece>, shared: &SharedPoints) -> Result<RawGrid> {
    let mut starts = vec![0];
    joined.iter().for_each(|own| starts.push(starts[starts.len() - 1] + own.grid.points.len()));
    number(starts[joined.len()], "the grid has too many points", "")?;
    let holder = |own| {
        let JoinedPiece { piece, grid, originals, .. }: &JoinedPiece = own;
        let (count, ids) = (grid.points.len(), grid.global_ids.as_deref().unwrap_or_default());
        PointHolder { piece: *piece, count, originals: originals.as_deref(), ids }
    };
    let PointNumbers { numbers, targets, count } =
        shared.numbers(&joined.iter().map(holder).collect::<Vec<_>>());
    let mut points_joined = targets.len() - count;
    if joined.iter().any(|own| own.is_halo) {
        let mut is_there = vec![false; count];
        let own = joined.iter().zip(&starts).filter(|own| !own.0.is_halo);
        let own = own.flat_map(|(own, &start)| &numbers[start..][..own.grid.points.len()]);
        points_joined =
            own.filter(|&&number| std::mem::replace(&mut is_there[number as usize], true)).count();
    }

    let cell_counts: Vec<(usize, bool)> =
        joined.iter().map(|own| (own.grid.cells.count(), own.is_halo)).collect();
    let mut pieces: Vec<RawGrid> = joined.into_iter().map(|own| own.grid).collect();
    let mut ghost = of_all_cells(&pieces, |piece| piece.ghost.as_ref(), 0);
    let degrees = of_all_cells(&pieces, |piece| piece.degrees.as_ref(), [0; 3]);
    let hanging = join_hanging(&pieces, &starts, &numbers);
    let boundary_values = join_boundary_values(&mut pieces, &starts, &numbers);
    let cells = join_cells(&mut pieces, &starts, &numbers);
    if let Some(ghost) = &mut ghost {
        mark_spare_ghosts(&cells, ghost, count);
    }
    if cell_counts.iter().any(|own| own.1) {
        let mut ghost = ghost.get_or_insert_with(|| vec![0; cells.count()]).iter_mut();
        for (count, is_halo) in cell_counts {
            let set = if is_halo { DUPLICATE | NEIGHBOUR } else { 0 };
            ghost.by_ref().take(count).for_each(|flags| *flags = *flags & !NEIGHBOUR | set);
        }
    }
    let positions = pieces.iter_mut().map(|piece| std::mem::take(&mut piece.points));
    let mut joined = RawGrid::new(scatter(positions, 1, &targets, count), cells);
    joined.origin.warnings =
        pieces.iter_mut().flat_map(|piece| std::mem::take(&mut piece.origin.warnings)).collect();
    (joined.ghost, joined.degrees, joined.hanging) = (ghost, degrees, hanging);
    joined.boundary_values = boundary_values;
    join_arrays(&mut joined, pieces, &targets, count)?;
    joined.origin.points_joined = points_joined as u64;
    joined.joined_points = Some(numbers);
    Ok(joined)
}

/// Refuses cells of unknown types, and cells that name points beyond their piece, before the numbers become those of another piece's
/// points.
pub fn check_cells(piece: &RawGrid) -> Result<()> {
    if let Cells::Mixed(set) = &piece.cells
        && let Some(&code) = set.types.iter().find(|&&code| CellType::from_code(code).is_none())
    {
        let error = Error::run("a cell has an unknown type").got(code);
        return Err(error.expected("a cell type code of VTK"));
    }
    let wrong = |&&corner: &&u32| corner as usize >= piece.points.len();
    let found = match &piece.cells {
        Cells::Tetrahedra(tetrahedra) => tetrahedra.as_flattened().iter().find(wrong),
        Cells::Mixed(set) => {
            let faces = set.polyhedra.iter().flat_map(|polyhedron| polyhedron.faces.iter().flatten());
            set.connectivity.iter().chain(faces).find(wrong)
        }
        Cells::Structured(_) => None,
    };
    let Some(corner) = found else { return Ok(()) };
    let error = Error::run("a cell names a point that its piece does not hold").got(corner);
    Err(error.expected(format_args!("a point number below {}", piece.points.len())))
}

/// Values of the cells of all pieces; cells of pieces without any get a blank. `None` where no piece has any.
fn of_all_cells<T: Copy>(
    pieces: &[RawGrid],
    of: impl Fn(&RawGrid) -> Option<&Vec<T>>,
    blank: T,
) -> Option<Vec<T>> {
    pieces.iter().any(|piece| of(piece).is_some()).then(|| {
        let own = |piece| of(piece).cloned().unwrap_or_else(|| vec![blank; piece.cells.count()]);
        pieces.iter().flat_map(own).collect()
    })
}

/// Hanging points of all pieces by the numbers of the joined points; `None` where no piece is an adaptive grid.
fn join_hanging(pieces: &[RawGrid], starts: &[usize], numbers: &[u32]) -> Option<Vec<HangingPoint>> {
    let of_piece = |(piece, &start): (&RawGrid, &usize)| {
        let number = move |point: u32| numbers[start + point as usize];
        piece.hanging.as_ref().map(|own| own.iter().map(|own| own.renumbered(number)).collect::<Vec<_>>())
    };
    pieces.iter().zip(starts).filter_map(of_piece).reduce(|all, own| [all, own].concat())
}

/// Values at the boundaries of all pieces by the numbers of the joined points.
fn join_boundary_values(
    pieces: &mut [RawGrid],
    starts: &[usize],
    numbers: &[u32],
) -> BTreeMap<String, BoundaryValues> {
    let mut joined: BTreeMap<String, BoundaryValues> = BTreeMap::new();
    for (piece, &start) in pieces.iter_mut().zip(starts) {
        for (name, own) in std::mem::take(&mut piece.boundary_values) {
            joined.entry(name).or_default().append(own.renumbered(|point| numbers[start + point as usize]));
        }
    }
    joined
}

/// The cells of all pieces one after the other, by the numbers of the joined points.
fn join_cells(pieces: &mut [RawGrid], starts: &[usize], numbers: &[u32]) -> Cells {
    let all_tetrahedra = pieces.iter().all(|piece| matches!(piece.cells, Cells::Tetrahedra(_)));
    let mut tetrahedra = Vec::new();
    let mut all = CellSet::default();
    for (piece, &start) in pieces.iter_mut().zip(starts) {
        let number = |corner: u32| numbers[start + corner as usize];
        match std::mem::take(&mut piece.cells) {
            Cells::Tetrahedra(own) if all_tetrahedra => {
                tetrahedra.par_extend(own.par_iter().with_min_len(CHUNK).map(|corners| corners.map(number)));
            }
            cells => all.append(into_set(cells), number),
        }
    }
    if all_tetrahedra { Cells::Tetrahedra(tetrahedra.into()) } else { Cells::Mixed(all) }
}

/// Any cells as a set; those of a structured grid as hexahedra, for they may be no boxes along the axes.
pub fn into_set(cells: Cells) -> CellSet {
    match cells {
        Cells::Mixed(set) => set,
        Cells::Tetrahedra(mut own) => {
            CellSet::of_type(code::TETRA, 4, std::mem::take(own.make_mut()).into_flattened())
        }
        Cells::Structured(dimensions) => {
            let corners = |number: usize| {
                let corners = structured_corners(dimensions, number);
                [0, 1, 3, 2, 4, 5, 7, 6].map(|corner: usize| corners[corner])
            };
            CellSet::of_type(code::HEXAHEDRON, 8, (0..cells.count()).flat_map(corners).collect())
        }
    }
}

/// Marks the ghost cells whose original is there, and all but the first of ghosts of one cell.
fn mark_spare_ghosts(cells: &Cells, ghost: &mut [u8], point_count: usize) {
    let mut of_ghosts = vec![false; point_count];
    let ghosts = (0..ghost.len()).filter(|&cell| is_ghost(ghost[cell]));
    ghosts.flat_map(|cell| corners(cells, cell)).for_each(|&p| of_ghosts[p as usize] = true);
    let sorted = |cell: usize| {
        let mut corners = corners(cells, cell).to_vec();
        corners.sort_unstable();
        corners
    };
    // Cells among the points of ghosts, by their points: originals before ghosts.
    let among = |&cell: &usize| {
        corners(cells, cell).iter().all(|&p| of_ghosts[p as usize])
            && (is_drawn(ghost[cell]) || is_ghost(ghost[cell]))
    };
    let mut found: Vec<(Vec<u32>, bool, usize)> = (0..ghost.len())
        .into_par_iter()
        .with_min_len(CHUNK)
        .filter(among)
        .map(|cell| (sorted(cell), is_ghost(ghost[cell]), cell))
        .collect();
    found.par_sort_unstable();
    for same in found.chunk_by(|a, b| a.0 == b.0) {
        same[1..].iter().filter(|(_, is_ghost, _)| *is_ghost).for_each(|&(_, _, cell)| ghost[cell] |= OWNED);
    }
}

/// Tuples of all pieces brought to where they go.
fn scatter<T: Copy + Default + 'static>(
    of_pieces: impl Iterator<Item = SharedSlice<T>>,
    component_count: usize,
    targets: &[u32],
    count: usize,
) -> Vec<T> {
    let n = component_count;
    let mut joined = vec![T::default(); count * n];
    let mut targets = targets.iter();
    for values in of_pieces {
        for (tuple, &target) in values.chunks_exact(n).zip(&mut targets) {
            if target != u32::MAX {
                joined[target as usize * n..][..n].copy_from_slice(tuple);
            }
        }
    }
    joined
}

/// Adds the arrays of all pieces to the joined grid. Errors: an array that one of them lacks, or has with other components.
fn join_arrays(joined: &mut RawGrid, mut pieces: Vec<RawGrid>, targets: &[u32], count: usize) -> Result<()> {
    if let Some(scalar) = pieces.iter().find_map(|piece| piece.scalar.clone()) {
        let mut all = Vec::new();
        for piece in &mut pieces {
            let own = piece.scalar.take().filter(|own| own.association == scalar.association);
            all.push(own.ok_or_else(|| lacks(&scalar.name))?.values);
        }
        let values = match scalar.association {
            Association::Point => scatter(all.into_iter(), 1, targets, count),
            Association::Cell => concatenated(&all),
        };
        joined.scalar = Some(Scalar { values: values.into(), ..scalar });
    }
    type Arrays = fn(&mut RawGrid) -> &mut BTreeMap<String, Array>;
    let kinds: [(Arrays, bool); 3] = [
        (|grid| &mut grid.point_arrays, true),
        (|grid| &mut grid.cell_arrays, false),
        (|grid| &mut grid.kept_cell_arrays, false),
    ];
    for (arrays, on_points) in kinds {
        let names: BTreeSet<String> =
            pieces.iter_mut().flat_map(|piece| arrays(piece).keys().cloned()).collect();
        for name in names {
            let mut all: Vec<SharedSlice<f64>> = Vec::new();
            let mut component_count = None;
            for piece in &mut pieces {
                let own = arrays(piece).remove(&name).ok_or_else(|| lacks(&name))?;
                let n = *component_count.get_or_insert(own.component_count);
                if own.component_count != n {
                    let error = Error::run(format!("the array '{name}' differs between the pieces"));
                    return Err(error.got(counted(own.component_count, "component")).expected(n));
                }
                all.push(own.values);
            }
            let component_count = component_count.unwrap_or(1);
            let values = match on_points {
                true => scatter(all.into_iter(), component_count, targets, count),
                false => concatenated(&all),
            };
            arrays(joined).insert(name, Array { component_count, values: values.into() });
        }
    }
    Ok(())
}

fn concatenated(all: &[SharedSlice<f64>]) -> Vec<f64> {
    all.iter().map(|values| &values[..]).collect::<Vec<_>>().concat()
}

fn lacks(name: &str) -> Error {
    Error::run(format!("a piece of the grid lacks the array '{name}'"))
        .expected("the same arrays in every piece")
}
