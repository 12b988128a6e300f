//! Visibility: orders of cells.
//!
//! A cell order can only approximate the order of the segments at a pixel (no order of whole cells exists where
//! they hide each other in a cycle). The exact order is carried out by the compositor, pixel by pixel; the order
//! here is what `order = "centroid"` asks for, for comparison and for speed.

use crate::Result;
use crate::camera::{Camera, Projection};
use glam::DVec3;
use rayon::prelude::*;

/// The cells in the order of the distance of their centroids from the eye (perspective) or of their centroids'
/// depth (parallel rays), nearest first; cells at equal distance stay in the order given.
///
/// `tetrahedra` and `points` as in [`crate::grid::Grid`]; `cells` are numbers of tetrahedra.
pub fn centroid_order(
    points: &[DVec3],
    tetrahedra: &[[u32; 4]],
    cells: &[u32],
    camera: &Camera,
) -> Result<Vec<u32>> {
    let forward = camera.frame()?.forward;
    let perspective = matches!(camera.projection, Projection::Perspective { .. });
    let distance = |cell: u32| {
        // Four times the centroid, relative to the eye: an offset of the coordinates costs no digits.
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

    /// Four cells along x, seen from the far end: the order is reversed; with parallel rays likewise.
    #[test]
    fn nearer_centroids_come_first() {
        let points: Vec<DVec3> = (0..16)
            .map(|k| {
                let corner = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z][k % 4];
                corner * 0.1 + DVec3::X * (k / 4) as f64
            })
            .collect();
        let tetrahedra: Vec<[u32; 4]> = (0..4).map(|k| [4 * k, 4 * k + 1, 4 * k + 2, 4 * k + 3]).collect();
        for projection in [Projection::Perspective { fov_y: 30.0 }, Projection::Orthographic { height: 2.0 }]
        {
            let camera = Camera {
                eye: DVec3::new(9.0, 0.0, 0.0),
                target: DVec3::ZERO,
                up: DVec3::Z,
                projection,
                near: 0.0,
                size: [8, 8],
                samples: 1,
            };
            let order = centroid_order(&points, &tetrahedra, &[0, 1, 2, 3], &camera).unwrap();
            assert_eq!(order, [3, 2, 1, 0]);
        }
    }
}
