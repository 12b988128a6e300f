//! Feature edges of triangles: where their normals turn by more than an angle, and where the triangles end; and normals that are
//! averaged between such edges, so that these stay sharp.

use super::faces::CoincidentPoints;
use super::grid_surface::{area_vectors, averaged_normals};
use glam::DVec3;
use rayon::prelude::*;

/// A side of a triangle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Side {
    /// First points at the places of its ends, ascending.
    ends: [u32; 2],
    triangle: u32,
    /// The corner of the triangle where it begins.
    first_corner: u32,
    /// True if the triangle goes from the second end to the first.
    is_reversed: bool,
}

/// Edges where the normals of two triangles turn by more than `angle` degrees, and those of one triangle or of three and more: the
/// points of each, ascending, each edge once. Points at one place count as the first of them. A triangle without area has no angle with
/// its neighbours. Triangles may turn either way round.
pub fn feature_edges(points: &[DVec3], triangles: &[[u32; 3]], angle: f64) -> Vec<[u32; 2]> {
    let sides = sides(points, triangles);
    let areas = area_vectors(points, triangles);
    let is_feature = |shared: &&[Side]| is_feature(shared, &areas, angle);
    sides.chunk_by(|a, b| a.ends == b.ends).filter(is_feature).map(|shared| shared[0].ends).collect()
}

/// Triangles whose points are apart along feature edges.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SharpTriangles {
    /// For each point the one at its place that it was made from.
    pub origins: Vec<u32>,
    /// Three points each.
    pub triangles: Vec<[u32; 3]>,
    /// Unit normals of the points, see [`super::point_normals`].
    pub normals: Vec<DVec3>,
}

/// Triangles with normals that are averaged over those around a point that no feature edge parts; see [`feature_edges`].
pub fn sharp_triangles(points: &[DVec3], triangles: &[[u32; 3]], angle: f64) -> SharpTriangles {
    let areas = area_vectors(points, triangles);
    let mut groups = Groups((0..3 * triangles.len() as u32).collect());
    for shared in sides(points, triangles).chunk_by(|a, b| a.ends == b.ends) {
        if let [one, other] = *shared
            && !is_feature(shared, &areas, angle)
        {
            for (a, b) in one.corners().into_iter().zip(other.corners()) {
                groups.join(a, b);
            }
        }
    }
    let corners: Vec<[u32; 3]> = (0..triangles.len() as u32)
        .map(|triangle| [0, 1, 2].map(|k| groups.root(3 * triangle + k)))
        .collect();
    let normals = averaged_normals(&areas, &corners, 3 * triangles.len());
    // A group may have several points at one place.
    let key = |(root, p): (&u32, &u32)| (*root, *p);
    let keys: Vec<(u32, u32)> =
        corners.as_flattened().iter().zip(triangles.as_flattened()).map(key).collect();
    let mut own = keys.clone();
    own.par_sort_unstable();
    own.dedup();
    let number = |key: &(u32, u32)| own.partition_point(|other| other < key) as u32;
    SharpTriangles {
        origins: own.iter().map(|&(_, p)| p).collect(),
        triangles: keys.as_chunks().0.iter().map(|corners: &[_; 3]| corners.each_ref().map(number)).collect(),
        normals: own.iter().map(|&(root, _)| normals[root as usize]).collect(),
    }
}

/// Disjoint sets of corners, by a corner of the same set that is no higher (Galler and Fischer 1964).
struct Groups(Vec<u32>);

impl Groups {
    /// The lowest corner of the set.
    fn root(&mut self, corner: u32) -> u32 {
        let mut at = corner;
        while self.0[at as usize] != at {
            // Halves the way of the next one.
            self.0[at as usize] = self.0[self.0[at as usize] as usize];
            at = self.0[at as usize];
        }
        at
    }

    fn join(&mut self, a: u32, b: u32) {
        let [a, b] = [self.root(a), self.root(b)];
        self.0[a.max(b) as usize] = a.min(b);
    }
}

impl Side {
    /// Numbers of the corners at its ends among those of all triangles.
    fn corners(&self) -> [u32; 2] {
        let [from, to] = [0, 1].map(|k| 3 * self.triangle + (self.first_corner + k) % 3);
        if self.is_reversed { [to, from] } else { [from, to] }
    }
}

/// The sides of all triangles, those at one place side by side.
fn sides(points: &[DVec3], triangles: &[[u32; 3]]) -> Vec<Side> {
    let places = CoincidentPoints::find(points);
    let of_triangle = |(corners, triangle): (&[u32; 3], u32)| {
        let [a, b, c] = corners.map(|p| places.first(p));
        [(0, a, b), (1, b, c), (2, c, a)].map(|(first_corner, from, to)| Side {
            ends: [from.min(to), from.max(to)],
            triangle,
            first_corner,
            is_reversed: from > to,
        })
    };
    let mut sides: Vec<Side> = triangles.iter().zip(0..).flat_map(of_triangle).collect();
    sides.retain(|side| side.ends[0] != side.ends[1]);
    sides.par_sort_unstable();
    sides
}

/// True if the triangles that share a side make a feature edge of it.
fn is_feature(shared: &[Side], areas: &[DVec3], angle: f64) -> bool {
    let [one, other] = *shared else { return true };
    let [m, n] = [one, other].map(|side| areas[side.triangle as usize]);
    // Two that go along their side the same way turn opposite ways round.
    let n = if one.is_reversed == other.is_reversed { -n } else { n };
    let turn = m.cross(n).length().atan2(m.dot(n));
    m != DVec3::ZERO && n != DVec3::ZERO && turn > angle.to_radians()
}
