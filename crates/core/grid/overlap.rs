//! Cells that overlap: on the same side of a shared face, or with the grid's boundary deep in another cell.
//!
//! Two cells of a grid that fills space once lie on different sides of the face that they share. Cells that are there twice,
//! that are folded over, or that are joined three to a face are found by that. Where two pieces of a grid overlap and share no face,
//! the boundary of one of them lies in the other: tried are the middles of some thousand faces of the boundary. Points at one place
//! count as one, so that pieces that hold the same cells are seen.

use super::faces::{CoincidentPoints, Face, each_face};
use glam::DVec3;
use rayon::prelude::*;

/// A tetrahedron whose height over a face is less than this share of the distance of its fourth corner has no side that
/// rounding could not turn.
const FLATNESS_TOLERANCE: f64 = 1e-9;

/// Boundary faces of a grid, and counts of faces that show overlapping cells.
#[derive(Debug, PartialEq)]
pub(super) struct BoundaryFaces {
    /// The tetrahedra that lie on the same side of a face as another one does, ascending.
    pub overlapping: Vec<u32>,
    /// The faces of one cell alone, the grid's boundary: the cell and the point opposite (the first at its place),
    /// ascending.
    pub boundary: Vec<[u32; 2]>,
}

/// Looks at all faces of tetrahedra (corners ascending).
pub(super) fn faces(points: &[DVec3], tetrahedra: &[[u32; 4]]) -> BoundaryFaces {
    let none = || BoundaryFaces { overlapping: Vec::new(), boundary: Vec::new() };
    let look = |found: &mut BoundaryFaces, p, shared: &[Face]| look_at(points, p, shared, found);
    let mut found =
        each_face(points, tetrahedra, &CoincidentPoints::find(points), none, look, |mut all, mut more| {
            all.overlapping.append(&mut more.overlapping);
            all.boundary.append(&mut more.boundary);
            all
        });
    found.overlapping.par_sort_unstable();
    found.overlapping.dedup();
    found.boundary.par_sort_unstable();
    found
}

/// Adds the cells of a face that lie on one side of it with another one, and the face of one cell.
fn look_at(points: &[DVec3], p: u32, shared: &[Face], found: &mut BoundaryFaces) {
    if let [[_, _, cell, opposite]] = *shared {
        found.boundary.push([cell, opposite]);
        return;
    }
    let [q, r, ..] = shared[0];
    let [origin, q, r] = [points[p as usize], points[q as usize], points[r as usize]];
    let normal = (q - origin).cross(r - origin);
    let side_of = |face: &Face| side(normal, points[face[3] as usize] - origin);
    if let [one, other] = shared
        && side_of(one) != side_of(other)
    {
        return;
    }
    for which in [-1.0, 1.0] {
        let there = shared.iter().filter(|face| side_of(face) == which);
        if there.clone().count() > 1 {
            found.overlapping.extend(there.map(|face| face[2]));
        }
    }
}

/// The side of a face with this normal on which a corner lies, `apart` from a point of the face: 1 or -1; 0 where rounding
/// could turn it.
fn side(normal: DVec3, apart: DVec3) -> f64 {
    let height = normal.dot(apart);
    let is_clear = height.abs() > FLATNESS_TOLERANCE * normal.length() * apart.length();
    if is_clear { height.signum() } else { 0.0 }
}

/// Places that are tried, at most.
const PLACES: usize = 4096;

/// A place lies in a cell where all of its barycentric coordinates are above this: pieces whose cells meet without sharing faces
/// may lie in each other by the rounding of their points, or by as much as their flat faces leave of a curved one.
const MIN_INSIDE_WEIGHT: f64 = 0.05;

/// Bins along an axis: about one place a bin.
const BINS: usize = 16;

/// Cells of a chunk of work.
const CHUNK: usize = 1 << 13;

/// Boundary places in other cells.
#[derive(Debug, Default, PartialEq)]
pub(super) struct BoundaryOverlap {
    /// Places that were tried.
    pub tried: usize,
    /// Places that lie in another cell.
    pub inside: usize,
    /// The first of them, by its cell: the place, its cell, and a cell that it lies in.
    pub first: Option<(DVec3, [u32; 2])>,
}

/// Tries places on the boundary (see [`BoundaryFaces`]) of tetrahedra.
pub(super) fn within(points: &[DVec3], tetrahedra: &[[u32; 4]], boundary: &[[u32; 2]]) -> BoundaryOverlap {
    let corner = |p: u32| points[p as usize];
    let middle = |&[cell, opposite]: &[u32; 2]| {
        let corners = tetrahedra[cell as usize];
        // The opposite corner may be known by another point at its place.
        let face = corners.into_iter().filter(|&p| p != opposite && corner(p) != corner(opposite));
        (face.map(corner).sum::<DVec3>() / 3.0, cell)
    };
    let step = boundary.len().div_ceil(PLACES).max(1);
    let places: Vec<(DVec3, u32)> =
        boundary.iter().step_by(step).map(middle).filter(|(place, _)| place.is_finite()).collect();
    let Some(bins) = PointBins::new(&places) else { return BoundaryOverlap::default() };
    let mut found: Vec<(usize, u32)> = (0..tetrahedra.len() as u32)
        .into_par_iter()
        .with_min_len(CHUNK)
        .fold(Vec::new, |mut found, cell| {
            let corners = tetrahedra[cell as usize].map(corner);
            bins.each_near(corners, &places, |k| {
                if holds(corners, places[k].0) {
                    found.push((k, cell));
                }
            });
            found
        })
        .flatten_iter()
        .collect();
    found.sort_unstable();
    found.dedup_by_key(|(place, _)| *place);
    let first = found.first().map(|&(k, other)| (places[k].0, [places[k].1, other]));
    BoundaryOverlap { tried: places.len(), inside: found.len(), first }
}

/// True if a place lies deep in a tetrahedron.
fn holds([a, b, c, d]: [DVec3; 4], place: DVec3) -> bool {
    let [u, v, w] = [b - a, c - a, d - a];
    let volume = u.dot(v.cross(w));
    let p = place - a;
    let [b, c, d] = [p.dot(v.cross(w)), p.dot(w.cross(u)), p.dot(u.cross(v))].map(|x| x / volume);
    // Not so for a cell without volume, whose quotients are no numbers.
    [1.0 - b - c - d, b, c, d].into_iter().all(|weight| weight > MIN_INSIDE_WEIGHT)
}

/// Places by where they lie.
struct PointBins {
    low: DVec3,
    high: DVec3,
    /// Bins a unit of length.
    scale: DVec3,
    /// Start of each bin's places in `places`; one more entry than bins.
    starts: Vec<usize>,
    places: Vec<usize>,
}

impl PointBins {
    /// `None` without places.
    fn new(places: &[(DVec3, u32)]) -> Option<PointBins> {
        let low = places.iter().map(|place| place.0).reduce(DVec3::min)?;
        let high = places.iter().map(|place| place.0).reduce(DVec3::max)?;
        // A plane of places has one layer of bins.
        let scale = (high - low).to_array().map(|side| if side > 0.0 { BINS as f64 / side } else { 0.0 });
        let mut bins = PointBins { low, high, scale: scale.into(), starts: Vec::new(), places: Vec::new() };
        let mut keyed: Vec<(usize, usize)> = places
            .iter()
            .enumerate()
            .map(|(k, (place, _))| (bins.number(bins.coordinates(*place)), k))
            .collect();
        keyed.sort_unstable();
        let starts = (0..=BINS * BINS * BINS).map(|bin| keyed.partition_point(|(key, _)| *key < bin));
        bins.starts = starts.collect();
        bins.places = keyed.into_iter().map(|(_, k)| k).collect();
        Some(bins)
    }

    fn coordinates(&self, place: DVec3) -> [usize; 3] {
        ((place - self.low) * self.scale).to_array().map(|x| (x as usize).min(BINS - 1))
    }

    fn number(&self, [x, y, z]: [usize; 3]) -> usize {
        (z * BINS + y) * BINS + x
    }

    /// Every place in the box of a tetrahedron.
    fn each_near(&self, corners: [DVec3; 4], places: &[(DVec3, u32)], mut take: impl FnMut(usize)) {
        let [a, b, c, d] = corners;
        let (low, high) = (a.min(b).min(c).min(d), a.max(b).max(c).max(d));
        if low.cmpgt(self.high).any() || high.cmplt(self.low).any() {
            return;
        }
        let (from, to) = (self.coordinates(low.max(self.low)), self.coordinates(high.min(self.high)));
        for z in from[2]..=to[2] {
            for y in from[1]..=to[1] {
                let row = [from[0], to[0]].map(|x| self.number([x, y, z]));
                self.places[self.starts[row[0]]..self.starts[row[1] + 1]]
                    .iter()
                    .filter(|&&k| places[k].0.cmpge(low).all() && places[k].0.cmple(high).all())
                    .for_each(|&k| take(k));
            }
        }
    }
}
