//! Triangles whose points lie on edges of a grid's tetrahedra or at its points: any point array of the grid can be carried over.

use super::extent;
use glam::DVec3;
use rayon::prelude::*;
use std::ops::{Add, Mul, Sub};

/// A point on an edge of a tetrahedron.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EdgePoint {
    /// Points of the grid, ascending; twice the same: at that point.
    pub ends: [u32; 2],
    /// Share of the way from the first to the second.
    pub share: f64,
}

/// Triangles that turn counter-clockwise as seen from outside, each point once.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct GridSurface {
    /// The points.
    pub points: Vec<EdgePoint>,
    /// Three points each.
    pub triangles: Vec<[u32; 3]>,
}

impl EdgePoint {
    /// Value there from those at the ends, linear between them.
    pub fn value<T>(&self, at: impl Fn(u32) -> T) -> T
    where
        T: Copy + Add<Output = T> + Sub<Output = T> + Mul<f64, Output = T>,
    {
        let [a, b] = self.ends.map(at);
        if self.share == 0.0 { a } else { a + (b - a) * self.share }
    }
}

/// The points of triangles or tetrahedra by their keys, each once and in the order of the keys, and the corners by their numbers.
/// `share`: that of the way along an edge.
pub(super) fn numbered<const N: usize>(
    cells: &[[u64; N]],
    share: impl Fn([u32; 2]) -> f64 + Sync,
) -> (Vec<EdgePoint>, Vec<[u32; N]>) {
    let mut keys = cells.as_flattened().to_vec();
    keys.par_sort_unstable();
    keys.dedup();
    let number = |key: &u64| keys.partition_point(|other| other < key) as u32;
    let cells = cells.par_iter().map(|corners| corners.each_ref().map(number)).collect();
    let point = |&key: &u64| {
        let ends = [(key >> 32) as u32, key as u32];
        EdgePoint { ends, share: share(ends) }
    };
    (keys.par_iter().map(point).collect(), cells)
}

/// The key of a point on an edge of these ends.
pub(super) fn edge_key([a, b]: [u32; 2]) -> u64 {
    u64::from(a) << 32 | u64::from(b)
}

impl GridSurface {
    /// Triangles of points by their keys. `share`: that of the way along an edge.
    pub(super) fn of_keys(triangles: &[[u64; 3]], share: impl Fn([u32; 2]) -> f64 + Sync) -> GridSurface {
        let (points, triangles) = numbered(triangles, share);
        GridSurface { points, triangles }
    }

    /// Adds the triangles of another one; points are not joined.
    pub fn append(&mut self, other: GridSurface) {
        let before = self.points.len() as u32;
        self.points.extend(other.points);
        self.triangles.extend(other.triangles.into_iter().map(|corners| corners.map(|p| before + p)));
    }

    /// Positions of the points, from those of the grid's.
    pub fn positions(&self, points: &[DVec3]) -> Vec<DVec3> {
        self.points.par_iter().map(|point| point.value(|p| points[p as usize])).collect()
    }

    /// Values at the points, from one at each point of the grid: linear on edges.
    pub fn values(&self, values: &[f64]) -> Vec<f64> {
        self.points.par_iter().map(|point| point.value(|p| values[p as usize])).collect()
    }
}

/// A normal of each triangle, as long as its area in units that keep squares in the number range; 0 of one without area.
pub(super) fn area_vectors(points: &[DVec3], triangles: &[[u32; 3]]) -> Vec<DVec3> {
    // Squares of tiny or huge lengths leave the range of 64 bits.
    let diagonal = extent::bounds(points).map_or(0.0, extent::diagonal);
    let scale = if diagonal > 0.0 { 1.0 / diagonal } else { 1.0 };
    let area = |corners: &[u32; 3]| {
        let [a, b, c] = corners.map(|p| points[p as usize]);
        ((b - a) * scale).cross((c - a) * scale)
    };
    triangles.par_iter().with_min_len(1 << 13).map(area).collect()
}

/// Unit normals of the points of triangles: the sum of the area vectors of those around each (Max 1999, Weights for computing vertex
/// normals, Journal of Graphics Tools 4(2), lists it as the weight by area). Where they cancel, that of one of them.
pub fn point_normals(points: &[DVec3], triangles: &[[u32; 3]]) -> Vec<DVec3> {
    let areas = area_vectors(points, triangles);
    let mut sums = vec![DVec3::ZERO; points.len()];
    for (corners, area) in triangles.iter().zip(&areas) {
        corners.iter().for_each(|&p| sums[p as usize] += *area);
    }
    let unit =
        |sum: DVec3| if sum == DVec3::ZERO { sum } else { (sum / sum.abs().max_element()).normalize() };
    let mut normals: Vec<DVec3> = sums.into_iter().map(unit).collect();
    for (corners, area) in triangles.iter().zip(areas) {
        for &p in corners {
            if normals[p as usize] == DVec3::ZERO {
                normals[p as usize] = unit(area);
            }
        }
    }
    // Points of no area are not drawn.
    normals.iter_mut().filter(|normal| **normal == DVec3::ZERO).for_each(|normal| *normal = DVec3::Z);
    normals
}
