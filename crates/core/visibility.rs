//! Visibility order of whole cells, by their centroids: an approximation.
//!
//! An exact order of whole cells need not exist: cells may hide each other in a cycle. The exact order is made by compositors, pixel by pixel.

use crate::Result;
use crate::camera::{Camera, Projection};
use glam::DVec3;
use rayon::prelude::*;

/// The cells in the order of the distance of their centroids from the eye (perspective) or of their centroids'
/// depth (parallel rays), nearest first; cells at equal distance stay in the order given.
///
/// `tetrahedra` and `points` as in [`crate::grid::Grid`]; `cells` are indices of `tetrahedra`.
///
/// # Errors
/// - a camera without a direction.
pub fn centroid_order(
    points: &[DVec3],
    tetrahedra: &[[u32; 4]],
    cells: &[u32],
    camera: &Camera,
) -> Result<Vec<u32>> {
    let forward = camera.frame()?.forward;
    let perspective = matches!(camera.projection, Projection::Perspective { .. });
    let distance = |cell: u32| {
        // Four times the centroid, relative to the eye, so that coordinates far from the origin lose no digits.
        let sum: DVec3 = tetrahedra[cell as usize].iter().map(|&p| points[p as usize] - camera.eye).sum();
        if perspective { sum.length() } else { sum.dot(forward) }
    };
    let mut keyed: Vec<(f64, u32)> = cells.par_iter().map(|&cell| (distance(cell), cell)).collect();
    keyed.par_sort_by(|a, b| a.0.total_cmp(&b.0));
    Ok(keyed.into_iter().map(|(_, cell)| cell).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cells_at(places: &[DVec3]) -> (Vec<DVec3>, Vec<[u32; 4]>) {
        let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
        let points = places.iter().flat_map(|place| corners.map(|corner| *place + corner * 0.1)).collect();
        let cells = (0..places.len() as u32).map(|k| [4 * k, 4 * k + 1, 4 * k + 2, 4 * k + 3]).collect();
        (points, cells)
    }

    fn order(places: &[DVec3], projection: Projection) -> Vec<u32> {
        let (points, tetrahedra) = cells_at(places);
        let camera = Camera {
            eye: DVec3::new(9.0, 0.0, 0.0),
            target: DVec3::ZERO,
            up: DVec3::Z,
            projection,
            near: 0.0,
            size: [8, 8],
            samples: 1,
        };
        let all: Vec<u32> = (0..places.len() as u32).collect();
        centroid_order(&points, &tetrahedra, &all, &camera).unwrap()
    }

    const PERSPECTIVE: Projection = Projection::Perspective { fov_y: 30.0 };
    const PARALLEL: Projection = Projection::Orthographic { height: 2.0 };

    /// Four cells along x, seen from the far end: the order is reversed; with parallel rays likewise.
    #[test]
    fn nearer_centroids_come_first() {
        let row: Vec<DVec3> = (0..4).map(|k| DVec3::X * f64::from(k)).collect();
        for projection in [PERSPECTIVE, PARALLEL] {
            assert_eq!(order(&row, projection), [3, 2, 1, 0]);
        }
    }

    /// At a depth of 5 far beside the axis, and at 6 on it: parallel rays meet the first sooner, an eye is nearer to the second.
    #[test]
    fn an_eye_measures_distance_and_parallel_rays_depth() {
        let places = [DVec3::new(4.0, 5.0, 0.0), DVec3::new(3.0, 0.0, 0.0)];
        assert_eq!(order(&places, PARALLEL), [0, 1]);
        assert_eq!(order(&places, PERSPECTIVE), [1, 0]);
    }

    /// Enough cells that the sort does not end as an insertion sort.
    #[test]
    fn cells_at_one_distance_stay_in_the_order_given() {
        let places: Vec<DVec3> = (0..4000).map(|k| DVec3::X * f64::from(k % 3)).collect();
        let expected: Vec<u32> = (0..3).rev().flat_map(|x| (0..4000).filter(move |k| k % 3 == x)).collect();
        for projection in [PERSPECTIVE, PARALLEL] {
            assert_eq!(order(&places, projection), expected);
        }
    }
}
