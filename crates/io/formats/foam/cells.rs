//! Cells of OpenFOAM from their faces: tetrahedra, pyramids, prisms and hexahedra where the faces show them, polyhedra elsewhere.

use super::file::{CollatedPart, FoamFile, misfit};
use crate::formats::lazy::joined;
use rayon::prelude::*;
use std::ops::Range;
use std::path::PathBuf;
use voltet_core::grid::{CellSet, Cells, code};
use voltet_core::{Error, Result};

#[derive(Clone)]
pub(super) struct MeshPaths {
    pub points: PathBuf,
    pub faces: PathBuf,
    pub owner: PathBuf,
    pub neighbour: PathBuf,
    pub zones: Option<PathBuf>,
    /// The file about patches.
    pub boundary: Option<PathBuf>,
    /// The part of each file that is meant.
    pub part: Option<CollatedPart>,
}

/// Faces of a mesh that can be numbered beside a mark of one bit.
const MAX_FACES: usize = (u32::MAX >> 1) as usize;

/// Cells on both sides of faces, whose points were not read.
pub(super) struct FaceOwners {
    owner: Vec<u32>,
    neighbour: Vec<u32>,
    pub cell_count: usize,
}

impl FaceOwners {
    pub fn read(mesh: &MeshPaths) -> Result<FaceOwners> {
        let owner: Vec<u32> = FoamFile::read(&mesh.owner, mesh.part.as_ref(), FoamFile::labels)?;
        let neighbour = neighbours(mesh)?;
        if neighbour.len() > owner.len() {
            let most = format!("at most {}", owner.len());
            return Err(misfit("neighbours of faces", neighbour.len(), most, &mesh.neighbour));
        }
        let last = owner.par_iter().chain(&neighbour).with_min_len(PART).max();
        let cell_count = last.map_or(0, |&last| last as usize + 1);
        // Each cell has faces, and each face two cells at most.
        if cell_count > owner.len() + neighbour.len() {
            return Err(misfit("cells", cell_count, "no more than its faces have", &mesh.owner));
        }
        Ok(FaceOwners { owner, neighbour, cell_count })
    }
}

/// The neighbours of the faces within; older meshes have -1 for those of the boundary, which stand last.
fn neighbours(mesh: &MeshPaths) -> Result<Vec<u32>> {
    let (path, part) = (&mesh.neighbour, mesh.part.as_ref());
    let error = match FoamFile::read(path, part, FoamFile::labels) {
        Ok(cells) => return Ok(cells),
        Err(error) => error,
    };
    let Ok(all) = FoamFile::read(path, part, FoamFile::labels::<i64>) else { return Err(error) };
    let (inner, outer) = all.split_at(all.partition_point(|&cell| cell >= 0));
    let cells = inner.iter().map(|&cell| u32::try_from(cell));
    match cells.collect() {
        Ok(cells) if !outer.is_empty() && outer.iter().all(|&cell| cell == -1) => Ok(cells),
        _ => Err(error),
    }
}

pub(super) struct FaceCells {
    points: Vec<u32>,
    ends: Vec<u32>,
    owner: Vec<u32>,
    neighbour: Vec<u32>,
    pub cell_count: usize,
}

impl FaceCells {
    pub fn read(mesh: &MeshPaths) -> Result<FaceCells> {
        let (points, ends) = FoamFile::read(&mesh.faces, mesh.part.as_ref(), FoamFile::faces)?;
        let FaceOwners { owner, neighbour, cell_count } = FaceOwners::read(mesh)?;
        if owner.len() != ends.len() {
            return Err(misfit("owners of faces", owner.len(), ends.len(), &mesh.owner));
        }
        if owner.len() > MAX_FACES {
            return Err(misfit("faces", owner.len(), format!("at most {MAX_FACES}"), &mesh.owner));
        }
        Ok(FaceCells { points, ends, owner, neighbour, cell_count })
    }

    fn face(&self, face: usize) -> &[u32] {
        let begin = if face == 0 { 0 } else { self.ends[face - 1] as usize };
        &self.points[begin..self.ends[face] as usize]
    }

    /// The first face with one cell, and of those from there on the points, the ends of each one's, and the cells.
    pub fn at_boundary(&self) -> (usize, Vec<u32>, Vec<u32>, Vec<u32>) {
        let first = self.neighbour.len();
        let begin = if first == 0 { 0 } else { self.ends[first - 1] };
        let points = self.points[begin as usize..].to_vec();
        let ends = self.ends[first..].iter().map(|end| end - begin).collect();
        (first, points, ends, self.owner[first..].to_vec())
    }

    /// Selected cells, in VTK's terms.
    pub fn cells(&self, selection: &CellSelection) -> Cells {
        let (begins, of_cells) = self.sides_by_cell();
        if selection.is_all()
            && let Some(cells) = self.tetrahedra(&begins, &of_cells)
        {
            return cells;
        }
        let of_part = |part: usize| {
            let mut gathered = CellSet::default();
            let mut faces = Vec::new();
            let part = part * PART..self.cell_count.min((part + 1) * PART);
            for cell in part.filter(|&cell| selection.contains(cell)) {
                faces.clear();
                for &entry in &of_cells[begins[cell] as usize..begins[cell + 1] as usize] {
                    faces.push((self.face((entry >> 1) as usize), entry & 1 == 0));
                }
                match simple_cell(&faces) {
                    Some((code, corners)) => gathered.push(code, corners.iter().copied()),
                    None => gathered.push_polyhedron(faces.iter().map(|&face| outward(face)).collect()),
                }
            }
            gathered
        };
        let parts: Vec<CellSet> = (0..self.cell_count.div_ceil(PART)).into_par_iter().map(of_part).collect();
        joined(parts)
    }

    /// Beginning of each cell's faces, and the end of the last ones; faces by cell, whose lowest bit says that the cell is the neighbour, whose
    /// face points inward. Each task sorts the faces of a range of the cells, and passes over parts of the faces that have none of these.
    fn sides_by_cell(&self) -> (Vec<u32>, Vec<u32>) {
        let tasks = rayon::current_num_threads().min(MAX_SORTING_TASKS);
        let range = self.cell_count.div_ceil(tasks).max(PART);
        let sides = [Sides::new(&self.owner, 0), Sides::new(&self.neighbour, 1)];
        let mut begins = vec![0_u32; self.cell_count + 1];
        begins[1..].par_chunks_mut(range).enumerate().for_each(|(task, counts)| {
            let first = task * range;
            sides
                .iter()
                .for_each(|sides| sides.each(first..first + counts.len(), |cell, _| counts[cell] += 1));
        });
        (0..self.cell_count).for_each(|cell| begins[cell + 1] += begins[cell]);
        let mut of_cells = vec![0_u32; self.owner.len() + self.neighbour.len()];
        let (mut rest, mut parts) = (&mut of_cells[..], Vec::new());
        for first in (0..self.cell_count).step_by(range) {
            let begins = &begins[first..=self.cell_count.min(first + range)];
            let (own, after) = rest.split_at_mut((begins[begins.len() - 1] - begins[0]) as usize);
            parts.push((first, begins, own));
            rest = after;
        }
        parts.into_par_iter().for_each(|(first, begins, of_cells)| {
            let mut next: Vec<u32> = begins[..begins.len() - 1].iter().map(|at| at - begins[0]).collect();
            for sides in &sides {
                sides.each(first..first + next.len(), |cell, entry| {
                    of_cells[next[cell] as usize] = entry;
                    next[cell] += 1;
                });
            }
        });
        (begins, of_cells)
    }

    /// All cells, straight into their destination; `None` where not all are tetrahedra. `of_cells`: faces with a mark of the side, those of a
    /// cell from its number in `begins` on.
    fn tetrahedra(&self, begins: &[u32], of_cells: &[u32]) -> Option<Cells> {
        let is_regular = self.cell_count > 0 && is_regular(&self.ends, 3, 3) && is_regular(begins, 0, 4);
        if !is_regular {
            return None;
        }
        let (triangles, sides) = (self.points.as_chunks::<3>().0, of_cells.as_chunks::<4>().0);
        let face = |side: u32| &triangles[(side >> 1) as usize];
        let mut corners = vec![[0; 4]; self.cell_count];
        let parts = corners.par_chunks_mut(PART).zip(sides.par_chunks(PART));
        parts.try_for_each(|(to, sides)| {
            for (to, &[a, b, c, d]) in to.iter_mut().zip(sides) {
                *to = tetrahedron([face(a), face(b), face(c), face(d)], a & 1 == 0)?;
            }
            Some(())
        })?;
        Some(Cells::Tetrahedra(corners.into()))
    }
}

/// Tasks that sort the faces of one mesh by cells: where cells are numbered without any order each of them looks at all faces.
const MAX_SORTING_TASKS: usize = 8;

/// Cells on one side of all faces.
struct Sides<'a> {
    cells: &'a [u32],
    /// 1: neighbours.
    mark: u32,
    /// Least and greatest cell of each part of the faces.
    bounds: Vec<[u32; 2]>,
}

impl Sides<'_> {
    fn new(cells: &[u32], mark: u32) -> Sides<'_> {
        let bounds_of = |part: &[u32]| {
            part.iter().fold([u32::MAX, 0], |[low, high], &cell| [low.min(cell), high.max(cell)])
        };
        Sides { cells, mark, bounds: cells.par_chunks(PART).map(bounds_of).collect() }
    }

    /// Calls `visit` for the faces, in their order, of a range of the cells, with the place of the cell in the range, and the face with the mark.
    fn each(&self, range: Range<usize>, mut visit: impl FnMut(usize, u32)) {
        for (part, (cells, &[low, high])) in self.cells.chunks(PART).zip(&self.bounds).enumerate() {
            if high as usize >= range.start && (low as usize) < range.end {
                for (face, &cell) in (part * PART..).zip(cells) {
                    if range.contains(&(cell as usize)) {
                        visit(cell as usize - range.start, (face as u32) << 1 | self.mark);
                    }
                }
            }
        }
    }
}

/// True if bounds ascend from the first one in equal steps.
fn is_regular(bounds: &[u32], first: u64, step: u64) -> bool {
    let is_part_regular = |(part, bounds): (usize, &[u32])| {
        let begin = first + step * (part * PART) as u64;
        bounds
            .iter()
            .zip(0_u64..)
            .fold(true, |all, (&bound, place)| all & (u64::from(bound) == begin + step * place))
    };
    bounds.par_chunks(PART).enumerate().all(is_part_regular)
}

/// Corners of a tetrahedron by its faces, of which the first one points outward or inward.
fn tetrahedron(faces: [&[u32; 3]; 4], is_outward: bool) -> Option<[u32; 4]> {
    let &[a, b, c] = faces[0];
    let is_base = |&point: &u32| point == a || point == b || point == c;
    let apex = *faces[1].iter().find(|point| !is_base(point))?;
    let is_side = |face: &[u32; 3]| {
        let count = face.iter().filter(|&&point| point == apex).count();
        count == 1 && face.iter().all(|point| *point == apex || is_base(point))
    };
    let corners = if is_outward { [c, b, a, apex] } else { [a, b, c, apex] };
    faces[1..].iter().all(|face| is_side(face)).then_some(corners)
}

/// Cells that one task makes.
const PART: usize = 1 << 12;

#[derive(Default)]
pub(super) struct CellZones {
    /// Names in the order of the file.
    pub names: Vec<String>,
    /// Cells in ascending order, with the place of the first zone that each is in.
    cells: Vec<(u32, u32)>,
}

impl CellZones {
    /// Reads them; none where the mesh has no such file.
    pub fn read(mesh: &MeshPaths, cell_count: u64) -> Result<CellZones> {
        let Some(path) = &mesh.zones else { return Ok(CellZones::default()) };
        let mut zones = CellZones::default();
        for (place, (name, cells)) in
            FoamFile::read(path, mesh.part.as_ref(), FoamFile::zones)?.into_iter().enumerate()
        {
            zones.names.push(name);
            zones.cells.extend(cells.into_iter().map(|cell| (cell, place as u32)));
        }
        zones.cells.sort_unstable();
        zones.cells.dedup_by_key(|entry| entry.0);
        match zones.cells.last() {
            Some(&(last, _)) if u64::from(last) >= cell_count => {
                let error = Error::run("a zone names a cell that does not exist").got(last);
                Err(error.expected(format_args!("a number below {cell_count}")).in_file(path))
            }
            _ => Ok(zones),
        }
    }

    /// Number of cells in no zone.
    pub fn rest(&self, cell_count: u64) -> u64 {
        cell_count - self.cells.len() as u64
    }

    /// Number of cells in a zone that are in none before it.
    pub fn count(&self, zone: usize) -> u64 {
        self.cells.iter().filter(|entry| entry.1 as usize == zone).count() as u64
    }

    /// Place of a cell's zone; `None`: it is in none.
    pub fn zone(&self, cell: usize) -> Option<usize> {
        let place = self.cells.binary_search_by_key(&cell, |entry| entry.0 as usize).ok()?;
        Some(self.cells[place].1 as usize)
    }
}

/// Blocks of a part's cells, and those that are read.
pub(super) struct CellSelection {
    pub zones: CellZones,
    /// Numbers of the zones' blocks.
    pub blocks: Vec<usize>,
    /// That of the block of cells in no zone.
    pub rest: usize,
    pub is_selected: Vec<bool>,
}

impl CellSelection {
    /// Number of a cell's block; of cells in no zone the last.
    pub fn block(&self, cell: usize) -> usize {
        match self.zones.zone(cell) {
            Some(zone) => self.blocks[zone],
            None => self.rest,
        }
    }

    pub fn contains(&self, cell: usize) -> bool {
        self.is_selected.get(self.block(cell)).copied().unwrap_or(true)
    }

    pub fn is_all(&self) -> bool {
        let blocks = self.blocks.iter().chain([&self.rest]);
        !blocks.into_iter().any(|&block| self.is_selected.get(block) == Some(&false))
    }

    pub fn count(&self, cell_count: u64) -> u64 {
        if self.is_all() {
            return cell_count;
        }
        let zones = self.blocks.iter().enumerate().filter(|&(_, &block)| self.is_selected[block]);
        let rest =
            if self.is_selected.get(self.rest) == Some(&true) { self.zones.rest(cell_count) } else { 0 };
        zones.fold(rest, |sum, (zone, _)| sum + self.zones.count(zone))
    }
}

/// A face of a cell and true if its points turn so that it points outward.
type Side<'a> = (&'a [u32], bool);

/// Points of a face that points outward.
fn outward((points, is_outward): Side) -> Vec<u32> {
    if is_outward { points.to_vec() } else { points.iter().rev().copied().collect() }
}

struct CellCorners([u32; 8], usize);

impl CellCorners {
    fn push(&mut self, corner: u32) {
        self.0[self.1] = corner;
        self.1 += 1;
    }
}

impl std::ops::Deref for CellCorners {
    type Target = [u32];

    fn deref(&self) -> &[u32] {
        &self.0[..self.1]
    }
}

/// Type and corners of the cell that these faces enclose, if it is one of four.
fn simple_cell(faces: &[Side]) -> Option<(u8, CellCorners)> {
    let count = |corners: usize| faces.iter().filter(|face| face.0.len() == corners).count();
    let (code, base_corners) = match (faces.len(), count(3), count(4)) {
        (4, 4, 0) => (code::TETRA, 3),
        (5, 4, 1) => (code::PYRAMID, 4),
        (5, 2, 3) => (code::WEDGE, 3),
        (6, 0, 6) => (code::HEXAHEDRON, 4),
        _ => return None,
    };
    let base = faces.iter().position(|face| face.0.len() == base_corners)?;
    let (points, is_outward) = faces[base];
    let mut corners = CellCorners([0; 8], 0);
    // VTK's wedge alone has a base that points outward.
    match is_outward == (code == code::WEDGE) {
        true => points.iter().for_each(|&point| corners.push(point)),
        false => points.iter().rev().for_each(|&point| corners.push(point)),
    }
    let is_base = |point: &u32| faces[base].0.contains(point);
    let others = || faces.iter().enumerate().filter(|&(face, _)| face != base).map(|(_, face)| face.0);
    if matches!(code, code::TETRA | code::PYRAMID) {
        let apex = *others().flatten().find(|point| !is_base(point))?;
        let is_side = |face: &[u32]| {
            face.iter().filter(|&&point| point == apex).count() == 1
                && face.iter().all(|point| *point == apex || is_base(point))
        };
        corners.push(apex);
        return others().all(is_side).then_some((code, corners));
    }
    for place in 0..base_corners {
        let top = opposite(corners[place], others(), &is_base)?;
        if corners.contains(&top) {
            return None;
        }
        corners.push(top);
    }
    others().flatten().all(|point| corners.contains(point)).then_some((code, corners))
}

/// The point that edges join to a corner of the base, if it is one.
fn opposite<'a>(
    corner: u32,
    faces: impl Iterator<Item = &'a [u32]>,
    is_base: &impl Fn(&u32) -> bool,
) -> Option<u32> {
    let mut found = None;
    for face in faces {
        let Some(place) = face.iter().position(|&point| point == corner) else { continue };
        for neighbour in [face[(place + 1) % face.len()], face[(place + face.len() - 1) % face.len()]] {
            if !is_base(&neighbour) && *found.get_or_insert(neighbour) != neighbour {
                return None;
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

    /// Tetrahedra around a common edge, closed, so that faces have one cell or two.
    fn ring(count: u32) -> (Vec<[u32; 4]>, FaceCells) {
        let cells: Vec<[u32; 4]> = (0..count).map(|cell| [0, 1, 2 + cell, 2 + (cell + 1) % count]).collect();
        let mut faces: BTreeMap<[u32; 3], ([u32; 3], Vec<u32>)> = BTreeMap::new();
        for (number, &[a, b, c, d]) in cells.iter().enumerate() {
            for face in [[b, c, d], [a, d, c], [a, b, d], [a, c, b]] {
                let mut key = face;
                key.sort_unstable();
                faces.entry(key).or_insert((face, Vec::new())).1.push(number as u32);
            }
        }
        let (inner, outer): (Vec<_>, Vec<_>) = faces.into_values().partition(|face| face.1.len() == 2);
        assert_eq!((inner.len(), outer.len()), (cells.len(), 2 * cells.len()));
        let all: Vec<_> = inner.iter().chain(&outer).collect();
        let mesh = FaceCells {
            points: all.iter().flat_map(|face| face.0).collect(),
            ends: (1..=all.len() as u32).map(|face| 3 * face).collect(),
            owner: all.iter().map(|face| face.1[0]).collect(),
            neighbour: inner.iter().map(|face| face.1[1]).collect(),
            cell_count: cells.len(),
        };
        (cells, mesh)
    }

    #[test]
    fn tetrahedra_are_those_of_any_cells() {
        for (count, threads) in [(7, 1), (2 * PART as u32 + 9, 1), (2 * PART as u32 + 9, 4)] {
            let (cells, mesh) = ring(count);
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let (begins, sides) = pool.install(|| mesh.sides_by_cell());
            let found = pool.install(|| mesh.tetrahedra(&begins, &sides));
            let Some(Cells::Tetrahedra(found)) = found else { panic!() };
            for (cell, found) in found.iter().enumerate() {
                let own = &sides[begins[cell] as usize..begins[cell + 1] as usize];
                let own: Vec<Side> =
                    own.iter().map(|side| (mesh.face((side >> 1) as usize), side & 1 == 0)).collect();
                let (kind, corners) = simple_cell(&own).unwrap();
                assert_eq!((kind, &corners[..]), (code::TETRA, &found[..]));
                let (mut corners, mut expected) = (*found, cells[cell]);
                corners.sort_unstable();
                expected.sort_unstable();
                assert_eq!(corners, expected);
            }
        }
    }

    #[test]
    fn other_cells_among_tetrahedra_are_found_in_every_part() {
        let (_, mut mesh) = ring(2 * PART as u32 + 9);
        let (begins, sides) = mesh.sides_by_cell();
        let last = mesh.ends.len() - 1;
        for face in [0, PART - 1, PART, last] {
            // A face that belongs to no tetrahedron; one with four points.
            let point = std::mem::replace(&mut mesh.points[3 * face], u32::MAX);
            assert!(mesh.tetrahedra(&begins, &sides).is_none(), "face {face}");
            mesh.points[3 * face] = point;
            mesh.ends[face] += 1;
            assert!(mesh.tetrahedra(&begins, &sides).is_none(), "face {face}");
            mesh.ends[face] -= 1;
        }
        for cell in [1, PART - 1, PART, mesh.cell_count - 1] {
            // Five faces of one cell, and three of the next.
            let mut irregular = begins.clone();
            irregular[cell] += 1;
            assert!(mesh.tetrahedra(&irregular, &sides).is_none(), "cell {cell}");
        }
        assert!(mesh.tetrahedra(&begins, &sides).is_some());
    }

    #[test]
    fn faces_are_sorted_by_cells_in_any_number_of_threads() {
        let cell_count = 5 * PART + 7;
        let inner = 2 * cell_count + 3;
        // In an order as solvers number cells, and in none (Knuth's multiplicative hash).
        let near = |face: usize| ((face / 2).min(cell_count - 1)) as u32;
        let far = |face: usize| (face.wrapping_mul(2_654_435_761) % cell_count) as u32;
        for neighbour in [(0..inner).map(far).collect::<Vec<_>>(), (0..inner).map(near).collect()] {
            let owner: Vec<u32> = (0..inner + PART).map(near).collect();
            let mut expected = vec![Vec::new(); cell_count];
            for (cells, side) in [(&owner, 0), (&neighbour, 1)] {
                for (face, &cell) in cells.iter().enumerate() {
                    expected[cell as usize].push((face as u32) << 1 | side);
                }
            }
            let mesh = FaceCells { points: Vec::new(), ends: Vec::new(), owner, neighbour, cell_count };
            for threads in [1, 4, 64] {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                let (begins, sides) = pool.install(|| mesh.sides_by_cell());
                assert_eq!(begins[cell_count] as usize, sides.len());
                for (cell, expected) in expected.iter().enumerate() {
                    let own = &sides[begins[cell] as usize..begins[cell + 1] as usize];
                    assert_eq!(own, expected, "cell {cell} in {threads} threads");
                }
            }
        }
    }
}
