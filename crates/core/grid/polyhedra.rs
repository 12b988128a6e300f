//! Split of polyhedra (VTK type 42) into tetrahedra, so that neighbours share the same triangles.
//!
//! Every face is cut into triangles by its own points and their numbers alone, so that neighbours agree: a fan from its corner of lowest
//! number, else, where that folds over, from the lowest whose fan does not, else, where all do, by ear clipping. The triangles are
//! then joined to a point that sees all of them: the corner of lowest number if it does (in a convex cell it always
//! does), else the mean of the corners (an added point, which carries the mean of their values), else the first other corner that
//! does, else a point of the kernel. Where none does, the cell is carved ([`super::carve`]). A cell that cannot be split
//! without filling what is not its own is left out and counted.

use super::carve::{Apex, Pieces, apex, carve, join};
use super::cell_set::{CellSet, Polyhedron};
use super::parts::number;
use super::polygon::{Triangle, clip_ears, fan, fan_start};
use super::split::emit_distinct;
use crate::{Error, Result, counted};
use glam::DVec3;
use rayon::prelude::*;
use std::collections::{BTreeMap, HashMap};

/// Part of a surface by which its triangles may fail to close it: positions of 32 bits on edges that one face has in two parts.
const MAX_GAP: f64 = 1e-6;

/// Reasons why a polyhedron is left out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Defect {
    /// Triangles of the faces leave a gap.
    Open,
    /// A face's edges cross or touch each other.
    CrossedFace,
    /// No split was found.
    NotSplit,
}

impl Defect {
    fn reason(self) -> &'static str {
        match self {
            Defect::Open => "the faces do not enclose a volume (is a face missing?)",
            Defect::CrossedFace => "the edges of a face cross or touch each other",
            Defect::NotSplit => {
                "no split into tetrahedra was found that stays inside (do faces cross? Else cut them into convex cells)"
            }
        }
    }
}

#[derive(Debug)]
enum Split {
    /// Not at all: left out, or not drawn for another reason.
    None,
    /// Its faces, each a fan from one of its corners, are joined to a point.
    Star { apex: u32, fans: Vec<u16> },
    /// Into these tetrahedra.
    Pieces(Vec<[u32; 4]>),
}

/// Split of a polyhedron before the added points have numbers.
enum UnnumberedSplit {
    NotDrawn,
    Defect(Defect),
    /// Joined to a corner, or (`None`) to the mean of the corners.
    Star(Option<u32>, Vec<u16>),
    Pieces(Pieces),
}

/// Source of an added point: the mean of the corners of a polyhedron (its position), or corners and their weights.
#[derive(Debug)]
pub(super) enum Added {
    Mean(usize),
    Weights(Vec<(u32, f64)>),
}

/// Subdivision of the polyhedra of a file, in the order of [`CellSet::polyhedra`].
#[derive(Debug, Default)]
pub(super) struct Polyhedra {
    /// By cell number: position in `CellSet::polyhedra`.
    positions: HashMap<u32, usize>,
    splits: Vec<Split>,
    /// The added points, in the order of their numbers, which follow the file's.
    pub added: Vec<Added>,
    /// Polyhedra that are left out: their cells' numbers.
    left_out: BTreeMap<Defect, Vec<u32>>,
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
        let splits: Vec<UnnumberedSplit> = set
            .polyhedra
            .par_iter()
            .zip(drawn)
            .map(
                |(polyhedron, &drawn)| {
                    if drawn { unnumbered_split(polyhedron, points) } else { UnnumberedSplit::NotDrawn }
                },
            )
            .collect();
        let free = |added: usize| number(first_free + added, "polyhedra need too many points", "");
        for (position, split) in splits.into_iter().enumerate() {
            self.splits.push(match split {
                UnnumberedSplit::NotDrawn => Split::None,
                UnnumberedSplit::Defect(defect) => {
                    self.left_out.entry(defect).or_default().push(set.polyhedra[position].cell);
                    Split::None
                }
                UnnumberedSplit::Star(Some(apex), fans) => Split::Star { apex, fans },
                UnnumberedSplit::Star(None, fans) => {
                    let apex = free(self.added.len())?;
                    self.added.push(Added::Mean(position));
                    Split::Star { apex, fans }
                }
                UnnumberedSplit::Pieces(Pieces { mut tetrahedra, added }) => {
                    let first = self.added.len();
                    let last = free(first + added.len())?;
                    for corner in tetrahedra.as_flattened_mut() {
                        let index = Pieces::ADDED - *corner;
                        if (index as usize) < added.len() {
                            *corner = last - (added.len() as u32 - index);
                        }
                    }
                    self.added.extend(added.into_iter().map(Added::Weights));
                    Split::Pieces(tetrahedra)
                }
            });
        }
        Ok(())
    }

    /// Leaves cells that count elsewhere out of the warnings.
    pub fn retain_left_out(&mut self, counts: impl Fn(u32) -> bool) {
        self.left_out.values_mut().for_each(|cells| cells.retain(|&cell| counts(cell)));
        self.left_out.retain(|_, cells| !cells.is_empty());
    }

    /// True if this polyhedron cannot be split.
    pub fn is_left_out(&self, cell: usize) -> bool {
        let split = self.positions.get(&(cell as u32)).and_then(|&position| self.splits.get(position));
        matches!(split, Some(Split::None))
    }

    /// Warnings of polyhedra that are left out, one for each reason. `number`: of a cell, for people.
    pub fn warnings(&self, number: impl Fn(u32) -> u64) -> impl Iterator<Item = String> {
        self.left_out.iter().map(move |(defect, cells)| {
            let (count, first, why) = (cells.len() as u64, number(cells[0]), defect.reason());
            match count {
                1 => format!("1 polyhedron was left out, cell {first}: {why}."),
                _ => format!(
                    "{} were left out, the first is cell {first}: {why}.",
                    counted(count, "polyhedron")
                ),
            }
        })
    }

    /// The faces of a cell.
    pub fn polyhedron<'a>(&self, set: &'a CellSet, cell: usize) -> Option<&'a Polyhedron> {
        self.positions.get(&(cell as u32)).map(|&position| &set.polyhedra[position])
    }

    pub fn tetrahedra(&self, set: &CellSet, cell: usize, emit: &mut impl FnMut([u32; 4])) {
        let Some(&position) = self.positions.get(&(cell as u32)) else { return };
        match &self.splits[position] {
            Split::None => {}
            Split::Star { apex, fans } => {
                for (face, &start) in set.polyhedra[position].faces.iter().zip(fans) {
                    fan(face, start, |[a, b, c]| emit_distinct([*apex, a, b, c], emit));
                }
            }
            Split::Pieces(tetrahedra) => tetrahedra.iter().for_each(|&t| emit_distinct(t, emit)),
        }
    }
}

/// Split of a polyhedron, before the added points have numbers.
fn unnumbered_split(polyhedron: &Polyhedron, points: &[DVec3]) -> UnnumberedSplit {
    let corners = corners(polyhedron);
    let Some(&lowest) = corners.first() else { return UnnumberedSplit::Defect(Defect::Open) };
    let origin = points[lowest as usize];
    let at = |p: u32| points[p as usize] - origin;
    let mut surface: Vec<Triangle> = Vec::new();
    let mut fans = Some(Vec::new());
    for (face, flipped) in polyhedron.faces.iter().zip(inward_faces(polyhedron)) {
        let first = surface.len();
        let start = fan_start(face, points);
        match start {
            Some(start) => fan(face, start, |triangle| surface.push(triangle)),
            None => match clip_ears(face, at) {
                Some(triangles) => surface.extend(triangles),
                None => return UnnumberedSplit::Defect(Defect::CrossedFace),
            },
        }
        fans = fans.zip(start).map(|(mut fans, start)| {
            fans.push(start);
            fans
        });
        if flipped {
            surface[first..].iter_mut().for_each(|t| t.swap(1, 2));
        }
    }
    let areas = || surface.iter().map(|t| t.map(at)).map(|[a, b, c]| (b - a).cross(c - a));
    if areas().sum::<DVec3>().length() > MAX_GAP * areas().map(DVec3::length).sum::<f64>() {
        return UnnumberedSplit::Defect(Defect::Open);
    }
    let volume: f64 = surface.iter().map(|t| t.map(at)).map(|[a, b, c]| a.dot(b.cross(c))).sum();
    if volume < 0.0 {
        surface.iter_mut().for_each(|t| t.swap(1, 2));
    }
    match (apex(&surface, &corners, &at), fans) {
        (Some(Apex::Corner(corner)), Some(fans)) => UnnumberedSplit::Star(Some(corner), fans),
        (Some(Apex::Mean), Some(fans)) => UnnumberedSplit::Star(None, fans),
        (Some(apex), _) => UnnumberedSplit::Pieces(join(&surface, apex, at)),
        (None, _) => {
            carve(&surface, at).map_or(UnnumberedSplit::Defect(Defect::NotSplit), UnnumberedSplit::Pieces)
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
