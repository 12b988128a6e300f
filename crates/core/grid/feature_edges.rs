//! Feature edges of triangles: where their normals turn by more than an angle, and where the triangles end.

use super::faces::CoincidentPoints;
use super::grid_surface::area_vectors;
use glam::DVec3;
use rayon::prelude::*;

/// A side of a triangle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Side {
    /// First points at the places of its ends, ascending.
    ends: [u32; 2],
    triangle: u32,
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

/// The sides of all triangles, those at one place side by side.
fn sides(points: &[DVec3], triangles: &[[u32; 3]]) -> Vec<Side> {
    let places = CoincidentPoints::find(points);
    let of_triangle = |(corners, triangle): (&[u32; 3], u32)| {
        let [a, b, c] = corners.map(|p| places.first(p));
        [[a, b], [b, c], [c, a]].map(|[from, to]| Side {
            ends: [from.min(to), from.max(to)],
            triangle,
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
