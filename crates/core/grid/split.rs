//! Split of linear cells and of polyhedra (VTK type 42) into tetrahedra, so that neighbours share the same triangles.
//!
//! The rule (docs/src/explanation/optics.md, section 2; J. Dompierre, P. Labbé, M.-G. Vallet, R. Camarero, "How to subdivide
//! pyramids, prisms and hexahedra into tetrahedra", 8th International Meshing Roundtable, 1999): every face is cut
//! from its corner of lowest point number, so that two cells which share it cut it alike whatever their own
//! orientation and vertex order; then the cell is split to match its cut faces:
//! - wedges, pyramids and prisms are joined to their corner of lowest number ([`star`]);
//! - a hexahedron has, besides, a choice inside. Its three faces that do not touch the lowest corner o meet in the
//!   opposite corner p. With n of their diagonals through p, Dompierre's tables 5 to 8 give
//!   n = 0: five tetrahedra, one of them cut off at p; n = 1: six around the corner in which the two diagonals that
//!   avoid p meet; n = 2 and 3: six around o.
//!
//! A tetrahedron that names a point twice (from a collapsed cell) has no volume and is not handed out.
//!
//! Every face becomes a fan of triangles from its corner of lowest number, so that neighbours agree; a face of five
//! or more corners that is not convex takes the first corner, by number, whose fan does not fold over. The triangles
//! are then joined to a point that sees all of them: the corner of lowest number if it does (in a convex cell it
//! always does), else the mean of the corners (an added point, which carries the mean of their values), else the
//! first other corner that does. Where none does, the mean is taken all the same and the cell is counted: its
//! pieces overlap.

use super::parts::{CellSet, Polyhedron, number};
use crate::{Error, Result};
use glam::DVec3;
use rayon::prelude::*;
use std::collections::HashMap;

/// Faces of a pyramid, in VTK's vertex order.
pub(super) const PYRAMID_FACES: &[&[usize]] =
    &[&[0, 1, 2, 3], &[0, 1, 4], &[1, 2, 4], &[2, 3, 4], &[3, 0, 4]];
/// Faces of a wedge.
pub(super) const WEDGE_FACES: &[&[usize]] =
    &[&[0, 1, 2], &[3, 4, 5], &[0, 1, 4, 3], &[1, 2, 5, 4], &[2, 0, 3, 5]];
/// Faces of a pentagonal prism.
pub(super) const PENTAGONAL_PRISM_FACES: &[&[usize]] = &[
    &[0, 1, 2, 3, 4],
    &[5, 6, 7, 8, 9],
    &[0, 1, 6, 5],
    &[1, 2, 7, 6],
    &[2, 3, 8, 7],
    &[3, 4, 9, 8],
    &[4, 0, 5, 9],
];
/// Faces of a hexagonal prism.
pub(super) const HEXAGONAL_PRISM_FACES: &[&[usize]] = &[
    &[0, 1, 2, 3, 4, 5],
    &[6, 7, 8, 9, 10, 11],
    &[0, 1, 7, 6],
    &[1, 2, 8, 7],
    &[2, 3, 9, 8],
    &[3, 4, 10, 9],
    &[4, 5, 11, 10],
    &[5, 0, 6, 11],
];

/// Hands out a tetrahedron unless it names a point twice.
#[inline]
pub(super) fn emit_distinct(t: [u32; 4], emit: &mut impl FnMut([u32; 4])) {
    let [a, b, c, d] = t;
    if a != b && a != c && a != d && b != c && b != d && c != d {
        emit(t);
    }
}

/// Position of the lowest number.
#[inline]
pub(super) fn lowest(corners: &[u32]) -> usize {
    let mut at = 0;
    for (i, &c) in corners.iter().enumerate() {
        if c < corners[at] {
            at = i;
        }
    }
    at
}

/// Joins the corner of lowest number to the triangles of every face that does not touch it; each face is a fan
/// from its own corner of lowest number.
pub(super) fn star(corners: &[u32], faces: &[&[usize]], emit: &mut impl FnMut([u32; 4])) {
    let apex = corners[lowest(corners)];
    for face in faces {
        let mut first = 0;
        let mut touches = false;
        for (i, &c) in face.iter().enumerate() {
            touches |= corners[c] == apex;
            if corners[c] < corners[face[first]] {
                first = i;
            }
        }
        if touches {
            continue;
        }
        let n = face.len();
        let corner = |k: usize| corners[face[(first + k) % n]];
        for k in 1..n - 1 {
            emit_distinct([apex, corner(0), corner(k), corner(k + 1)], emit);
        }
    }
}

/// VTK's hexahedron in the order of a voxel (corner x + 2 y + 4 z).
#[inline]
pub(super) fn voxel_order(v: &[u32]) -> [u32; 8] {
    [v[0], v[1], v[3], v[2], v[4], v[5], v[7], v[6]]
}

/// Splits a hexahedron given in the order of a voxel into five or six tetrahedra.
#[inline]
pub(super) fn hexahedron(v: &[u32; 8], emit: &mut impl FnMut([u32; 4])) {
    let o_at = lowest(v);
    // In voxel order the corner across bit i is at index ^ (1 << i).
    let at = |mask: usize| v[o_at ^ mask];
    let o = at(0);
    let p = at(7);
    let near = [at(1), at(2), at(4)]; // joined to o by an edge
    let far = [at(6), at(5), at(3)]; // far[i] is opposite to near[i], joined to p by an edge
    // Face i holds near[i], p and the two far corners other than far[i].
    let through = |i: usize| near[i].min(p) < far[(i + 1) % 3].min(far[(i + 2) % 3]);
    let through = [through(0), through(1), through(2)];
    match through.iter().filter(|&&t| t).count() {
        0 => {
            for i in 0..3 {
                emit_distinct([o, near[i], far[(i + 1) % 3], far[(i + 2) % 3]], emit);
            }
            emit_distinct([o, far[0], far[1], far[2]], emit);
            emit_distinct([p, far[0], far[1], far[2]], emit);
        }
        1 => {
            let i = through.iter().position(|&t| t).unwrap_or(0);
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            let apex = far[i];
            emit_distinct([apex, near[i], p, far[j]], emit);
            emit_distinct([apex, near[i], p, far[k]], emit);
            emit_distinct([apex, o, far[j], near[i]], emit);
            emit_distinct([apex, o, far[j], near[k]], emit);
            emit_distinct([apex, o, far[k], near[i]], emit);
            emit_distinct([apex, o, far[k], near[j]], emit);
        }
        _ => {
            for i in 0..3 {
                let (j, k) = ((i + 1) % 3, (i + 2) % 3);
                let (a, b, c, d) =
                    if through[i] { (near[i], p, far[j], far[k]) } else { (far[j], far[k], near[i], p) };
                emit_distinct([o, a, b, c], emit);
                emit_distinct([o, a, b, d], emit);
            }
        }
    }
}

/// Subdivision of the polyhedra of a file, in the order of [`CellSet::polyhedra`].
#[derive(Debug, Default)]
pub(super) struct Polyhedra {
    /// By cell number: position in `CellSet::polyhedra`.
    positions: HashMap<u32, usize>,
    /// Point number of every polyhedron's apex; those above the file's points are added.
    apexes: Vec<u32>,
    /// Polyhedra (positions) that have a point in their middle added, in the order of the points' numbers.
    pub added: Vec<usize>,
    /// Polyhedra whose pieces overlap.
    pub overlapping: u64,
    /// Number of the corner from which each face's fan starts, polyhedron after polyhedron.
    fans: Vec<Vec<u16>>,
}

impl Polyhedra {
    /// Looks up the polyhedra of a file and checks their points' numbers.
    pub fn index(set: &CellSet, point_count: usize) -> Result<Polyhedra> {
        let wrong = set.polyhedra.par_iter().find_first(|polyhedron| {
            polyhedron.faces.iter().flatten().any(|&corner| corner as usize >= point_count)
        });
        if let Some(polyhedron) = wrong {
            return Err(Error::run(format!(
                "a face of cell {}, a polyhedron, names a point that does not exist",
                polyhedron.cell
            ))
            .got(polyhedron.faces.iter().flatten().max().copied().unwrap_or(0))
            .expected(format!("a point number below {point_count}")));
        }
        let positions = set.polyhedra.iter().enumerate().map(|(i, p)| (p.cell, i)).collect();
        Ok(Polyhedra { positions, ..Polyhedra::default() })
    }

    /// Decides how each polyhedron is split whose flag among the `drawn` is set, and numbers the added points from `first_free`.
    pub fn choose(
        &mut self,
        set: &CellSet,
        points: &[DVec3],
        drawn: &[bool],
        first_free: usize,
    ) -> Result<()> {
        let choice = |(polyhedron, &drawn): (&Polyhedron, &bool)| {
            if !drawn {
                return (Vec::new(), (Some(0), true));
            }
            let fans: Vec<u16> = polyhedron.faces.iter().map(|face| fan_start(face, points)).collect();
            let apex = apex(polyhedron, &fans, points);
            (fans, apex)
        };
        let apexes: Vec<(Option<u32>, bool)>;
        (self.fans, apexes) = set.polyhedra.par_iter().zip(drawn).map(choice).unzip();
        for (position, (corner, sees_all)) in apexes.into_iter().enumerate() {
            self.overlapping += u64::from(!sees_all);
            let next = first_free + self.added.len();
            if corner.is_none() {
                self.added.push(position);
            }
            self.apexes.push(corner.map_or_else(|| number(next, "polyhedra need too many points", ""), Ok)?);
        }
        Ok(())
    }

    /// The faces of a cell.
    pub fn polyhedron<'a>(&self, set: &'a CellSet, cell: usize) -> Option<&'a Polyhedron> {
        self.positions.get(&(cell as u32)).map(|&position| &set.polyhedra[position])
    }

    /// Hands out the tetrahedra of a cell.
    pub fn tetrahedra(&self, set: &CellSet, cell: usize, emit: &mut impl FnMut([u32; 4])) {
        let Some(&position) = self.positions.get(&(cell as u32)) else { return };
        let apex = self.apexes[position];
        for (face, &start) in set.polyhedra[position].faces.iter().zip(&self.fans[position]) {
            fan(face, start, |[a, b, c]| emit_distinct([apex, a, b, c], emit));
        }
    }
}

/// Corners of a polyhedron, ascending, each once.
pub(super) fn corners(polyhedron: &Polyhedron) -> Vec<u32> {
    let mut corners: Vec<u32> = polyhedron.faces.iter().flatten().copied().collect();
    corners.sort_unstable();
    corners.dedup();
    corners
}

fn fan(face: &[u32], start: u16, mut f: impl FnMut([u32; 3])) {
    let n = face.len();
    let corner = |k: usize| face[(usize::from(start) + k) % n];
    for k in 1..n.saturating_sub(1) {
        f([corner(0), corner(k), corner(k + 1)]);
    }
}

/// First corner of a face's fan: the lowest; for five or more corners the lowest whose fan does not fold over.
fn fan_start(face: &[u32], points: &[DVec3]) -> u16 {
    let lowest = lowest(face);
    let n = face.len();
    if n < 5 {
        return lowest as u16;
    }
    // The neighbour may list the face the other way round and from another corner: go by number, from the lowest
    // corner toward the lower of the corners beside it, so that both compute the same digits.
    let (after, before) = (face[(lowest + 1) % n], face[(lowest + n - 1) % n]);
    let at = |k: usize| if after <= before { (lowest + k) % n } else { (lowest + n * 2 - k) % n };
    let p = |k: usize| points[face[at(k % n)] as usize];
    let area = |start: usize, k: usize| (p(start + k) - p(start)).cross(p(start + k + 1) - p(start));
    let total: DVec3 = (1..n - 1).map(|k| area(0, k)).sum();
    // A sliver of the fan may fold by rounding.
    let tolerance = -1e-9 * total.length_squared();
    let folds = |start: usize| (1..n - 1).any(|k| area(start, k).dot(total) < tolerance);
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_unstable_by_key(|&k| face[at(k)]);
    let start = order.into_iter().find(|&k| !folds(k)).map_or(lowest, at);
    start as u16
}

/// Corner that the triangles are joined to, `None` for the mean of the corners, and true if it sees all of them.
fn apex(polyhedron: &Polyhedron, fans: &[u16], points: &[DVec3]) -> (Option<u32>, bool) {
    let corners = corners(polyhedron);
    let Some(&lowest) = corners.first() else { return (None, true) };
    let origin = points[lowest as usize];
    let at = |p: u32| points[p as usize] - origin;
    let mut oriented = Vec::new();
    let flipped = inward_faces(polyhedron);
    for (i, face) in polyhedron.faces.iter().enumerate() {
        fan(face, fans[i], |[a, b, c]| oriented.push(if flipped[i] { [a, c, b] } else { [a, b, c] }));
    }
    let volume = |from: DVec3, [a, b, c]: [u32; 3]| (at(a) - from).dot((at(b) - from).cross(at(c) - from));
    let total: f64 = oriented.iter().map(|&t| volume(DVec3::ZERO, t)).sum();
    let sign = total.signum();
    // Faces that are not quite plane make pieces that are not quite positive.
    let tolerance = -1e-9 * total.abs();
    let sees_all = |from: DVec3, own: Option<u32>| {
        oriented
            .iter()
            .filter(|t| own.is_none_or(|own| !t.contains(&own)))
            .all(|&t| sign * volume(from, t) >= tolerance)
    };
    if sees_all(DVec3::ZERO, Some(lowest)) {
        return (Some(lowest), true);
    }
    let mean = corners.iter().map(|&c| at(c)).sum::<DVec3>() / corners.len() as f64;
    if sees_all(mean, None) {
        return (None, true);
    }
    let other = corners.into_iter().find(|&c| sees_all(at(c), Some(c)));
    (other, other.is_some())
}

/// Flags of the faces that run the other way round than the first one's neighbours require, so that all turn alike.
fn inward_faces(polyhedron: &Polyhedron) -> Vec<bool> {
    let faces = &polyhedron.faces;
    // (edge, face, whether the face runs along it from the lower to the higher number)
    let mut uses: Vec<((u32, u32), usize, bool)> = Vec::new();
    for (i, face) in faces.iter().enumerate() {
        for k in 0..face.len() {
            let (a, b) = (face[k], face[(k + 1) % face.len()]);
            uses.push(((a.min(b), a.max(b)), i, a < b));
        }
    }
    uses.sort_unstable();
    // The usual case: every edge is used once in each direction.
    if uses.chunks(2).all(|pair| pair.len() == 2 && pair[0].0 == pair[1].0 && pair[0].2 != pair[1].2) {
        return vec![false; faces.len()];
    }
    let mut flipped = vec![None; faces.len()];
    for first in 0..faces.len() {
        if flipped[first].is_some() {
            continue;
        }
        flipped[first] = Some(false);
        let mut open = vec![first];
        while let Some(i) = open.pop() {
            let own = flipped[i].unwrap_or(false);
            for k in 0..faces[i].len() {
                let (a, b) = (faces[i][k], faces[i][(k + 1) % faces[i].len()]);
                let edge = (a.min(b), a.max(b));
                let from = uses.partition_point(|u| u.0 < edge);
                for &(_, other, direction) in uses[from..].iter().take_while(|u| u.0 == edge) {
                    if other != i && flipped[other].is_none() {
                        // Two faces that turn alike run along their edge in opposite directions.
                        flipped[other] = Some(((a < b) == direction) != own);
                        open.push(other);
                    }
                }
            }
        }
    }
    flipped.into_iter().map(|f| f.unwrap_or(false)).collect()
}
