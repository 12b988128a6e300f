//! Pieces of a grid put together as the grid that was cut: which points of different pieces are one point, how they are numbered,
//! and which ghost cells are another piece's.
//!
//! The rule: docs/src/explanation/optics.md, section 2.

use super::parts::{
    Array, Association, BoundaryValues, CellSet, Cells, DUPLICATE, HangingPoint, OWNED, RawGrid, Scalar,
    is_drawn, is_ghost, number, structured_corners,
};
use super::{CellType, code, extent};
use crate::{Error, Result, SharedSlice, counted};
use glam::DVec3;
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
pub fn join(mut pieces: Vec<RawGrid>) -> Result<RawGrid> {
    if pieces.iter().any(|piece| piece.cells.count() > 0) {
        pieces.retain(|piece| piece.cells.count() > 0);
    }
    if pieces.len() < 2 {
        let none = || Error::usage("there is nothing to join").expected("at least one piece of a grid");
        return pieces.pop().ok_or_else(none);
    }
    let mut starts = vec![0];
    for (index, piece) in pieces.iter_mut().enumerate() {
        piece
            .check_lengths()
            .and_then(|()| check_cells(piece))
            .map_err(|error| error.at_item(format!("piece {index}")))?;
        if let Cells::Structured(_) = piece.cells {
            piece.cells = Cells::Mixed(into_set(take_cells(piece), code::VOXEL));
        }
        starts.push(starts[index] + piece.points.len());
    }
    number(starts[pieces.len()], "the grid has too many points", "")?;

    let columns: Vec<Vec<Column>> = pieces.iter().map(columns_of_points).collect();
    let has_ids = pieces.iter().all(|piece| piece.global_ids.is_some());
    let points = PiecePoints { pieces: &pieces, columns: &columns, starts: &starts, has_ids };
    let same = points.same();
    let numbers = points.numbers(&same);
    let targets = points.targets(&same, &numbers);
    drop(columns);
    let count = numbers.par_iter().with_min_len(CHUNK).max().map_or(0, |&last| last as usize + 1);

    let mut ghost = of_all_cells(&pieces, |piece| piece.ghost.as_ref(), 0);
    let degrees = of_all_cells(&pieces, |piece| piece.degrees.as_ref(), [0; 3]);
    let hanging = join_hanging(&pieces, &starts, &numbers);
    let boundary_values = join_boundary_values(&mut pieces, &starts, &numbers);
    let cells = join_cells(&mut pieces, &starts, &numbers);
    if let Some(ghost) = &mut ghost {
        mark_spare_ghosts(&cells, ghost, count);
    }
    let positions = pieces.iter_mut().map(|piece| std::mem::take(&mut piece.points));
    let mut joined = RawGrid::new(scatter(positions, 1, &targets, count), cells);
    joined.origin.warnings =
        pieces.iter_mut().flat_map(|piece| std::mem::take(&mut piece.origin.warnings)).collect();
    (joined.ghost, joined.degrees, joined.hanging) = (ghost, degrees, hanging);
    joined.boundary_values = boundary_values;
    join_arrays(&mut joined, pieces, &targets, count)?;
    joined.origin.points_joined = (targets.len() - count) as u64;
    joined.joined_points = Some(numbers);
    Ok(joined)
}

/// Values of a point array and the components of a tuple.
type Column<'a> = (&'a [f64], usize);

fn columns_of_points(piece: &RawGrid) -> Vec<Column<'_>> {
    let scalar = piece.scalar.iter().filter(|scalar| scalar.association == Association::Point);
    let scalar = scalar.map(|scalar| (&scalar.values[..], 1));
    scalar
        .chain(piece.point_arrays.values().map(|array| (&array.values[..], array.component_count)))
        .collect()
}

/// The points of all pieces, numbered one piece after the other.
struct PiecePoints<'a> {
    pieces: &'a [RawGrid],
    /// The point arrays of each piece.
    columns: &'a [Vec<Column<'a>>],
    /// The first number of each piece, and the number of all points.
    starts: &'a [usize],
    /// True if every piece has global ids.
    has_ids: bool,
}

impl PiecePoints<'_> {
    /// The piece of a point, and its number there.
    fn place(&self, point: u32) -> (usize, usize) {
        let piece = self.starts.partition_point(|&start| start <= point as usize) - 1;
        (piece, point as usize - self.starts[piece])
    }

    fn id(&self, piece: usize, point: usize) -> Option<i64> {
        self.pieces[piece].global_ids.as_ref()?.get(point).copied()
    }

    /// For each point the first of those that are the same point.
    fn same(&self) -> Vec<u32> {
        let mut same: Vec<u32> = (0..self.starts[self.pieces.len()] as u32).collect();
        let mut keyed = if self.has_ids { self.ids() } else { self.places_that_may_be_shared() };
        keyed.par_sort_unstable();
        let (mut left, mut firsts) = (Vec::new(), Vec::new());
        for equal in keyed.chunk_by(|a, b| a.0 == b.0).filter(|equal| equal.len() > 1) {
            left.clear();
            left.extend(equal.iter().map(|&(_, piece, point)| (piece, point)));
            // Keys may be equal by chance.
            while let Some(&first) = left.first() {
                firsts.clear();
                let (mut of_piece, mut seen) = (u32::MAX, 0);
                left.retain(|&(piece, point)| {
                    if !self.is_same(first, (piece, point)) {
                        return true;
                    }
                    (of_piece, seen) = if piece == of_piece { (piece, seen + 1) } else { (piece, 0) };
                    // Points of one piece stay apart: its second is one with the second of another piece.
                    match firsts.get(seen) {
                        Some(&first) => same[point as usize] = first,
                        None => firsts.push(point),
                    }
                    false
                });
            }
        }
        same
    }

    /// Keys of all points, of their blocks and global ids.
    fn ids(&self) -> Vec<Keyed> {
        let mut keyed = Vec::with_capacity(self.starts[self.pieces.len()]);
        for (index, piece) in self.pieces.iter().enumerate() {
            let ids = piece.global_ids.iter().flatten().zip(self.starts[index] as u32..);
            let block = (piece.block as u64).rotate_right(16);
            keyed.extend(ids.map(|(&id, point)| (block ^ id as u64, index as u32, point)));
        }
        keyed
    }

    /// Keys of positions and values, at the points of each piece that lie in the box of another.
    fn places_that_may_be_shared(&self) -> Vec<Keyed> {
        let boxes: Vec<Option<[DVec3; 2]>> =
            self.pieces.iter().map(|piece| extent::bounds(&piece.points)).collect();
        let meets = |[a, b]: [DVec3; 2], [c, d]: [DVec3; 2]| a.cmple(d).all() && c.cmple(b).all();
        let all = boxes.iter().flatten().fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[low, high], own| {
            [low.min(own[0]), high.max(own[1])]
        });
        let mut of_blocks = BTreeMap::<usize, Vec<usize>>::new();
        for (index, piece) in self.pieces.iter().enumerate() {
            of_blocks.entry(piece.block).or_default().push(index);
        }
        let mut keyed = Vec::new();
        for (index, piece) in self.pieces.iter().enumerate() {
            let Some(own) = boxes[index] else { continue };
            let others = of_blocks[&piece.block].iter().filter(|&&other| other != index);
            let others: Vec<[DVec3; 2]> =
                others.filter_map(|&other| boxes[other].filter(|&b| meets(own, b))).collect();
            let key = |(point, &at): (usize, &DVec3)| {
                let may_be_shared = others.iter().any(|&[low, high]| meets([at, at], [low, high]));
                may_be_shared
                    .then(|| (self.key(index, point, all), index as u32, (self.starts[index] + point) as u32))
            };
            keyed.par_extend(piece.points.par_iter().enumerate().with_min_len(CHUNK).filter_map(key));
        }
        keyed
    }

    /// A hash of the position and the values of a point, by which points without ids are found again. Its upper 24 bits are the
    /// position on a lattice over the box of all points: sorted points are then near each other in memory, too.
    fn key(&self, piece: usize, point: usize, [low, high]: [DVec3; 2]) -> u64 {
        let at = self.pieces[piece].points[point];
        let lattice = (at - low) / (high - low) * 255.0;
        let lattice = lattice.to_array().into_iter().fold(0, |key, x| key << 8 | x as u64);
        let mut key = at.to_array().map(bits).into_iter().fold(self.pieces[piece].block as u64, mixed);
        for &(values, n) in &self.columns[piece] {
            key = values[point * n..][..n].iter().fold(key, |key, &value| mixed(key, bits(value)));
        }
        lattice << 40 | key >> 24
    }

    fn is_same(&self, (p, a): (u32, u32), (q, b): (u32, u32)) -> bool {
        let (p, q) = (p as usize, q as usize);
        let (i, j) = (a as usize - self.starts[p], b as usize - self.starts[q]);
        let (one, other) = (&self.pieces[p], &self.pieces[q]);
        if one.block != other.block || self.has_ids {
            return one.block == other.block && self.id(p, i) == self.id(q, j);
        }
        let equal = |(&x, &y): (&f64, &f64)| bits(x) == bits(y);
        one.points[i].as_ref().iter().zip(other.points[j].as_ref()).all(equal)
            && self.columns[p]
                .iter()
                .zip(&self.columns[q])
                .all(|(&(these, n), &(those, _))| these[i * n..][..n].iter().zip(&those[j * n..]).all(equal))
    }

    /// The number of each point in the grid of all pieces. The order of the points of each piece is kept, so that each face is cut by
    /// the same diagonal as in the grid that was cut into these pieces; where the pieces contradict each other, by ids if there
    /// are any, else the order of the first of them.
    fn numbers(&self, same: &[u32]) -> Vec<u32> {
        let mut holders = vec![0_u32; same.len()];
        same.iter().for_each(|&first| holders[first as usize] += 1);
        let mut numbers = vec![u32::MAX; same.len()];
        let mut next = 0..;
        let mut cursors = self.starts[..self.pieces.len()].to_vec();
        let mut going: Vec<usize> = (0..self.pieces.len()).rev().collect();
        // Pieces that have come to a point which others have before them.
        let mut waiting: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
        loop {
            while let Some(piece) = going.pop() {
                while cursors[piece] < self.starts[piece + 1] {
                    let first = same[cursors[piece]];
                    if numbers[first as usize] == u32::MAX {
                        holders[first as usize] -= 1;
                        if holders[first as usize] > 0 {
                            waiting.entry(first).or_default().push(piece);
                            break;
                        }
                        numbers[first as usize] = next.next().unwrap_or(u32::MAX);
                        going.extend(waiting.remove(&first).unwrap_or_default());
                    }
                    cursors[piece] += 1;
                }
            }
            let Some((first, pieces)) = waiting.pop_first() else { break };
            if self.has_ids {
                let mut firsts: Vec<u32> =
                    (0..same.len() as u32).filter(|&p| same[p as usize] == p).collect();
                let id = |&point: &u32| {
                    let (piece, number) = self.place(point);
                    (self.id(piece, number), point)
                };
                firsts.par_sort_by_cached_key(id);
                firsts.into_iter().zip(0..).for_each(|(first, number)| numbers[first as usize] = number);
                break;
            }
            numbers[first as usize] = next.next().unwrap_or(u32::MAX);
            going.extend(pieces);
        }
        same.par_iter().with_min_len(CHUNK).map(|&first| numbers[first as usize]).collect()
    }

    /// Targets of the values of each point: its number, or nowhere (`u32::MAX`) where another point's stand for it. A point that a
    /// piece has for its ghost cells alone may hold older values than its owner's.
    fn targets(&self, same: &[u32], numbers: &[u32]) -> Vec<u32> {
        let mut from: Vec<u32> = same.to_vec();
        if self.pieces.iter().any(|piece| piece.ghost.is_some()) {
            let mut owned = vec![false; same.len()];
            for (piece, &start) in self.pieces.iter().zip(self.starts) {
                let own =
                    |cell: &usize| piece.ghost.as_ref().is_none_or(|ghost| ghost[*cell] & DUPLICATE == 0);
                let cells = (0..piece.cells.count()).filter(own);
                cells
                    .flat_map(|cell| corners(&piece.cells, cell))
                    .for_each(|&c| owned[start + c as usize] = true);
            }
            // `from` at the first of the same points is where their values come from.
            for (point, &first) in same.iter().enumerate() {
                if owned[point] && !owned[from[first as usize] as usize] {
                    from[first as usize] = point as u32;
                }
            }
        }
        let is_source = |point: usize| from[same[point] as usize] == point as u32;
        let target = |point| if is_source(point) { numbers[point] } else { u32::MAX };
        (0..same.len()).into_par_iter().with_min_len(CHUNK).map(target).collect()
    }
}

/// A key of a point, its piece, and its number among all.
type Keyed = (u64, u32, u32);

/// Bits of a number: −0 is 0, and all NaNs are one.
fn bits(x: f64) -> u64 {
    if x.is_nan() { u64::MAX } else { (x + 0.0).to_bits() }
}

/// A key made of another and further bits: the finaliser of Steele, Lea and Flood 2014, "Fast splittable pseudorandom number generators".
fn mixed(key: u64, bits: u64) -> u64 {
    let mut z = (key ^ bits).wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// The points of a cell; none of a structured grid's, which [`join`] has made a set.
fn corners(cells: &Cells, number: usize) -> &[u32] {
    match cells {
        Cells::Tetrahedra(tetrahedra) => &tetrahedra[number],
        Cells::Mixed(set) => {
            let range = set.offsets[number] as usize..set.offsets[number + 1] as usize;
            set.connectivity.get(range).unwrap_or(&[])
        }
        Cells::Structured(_) => &[],
    }
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

fn take_cells(piece: &mut RawGrid) -> Cells {
    std::mem::replace(&mut piece.cells, Cells::Tetrahedra(SharedSlice::default()))
}

/// The cells of all pieces one after the other, by the numbers of the joined points.
fn join_cells(pieces: &mut [RawGrid], starts: &[usize], numbers: &[u32]) -> Cells {
    let all_tetrahedra = pieces.iter().all(|piece| matches!(piece.cells, Cells::Tetrahedra(_)));
    let mut tetrahedra = Vec::new();
    let mut all = CellSet { offsets: vec![0], ..CellSet::default() };
    for (piece, &start) in pieces.iter_mut().zip(starts) {
        let number = |corner: u32| numbers[start + corner as usize];
        match take_cells(piece) {
            Cells::Tetrahedra(own) if all_tetrahedra => {
                tetrahedra.par_extend(own.par_iter().with_min_len(CHUNK).map(|corners| corners.map(number)));
            }
            cells => {
                let set = into_set(cells, code::VOXEL);
                let (first_cell, begin) = (all.types.len() as u32, all.connectivity.len() as u64);
                all.types.extend(set.types);
                all.offsets.extend(set.offsets[1..].iter().map(|offset| offset + begin));
                all.connectivity.par_extend(set.connectivity.into_par_iter().with_min_len(CHUNK).map(number));
                for mut polyhedron in set.polyhedra {
                    polyhedron.cell += first_cell;
                    polyhedron.faces.iter_mut().flatten().for_each(|corner| *corner = number(*corner));
                    all.polyhedra.push(polyhedron);
                }
            }
        }
    }
    if all_tetrahedra { Cells::Tetrahedra(tetrahedra.into()) } else { Cells::Mixed(all) }
}

/// Any cells as a set; those of a structured grid of the type `structured`, [`code::VOXEL`] or [`code::HEXAHEDRON`].
pub fn into_set(cells: Cells, structured: u8) -> CellSet {
    let regular = |code: u8, corners: usize, connectivity: Vec<u32>| {
        let count = connectivity.len() / corners;
        let offsets = (0..=count).map(|number| (corners * number) as u64).collect();
        CellSet { types: vec![code; count], offsets, connectivity, polyhedra: Vec::new() }
    };
    match cells {
        Cells::Mixed(set) => set,
        Cells::Tetrahedra(mut own) => {
            regular(code::TETRA, 4, std::mem::take(own.make_mut()).into_flattened())
        }
        Cells::Structured(dimensions) => {
            let order =
                if structured == code::VOXEL { [0, 1, 2, 3, 4, 5, 6, 7] } else { [0, 1, 3, 2, 4, 5, 7, 6] };
            let corners = |number: usize| {
                let corners = structured_corners(dimensions, number);
                order.map(|corner: usize| corners[corner])
            };
            regular(structured, 8, (0..cells.count()).flat_map(corners).collect())
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
