//! Extents of points and values.

use crate::{Error, Result};
use glam::DVec3;
use rayon::prelude::*;
use std::ops::RangeInclusive;

/// Points or values of one task: enough that handing it out costs nothing.
const CHUNK: usize = 1 << 14;

/// Lowest and highest coordinates of the finite points; `None` where there is none.
pub fn bounds(points: &[DVec3]) -> Option<[DVec3; 2]> {
    let none = || [DVec3::INFINITY, DVec3::NEG_INFINITY];
    let join = |a: [DVec3; 2], b: [DVec3; 2]| [a[0].min(b[0]), a[1].max(b[1])];
    let of = |chunk: &[DVec3]| {
        let [mut low, mut high] = none();
        for &point in chunk.iter().filter(|point| point.is_finite()) {
            (low, high) = (low.min(point), high.max(point));
        }
        [low, high]
    };
    let found = points.par_chunks(CHUNK).map(of).reduce(none, join);
    (found[0].x <= found[1].x).then_some(found)
}

/// The eight corners of a box.
pub fn corners([low, high]: [DVec3; 2]) -> [DVec3; 8] {
    std::array::from_fn(|corner| {
        DVec3::from([0, 1, 2].map(|axis| if corner >> axis & 1 == 1 { high[axis] } else { low[axis] }))
    })
}

/// The box around two boxes, where there are such.
pub fn joined(one: Option<[DVec3; 2]>, other: Option<[DVec3; 2]>) -> Option<[DVec3; 2]> {
    match (one, other) {
        (Some([a, b]), Some([low, high])) => Some([a.min(low), b.max(high)]),
        (one, other) => one.or(other),
    }
}

/// Diagonal of a box; 0 without extent, not finite where that is beyond 64-bit floats.
pub fn diagonal([low, high]: [DVec3; 2]) -> f64 {
    let sides = high - low;
    let largest = sides.max_element();
    // Scaled, since squares of 1e-200 or 1e200 leave the range of f64.
    if largest > 0.0 { (sides / largest).length() * largest } else { 0.0 }
}

/// The length that engines measure in, world units: the diagonal of the points' box; 1 where it has no extent.
///
/// Errors: an extent whose volumes leave the range of 64-bit floats.
pub fn scene_length(bounds: Option<[DVec3; 2]>) -> Result<f64> {
    const EXTENTS: RangeInclusive<f64> = 1e-90..=1e90;
    match bounds.map_or(0.0, diagonal) {
        0.0 => Ok(1.0),
        diagonal if EXTENTS.contains(&diagonal) => Ok(diagonal),
        diagonal => {
            Err(Error::run("the volumes of cells in a grid of this extent leave the range of 64-bit floats")
                .got(format_args!("a diagonal of {diagonal:e}"))
                .expected("coordinates in another unit, for a diagonal of 1e-90 to 1e90"))
        }
    }
}

/// Smallest and largest finite value; `None` where there is none.
pub fn range(values: &[f64]) -> Option<[f64; 2]> {
    let none = || [f64::INFINITY, f64::NEG_INFINITY];
    let join = |a: [f64; 2], b: [f64; 2]| [a[0].min(b[0]), a[1].max(b[1])];
    let of = |chunk: &[f64]| chunk.iter().filter(|v| v.is_finite()).fold(none(), |all, &v| join(all, [v, v]));
    let [low, high] = match values.len() {
        ..=CHUNK => of(values),
        _ => values.par_chunks(CHUNK).map(of).reduce(none, join),
    };
    (low <= high).then_some([low, high])
}

/// Height of a tetrahedron over each of its faces by its longest edge below which it is thin.
const THIN_CELL: f64 = 1e-3;

/// Positions of the four corners of a tetrahedron: one by one, since a closure over an array is not always inlined.
#[inline]
pub fn corners_of(points: &[DVec3], [a, b, c, d]: [u32; 4]) -> [DVec3; 4] {
    [points[a as usize], points[b as usize], points[c as usize], points[d as usize]]
}

/// The longest edge of all tetrahedra, and of those that are thin; 0 of none.
pub fn longest_edges(points: &[DVec3], tetrahedra: &[[u32; 4]]) -> [f64; 2] {
    let max = |a: [f64; 2], b: [f64; 2]| [a[0].max(b[0]), a[1].max(b[1])];
    let of = |cells: &[[u32; 4]]| {
        let mut longest = [0.0; 2];
        for &cell in cells {
            longest = max(longest, longest_edges_of_cell(corners_of(points, cell)));
        }
        longest
    };
    tetrahedra.par_chunks(CHUNK).map(of).reduce(|| [0.0; 2], max)
}

/// The longest edge of a tetrahedron as one of all, and as one of those that are thin, 0 where it is not; see [`longest_edges`].
#[inline]
pub fn longest_edges_of_cell(corners: [DVec3; 4]) -> [f64; 2] {
    let [a, b, c, d] = corners;
    let [e, f, g] = [b - a, c - a, d - a];
    let longest = longest_edge_squared(corners).sqrt();
    let thin_volume = e.dot(f.cross(g)).abs() / (THIN_CELL * longest);
    // Twice the largest face is at most the square of the longest edge: few cells need more than that.
    if thin_volume >= longest * longest {
        return [longest, 0.0];
    }
    let area = [e.cross(f), e.cross(g), f.cross(g), (c - b).cross(d - b)];
    let area = area.into_iter().map(|normal| normal.length_squared()).fold(0.0, f64::max).sqrt();
    [longest, if thin_volume < area { longest } else { 0.0 }]
}

/// Square of the longest edge of a tetrahedron.
pub fn longest_edge_squared(corners: [DVec3; 4]) -> f64 {
    let edge = |i: usize, j: usize| corners[i].distance_squared(corners[j]);
    edge(0, 1).max(edge(0, 2)).max(edge(0, 3)).max(edge(1, 2)).max(edge(1, 3)).max(edge(2, 3))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_finite_reaches_nowhere() {
        let [a, b] = [DVec3::new(1.0, -2.0, 3.0), DVec3::new(-1.0, 2.0, 3.0)];
        let points = [DVec3::splat(f64::NAN), a, DVec3::new(0.0, f64::INFINITY, 0.0), b];
        assert_eq!(bounds(&points), Some([DVec3::new(-1.0, -2.0, 3.0), DVec3::new(1.0, 2.0, 3.0)]));
        assert_eq!(bounds(&points[..1]), None);
        assert_eq!(range(&[f64::NAN, 2.0, f64::NEG_INFINITY, -1.0]), Some([-1.0, 2.0]));
        assert_eq!(range(&[f64::NAN]), None);
        // More than one task has.
        let many: Vec<f64> = (0..100_000).map(|i| f64::from((i * 7919) % 100_003)).collect();
        let largest = many.iter().copied().fold(0.0, f64::max);
        assert_eq!(range(&many), Some([0.0, largest]));
    }

    #[test]
    fn a_box_has_a_length_at_any_scale_whose_volumes_are_numbers() {
        let of = |scale: f64| [DVec3::ONE * scale, DVec3::new(4.0, 5.0, 13.0) * scale];
        for scale in [1.0, 1e-90, 1e88] {
            let length = scene_length(Some(of(scale))).expect("within the range");
            // Two roundings of the scaling and one of the root.
            assert!((length / (13.0 * scale) - 1.0).abs() < 1e-14, "{length} at {scale}");
        }
        assert_eq!(scene_length(None).ok(), Some(1.0));
        assert_eq!(scene_length(Some([DVec3::ONE; 2])).ok(), Some(1.0));
        for scale in [1e-92, 1e90, 1e200] {
            assert!(scene_length(Some(of(scale))).is_err(), "{scale}");
        }
        assert!(scene_length(Some([DVec3::splat(-1.7e308), DVec3::splat(1.7e308)])).is_err());
    }
}
