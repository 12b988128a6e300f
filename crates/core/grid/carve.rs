//! Split of a body that is not convex into tetrahedra without touching its surface, so that neighbours still share its triangles.
//!
//! A surface that one point sees whole is joined to it ([`apex`]). For others ([`carve`]) a mesh of a large tetrahedron gets the corners of the
//! surface as points, then points where its faces meet the surface's edges and its edges the surface's triangles, until those are
//! faces of the mesh; what lies outside is dropped. The points that this has put on the surface are taken away again: the tetrahedra around
//! one are replaced by the surface's own triangles there and a point inside that sees all of their hull (P.-L. George, H. Borouchaki,
//! E. Saltel, "'Ultimate' robustness in meshing an arbitrary polyhedron", International Journal for Numerical Methods in Engineering 58,
//! 2003, 1061-1089). Without added points it cannot be done in general (E. Schönhardt 1928).

use super::polygon::{Triangle, clip_ears};
use glam::DVec3;
use std::collections::{BTreeMap, HashMap};

/// Orders in which the corners are taken, at most: rounding may spoil a mesh of thin tetrahedra.
const MAX_ATTEMPTS: u64 = 8;

/// Triangles of a body that is carved, at most: its mesh is searched for each of them.
const MAX_TRIANGLES: usize = 1000;

/// Points of a mesh for each corner of its body, at most: crossings of a sound surface take some dozens, and those of one that crosses itself at an
/// acute angle double the mesh again and again.
const MAX_POINTS_PER_CORNER: usize = 128;

/// Distances within which points of a body of size 1 touch, one after the other tried: coordinates are rounded to 1e-16, and how many digits
/// crossings of planes lose depends on the planes.
const TOUCH: [f64; 4] = [1e-10, 1e-12, 1e-11, 1e-9];

/// Largest part of the volume by which the tetrahedra's sum may miss it: some thousand products rounded to 1e-16.
const MAX_VOLUME_ERROR: f64 = 1e-10;

/// Point that sees a whole surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Apex {
    Corner(u32),
    /// The mean of the corners.
    Mean,
    /// Another point inside.
    Inside(DVec3),
}

/// Tetrahedra of a body; corners that count down from [`Pieces::ADDED`] are the added points.
#[derive(Debug, Default)]
pub(super) struct Pieces {
    /// Four point numbers each.
    pub tetrahedra: Vec<[u32; 4]>,
    /// Corners of the body and their weights that make each added point.
    pub added: Vec<Vec<(u32, f64)>>,
}

impl Pieces {
    /// Stands for added point 0 in place of its number, which is not known yet; the others follow downward.
    pub const ADDED: u32 = u32::MAX;
}

/// Six times the volume of a tetrahedron, positive where `from` lies behind the triangle.
fn volume(from: DVec3, [a, b, c]: [DVec3; 3]) -> f64 {
    (a - from).dot((b - from).cross(c - from))
}

/// Distance of a point behind the plane of a triangle.
fn height(from: DVec3, triangle: [DVec3; 3]) -> f64 {
    let [a, b, c] = triangle;
    volume(from, triangle) / (b - a).cross(c - a).length()
}

/// Distances of a point in the plane of a triangle from its edges, each opposite to a corner, positive inside.
fn edge_distances(point: DVec3, [a, b, c]: [DVec3; 3]) -> [f64; 3] {
    let normal = (b - a).cross(c - a).normalize_or_zero();
    [(b, c), (c, a), (a, b)]
        .map(|(from, to)| (to - from).cross(point - from).dot(normal) / (to - from).length())
}

fn least<const N: usize>(values: [f64; N]) -> f64 {
    values.into_iter().fold(f64::INFINITY, f64::min)
}

/// A triangle is in one plane with a point that is nearer to its plane than this part of the body's size: rounding to 32 bits may
/// put it on either side.
const FLATNESS_TOLERANCE: f64 = 1e-6;

/// Point that sees all triangles of a surface: the corner of lowest number, the mean of the corners, another corner, or a point in the middle of
/// the kernel; `None` where no point does, or too few to find one. `corners`: the surface's, ascending.
///
/// A tetrahedron of a triangle and a point in its plane is flat. In a convex body it lies in a face, in others it may span what is no part of
/// the body.
pub(super) fn apex(surface: &[Triangle], corners: &[u32], at: &impl Fn(u32) -> DVec3) -> Option<Apex> {
    let (&lowest, others) = corners.split_first()?;
    let origin = at(lowest);
    let total: f64 = surface.iter().map(|t| volume(origin, t.map(at))).sum();
    let size = corners.iter().map(|&c| at(c).distance(origin)).fold(0.0, f64::max);
    // Faces that are not quite plane make pieces that are not quite positive.
    let tolerance = -1e-9 * total.abs();
    let is_flat = |from: DVec3, t: &Triangle| {
        let [a, b, c] = t.map(at);
        let area = (b - a).cross(c - a).length();
        area > FLATNESS_TOLERANCE * FLATNESS_TOLERANCE * size * size
            && volume(from, [a, b, c]) < FLATNESS_TOLERANCE * size * area
    };
    let is_convex = std::cell::LazyCell::new(|| {
        let behind = |t: &Triangle| {
            let [a, b, c] = t.map(at);
            let limit = -FLATNESS_TOLERANCE * size * (b - a).cross(c - a).length();
            corners.iter().all(|&corner| volume(at(corner), [a, b, c]) >= limit)
        };
        surface.iter().all(behind)
    });
    let is_seen = |from: DVec3, own: Option<u32>| {
        let apart = || surface.iter().filter(|t| own.is_none_or(|own| !t.contains(&own)));
        apart().all(|t| volume(from, t.map(at)) >= tolerance)
            && (!apart().any(|t| is_flat(from, t)) || *is_convex)
    };
    if is_seen(origin, Some(lowest)) {
        return Some(Apex::Corner(lowest));
    }
    let mean = origin + corners.iter().map(|&c| at(c) - origin).sum::<DVec3>() / corners.len() as f64;
    if is_seen(mean, None) {
        return Some(Apex::Mean);
    }
    if let Some(&other) = others.iter().find(|&&c| is_seen(at(c), Some(c))) {
        return Some(Apex::Corner(other));
    }
    kernel_point(surface, corners, mean, at).filter(|&point| is_seen(point, None)).map(Apex::Inside)
}

/// Point far from the planes of all triangles on their inner sides: moves away from the nearest one in ever shorter steps.
fn kernel_point(
    surface: &[Triangle],
    corners: &[u32],
    mut point: DVec3,
    at: &impl Fn(u32) -> DVec3,
) -> Option<DVec3> {
    let planes: Vec<(DVec3, DVec3)> = surface
        .iter()
        .filter_map(|t| {
            let [a, b, c] = t.map(at);
            Some((a, (c - a).cross(b - a).try_normalize()?))
        })
        .collect();
    let size = corners.iter().map(|&c| at(c).distance(point)).fold(0.0, f64::max);
    let mut step = 0.25 * size;
    let mut best = (0.0, None);
    for _ in 0..200 {
        let heights = planes.iter().map(|&(on, inward)| ((point - on).dot(inward), inward));
        let (height, inward) = heights.min_by(|a, b| a.0.total_cmp(&b.0))?;
        if height > best.0 {
            best = (height, Some(point));
        }
        point += step * inward;
        step *= 0.96;
    }
    best.1
}

/// Weights of the corners that make a point in a body: the mean, over the corners, of the weights in the tetrahedron of a corner and the triangle that it
/// sees behind the point. They are not negative, and exact for linear values.
fn weights(
    surface: &[Triangle],
    corners: &[u32],
    point: DVec3,
    at: &impl Fn(u32) -> DVec3,
) -> Vec<(u32, f64)> {
    let mut sums: Vec<(u32, f64)> = corners.iter().map(|&c| (c, 0.0)).collect();
    let mut count = 0.0;
    for &corner in corners {
        let tetrahedra = surface.iter().filter(|t| !t.contains(&corner)).filter_map(|&t| {
            let [a, b, c] = t.map(at);
            let apex = at(corner);
            let total = volume(apex, [a, b, c]);
            let parts = [
                volume(point, [a, b, c]),
                volume(apex, [point, b, c]),
                volume(apex, [a, point, c]),
                volume(apex, [a, b, point]),
            ];
            let parts = parts.map(|part| part / total);
            let least = parts.into_iter().fold(f64::INFINITY, f64::min);
            (total > 0.0 && least >= -1e-9).then_some((least, t, parts))
        });
        let Some((_, [a, b, c], parts)) = tetrahedra.max_by(|a, b| a.0.total_cmp(&b.0)) else { continue };
        count += 1.0;
        for (vertex, part) in [corner, a, b, c].into_iter().zip(parts) {
            sums[corners.partition_point(|&c| c < vertex)].1 += part.max(0.0);
        }
    }
    sums.iter_mut().for_each(|(_, weight)| *weight /= count);
    sums
}

/// Corners of a surface, ascending, each once.
fn corners_of(surface: &[Triangle]) -> Vec<u32> {
    let mut corners = surface.as_flattened().to_vec();
    corners.sort_unstable();
    corners.dedup();
    corners
}

/// Tetrahedra of the body that a surface encloses, joined to a point that sees all of it.
pub(super) fn join(surface: &[Triangle], apex: Apex, at: impl Fn(u32) -> DVec3) -> Pieces {
    let corners = corners_of(surface);
    let (number, added) = match apex {
        Apex::Corner(corner) => (corner, Vec::new()),
        Apex::Mean => {
            (Pieces::ADDED, vec![corners.iter().map(|&c| (c, 1.0 / corners.len() as f64)).collect()])
        }
        Apex::Inside(point) => (Pieces::ADDED, vec![weights(surface, &corners, point, &at)]),
    };
    let apart = surface.iter().filter(|t| !t.contains(&number));
    Pieces { tetrahedra: apart.map(|&[a, b, c]| [number, a, b, c]).collect(), added }
}

/// Tetrahedra of the body that a surface encloses; `None` where they are not found. `at`: a point's position.
pub(super) fn carve(surface: &[Triangle], at: impl Fn(u32) -> DVec3) -> Option<Pieces> {
    let corners = corners_of(surface);
    let origin = at(*corners.first()?);
    let size = corners.iter().map(|&c| at(c).distance(origin)).fold(0.0, f64::max);
    if surface.len() > MAX_TRIANGLES || !size.is_normal() {
        return None;
    }
    // At size 1 tolerances are lengths and volumes alike. Corners have the first numbers of the mesh, in their order.
    let points: Vec<DVec3> = corners.iter().map(|&c| (at(c) - origin) / size).collect();
    let local = |c: u32| corners.partition_point(|&corner| corner < c) as u32;
    let own: Vec<Triangle> = surface.iter().map(|t| t.map(local)).collect();
    let total: f64 = own.iter().map(|t| volume(DVec3::ZERO, t.map(|p| points[p as usize]))).sum();
    (0..MAX_ATTEMPTS).find_map(|attempt| {
        let mesh = mesh(&own, &points, attempt)?;
        let mut pieces = Pieces::default();
        let mut numbers: HashMap<u32, u32> =
            corners.iter().enumerate().map(|(i, &c)| (i as u32, c)).collect();
        for tetrahedron in &mesh.tetrahedra {
            for p in *tetrahedron {
                numbers.entry(p).or_insert_with(|| {
                    let weights =
                        weights(&own, &own_corners(points.len()), mesh.at(p), &|p| points[p as usize]);
                    pieces.added.push(weights.into_iter().map(|(c, w)| (corners[c as usize], w)).collect());
                    Pieces::ADDED - (pieces.added.len() as u32 - 1)
                });
            }
        }
        let sum: f64 = mesh.tetrahedra.iter().map(|t| mesh.volume(t)).sum();
        pieces.tetrahedra = mesh.tetrahedra.iter().map(|t| t.map(|p| numbers[&p])).collect();
        ((sum - total).abs() <= MAX_VOLUME_ERROR * total.abs()).then_some(pieces)
    })
}

fn own_corners(count: usize) -> Vec<u32> {
    (0..count as u32).collect()
}

/// Faces of a tetrahedron by the places of their corners, counter-clockwise from outside; face i is opposite to corner i.
const FACES: [[usize; 3]; 4] = [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]];

/// Tetrahedra that fill a body, all of positive orientation.
struct Mesh {
    points: Vec<DVec3>,
    tetrahedra: Vec<[u32; 4]>,
    /// Distance within which points touch.
    touch: f64,
    max_points: usize,
}

/// The body's mesh, whose surface is `own`.
fn mesh(own: &[Triangle], points: &[DVec3], attempt: u64) -> Option<Mesh> {
    let count = points.len();
    let touch = TOUCH[attempt as usize % TOUCH.len()];
    let max_points = MAX_POINTS_PER_CORNER * count;
    let mut mesh = Mesh { points: points.to_vec(), tetrahedra: Vec::new(), touch, max_points };
    // A tetrahedron around the ball of radius 1 about the first corner, whose faces are parallel to nothing.
    mesh.points
        .extend([[9.1, 8.3, 7.9], [-8.7, -9.3, 8.1], [-7.7, 8.9, -9.7], [8.3, -7.1, -8.9]].map(DVec3::from));
    mesh.tetrahedra.push([0, 2, 1, 3].map(|i| (count + i) as u32));
    if mesh.volume(&mesh.tetrahedra[0]) < 0.0 {
        mesh.tetrahedra[0].swap(2, 3);
    }
    let mut order: Vec<u32> = own_corners(count);
    // In an order of its own for each attempt.
    order.sort_by_key(|&corner| {
        u64::from(corner + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15_u64.wrapping_mul(2 * attempt + 1))
    });
    order.into_iter().try_for_each(|corner| mesh.insert(corner))?;
    for &[a, b, c] in own {
        [(a, b), (b, c), (c, a)]
            .into_iter()
            .filter(|(p, q)| p < q)
            .try_for_each(|(p, q)| mesh.recover_edge(p, q))?;
    }
    own.iter().try_for_each(|&t| mesh.recover_triangle(t))?;
    let is_inside = |t: &[u32; 4]| {
        let middle: DVec3 = t.iter().map(|&p| mesh.at(p) * 0.25).sum();
        own.iter().map(|t| solid_angle(t.map(|p| mesh.at(p) - middle))).sum::<f64>()
            > 2.0 * std::f64::consts::PI
    };
    let inside = mesh.tetrahedra.iter().copied().filter(is_inside).collect();
    mesh.tetrahedra = inside;
    mesh.clear_surface(own, count)?;
    // Tetrahedra that all turn alike, with no face of more than two and the surface as it should be, fill the body once.
    let is_sound = mesh.tetrahedra.iter().all(|t| mesh.volume(t) > 0.0)
        && sorted_faces(mesh.tetrahedra.iter()).chunk_by(|a, b| a.0 == b.0).all(|same| same.len() <= 2);
    let mut surface: Vec<Triangle> = mesh.surface().into_iter().map(lowest_first).collect();
    let mut wanted: Vec<Triangle> = own.iter().copied().map(lowest_first).collect();
    surface.sort_unstable();
    wanted.sort_unstable();
    (is_sound && surface == wanted).then_some(mesh)
}

fn lowest_first(triangle: Triangle) -> Triangle {
    turned_to(triangle, triangle[0].min(triangle[1]).min(triangle[2]))
}

/// Solid angle of a triangle seen from the origin, positive from behind (A. van Oosterom, J. Strackee 1983).
fn solid_angle([a, b, c]: [DVec3; 3]) -> f64 {
    let [la, lb, lc] = [a, b, c].map(DVec3::length);
    let below = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
    2.0 * a.dot(b.cross(c)).atan2(below)
}

impl Mesh {
    fn at(&self, p: u32) -> DVec3 {
        self.points[p as usize]
    }

    fn volume(&self, &[a, b, c, d]: &[u32; 4]) -> f64 {
        volume(self.at(a), [b, c, d].map(|p| self.at(p)))
    }

    /// Puts a point into the edge, face or tetrahedron of these corners: all around are split.
    fn split(&mut self, simplex: &[u32], point: u32) {
        let mut split = Vec::new();
        self.tetrahedra.retain(|t| {
            let is_around = simplex.iter().all(|p| t.contains(p));
            if is_around {
                split.extend(simplex.iter().map(|p| t.map(|q| if q == *p { point } else { q })));
            }
            !is_around
        });
        self.tetrahedra.append(&mut split);
    }

    /// The new point there; `None` where the mesh has all points that it may have.
    fn split_at(&mut self, simplex: &[u32], position: DVec3) -> Option<u32> {
        let point = self.points.len() as u32;
        if self.points.len() >= self.max_points {
            return None;
        }
        self.points.push(position);
        self.split(simplex, point);
        Some(point)
    }

    /// Makes a point, which lies in the mesh, a corner; `None` where another one is at its place.
    fn insert(&mut self, point: u32) -> Option<()> {
        let position = self.at(point);
        let heights = |t: &[u32; 4]| FACES.map(|face| height(position, face.map(|i| self.at(t[i]))));
        let found = self.tetrahedra.iter().map(|t| (heights(t), *t));
        let (heights, t) = found.max_by(|a, b| least(a.0).total_cmp(&least(b.0)))?;
        let simplex: Vec<u32> =
            t.into_iter().zip(heights).filter(|&(_, h)| h > self.touch).map(|(p, _)| p).collect();
        (simplex.len() > 1).then(|| self.split(&simplex, point))
    }

    /// Makes the way between two points one of edges, with new points where it meets faces and edges.
    fn recover_edge(&mut self, from: u32, to: u32) -> Option<()> {
        let mut from = from;
        let target = self.at(to);
        for _ in 0..self.tetrahedra.len() {
            if self.tetrahedra.iter().any(|t| t.contains(&from) && t.contains(&to)) {
                return Some(());
            }
            let origin = self.at(from);
            let crossing = |t: &[u32; 4]| {
                let own = t.iter().position(|&p| p == from)?;
                let face = FACES[own].map(|i| t[i]);
                let [a, b, c] = face.map(|p| self.at(p));
                let normal = (b - a).cross(c - a);
                let place =
                    origin + (target - origin) * (normal.dot(a - origin) / normal.dot(target - origin));
                (normal.dot(target - origin) > 0.0).then(|| (edge_distances(place, [a, b, c]), face, place))
            };
            let found = self.tetrahedra.iter().filter_map(crossing);
            let (distances, face, place) = found.max_by(|a, b| least(a.0).total_cmp(&least(b.0)))?;
            let simplex: Vec<u32> =
                face.into_iter().zip(distances).filter(|&(_, d)| d > self.touch).map(|(p, _)| p).collect();
            from = match simplex[..] {
                _ if least(distances) < -self.touch => return None,
                [] => return None,
                [corner] => corner,
                _ => self.split_at(&simplex, place)?,
            };
        }
        None
    }

    /// Makes a triangle, whose edges are edges, a union of faces, with new points where edges cross it.
    fn recover_triangle(&mut self, triangle: Triangle) -> Option<()> {
        let corners = triangle.map(|p| self.at(p));
        for _ in 0..64 * self.tetrahedra.len() {
            let crossing = |&[a, b, c, d]: &[u32; 4]| {
                [(a, b), (a, c), (a, d), (b, c), (b, d), (c, d)].into_iter().find_map(|(p, q)| {
                    let [from, to] = [p, q].map(|p| height(self.at(p), corners));
                    let place = self.at(p) + (self.at(q) - self.at(p)) * (from / (from - to));
                    let crosses = from.abs().min(to.abs()) > self.touch && (from > 0.0) != (to > 0.0);
                    (crosses && least(edge_distances(place, corners)) > self.touch).then_some(([p, q], place))
                })
            };
            match self.tetrahedra.iter().find_map(crossing) {
                Some((edge, place)) => self.split_at(&edge, place)?,
                None => return Some(()),
            };
        }
        None
    }

    /// Faces that belong to one tetrahedron.
    fn surface(&self) -> Vec<Triangle> {
        outer(self.tetrahedra.iter())
    }

    /// Takes the points from `count` on away from the surface, and from the inside where the tetrahedra around them do without. `None` where one stays on
    /// the surface.
    fn clear_surface(&mut self, own: &[Triangle], count: usize) -> Option<()> {
        loop {
            let on_surface = self.surface().into_flattened();
            let mut is_changed = false;
            for point in count as u32..self.points.len() as u32 {
                is_changed |= self.remove(point, own, on_surface.contains(&point)).is_some();
            }
            let is_clear = self.surface().as_flattened().iter().all(|&p| (p as usize) < count);
            if !is_changed || is_clear {
                return is_clear.then_some(());
            }
        }
    }

    /// Replaces the tetrahedra around a point by others without it.
    fn remove(&mut self, point: u32, own: &[Triangle], on_surface: bool) -> Option<()> {
        let (around, others): (Vec<[u32; 4]>, Vec<[u32; 4]>) =
            self.tetrahedra.iter().copied().partition(|t| t.contains(&point));
        let (at_point, mut hull): (Vec<Triangle>, Vec<Triangle>) =
            outer(around.iter()).into_iter().partition(|t| t.contains(&point));
        if around.is_empty() {
            return None;
        }
        let mut polygons: BTreeMap<usize, Vec<(u32, u32)>> = BTreeMap::new();
        for face in at_point {
            let [_, from, to] = turned_to(face, point);
            polygons.entry(self.owner(face, own)?).or_default().push((from, to));
        }
        for edges in polygons.into_values() {
            hull.extend(clip_ears(&ring(edges)?, |p| self.at(p))?);
        }
        let edges = |&[a, b, c]: &Triangle| [(a, b), (b, c), (c, a)];
        let mut sides: Vec<(u32, u32)> = hull.iter().flat_map(edges).collect();
        sides.sort_unstable();
        // A face without area leaves a gap.
        if !sides.iter().all(|&(from, to)| sides.binary_search(&(to, from)).is_ok()) {
            return None;
        }
        let corners = corners_of(&hull);
        let sees = |apex: u32| {
            let apart = hull.iter().filter(|t| !t.contains(&apex));
            apart.map(|t| height(self.at(apex), t.map(|p| self.at(p)))).fold(f64::INFINITY, f64::min)
        };
        let best = corners.iter().map(|&c| (sees(c), c)).max_by(|a, b| a.0.total_cmp(&b.0))?;
        let apex = if best.0 > self.touch {
            best.1
        } else if on_surface {
            let mean = corners.iter().map(|&c| self.at(c)).sum::<DVec3>() / corners.len() as f64;
            let inside = kernel_point(&hull, &corners, mean, &|p| self.at(p))?;
            self.points.push(inside);
            self.points.len() as u32 - 1
        } else {
            return None;
        };
        self.tetrahedra = others;
        self.tetrahedra
            .extend(hull.into_iter().filter(|t| !t.contains(&apex)).map(|[a, b, c]| [apex, a, b, c]));
        Some(())
    }

    /// The triangle of the body's surface in which a face lies.
    fn owner(&self, face: Triangle, own: &[Triangle]) -> Option<usize> {
        let corners = face.map(|p| self.at(p));
        let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
        let distance = |triangle: &Triangle| {
            let triangle = triangle.map(|p| self.at(p));
            let apart = corners.iter().map(|&c| height(c, triangle).abs()).fold(0.0, f64::max);
            apart.max(-least(edge_distances(middle, triangle)))
        };
        let distances = own.iter().map(distance).enumerate();
        distances.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(owner, _)| owner)
    }
}

/// Faces that belong to one of these tetrahedra.
fn outer<'a>(tetrahedra: impl Iterator<Item = &'a [u32; 4]>) -> Vec<Triangle> {
    let faces = sorted_faces(tetrahedra);
    faces.chunk_by(|a, b| a.0 == b.0).filter(|same| same.len() == 1).map(|same| same[0].1).collect()
}

/// The faces of tetrahedra, equal ones side by side, each with its corners ascending before it.
fn sorted_faces<'a>(tetrahedra: impl Iterator<Item = &'a [u32; 4]>) -> Vec<([u32; 3], Triangle)> {
    let mut faces: Vec<([u32; 3], Triangle)> = tetrahedra
        .flat_map(|t| FACES.map(|face| face.map(|i| t[i])))
        .map(|face| {
            let mut key = face;
            key.sort_unstable();
            (key, face)
        })
        .collect();
    faces.sort_unstable();
    faces
}

/// The triangle from this corner on.
fn turned_to([a, b, c]: Triangle, first: u32) -> Triangle {
    if first == a {
        [a, b, c]
    } else if first == b {
        [b, c, a]
    } else {
        [c, a, b]
    }
}

/// Points of edges that follow each other, closed or not; `None` where they do not make one line.
fn ring(mut edges: Vec<(u32, u32)>) -> Option<Vec<u32>> {
    let start = edges.iter().position(|&(from, _)| edges.iter().all(|&(_, to)| to != from)).unwrap_or(0);
    let (first, mut last) = edges.swap_remove(start);
    let mut ring = vec![first];
    while last != first {
        ring.push(last);
        let Some(next) = edges.iter().position(|&(from, _)| from == last) else { break };
        last = edges.swap_remove(next).1;
    }
    edges.is_empty().then_some(ring)
}
