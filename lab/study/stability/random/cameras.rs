//! RandomReport cameras that see a grid.

use super::rng::Rng;
use glam::DVec3;
use voltet_core::camera::{Camera, Projection};

/// From outside or inside, along an axis or not, at angles from 0.01 to 150 degrees, with near planes and several samples.
pub(super) fn camera(rng: &mut Rng, [low, high]: [DVec3; 2]) -> Camera {
    let (centre, radius) = (low.midpoint(high), 0.5 * low.distance(high));
    let towards = match rng.chance(0.25) {
        true => DVec3::AXES[rng.pick(3)] * if rng.chance(0.5) { 1.0 } else { -1.0 },
        false => rng.direction(),
    };
    let target = match rng.chance(0.3) {
        true => centre,
        false => centre + 0.4 * radius * rng.place(-1.0, 1.0),
    };
    // How much of the picture's height the grid fills.
    let filled = rng.power(-0.3, 0.5);
    let (projection, distance) = match rng.pick(6) {
        0 | 1 => (Projection::Orthographic { height: 2.0 * radius / filled }, rng.between(0.0, 4.0) * radius),
        2 => (Projection::Perspective { fov_y: rng.between(30.0, 150.0) }, rng.between(0.0, 0.9) * radius),
        _ => {
            let fov_y = if rng.chance(0.25) { rng.power(-2.0, 0.0) } else { rng.between(5.0, 100.0) };
            let half = (0.5 * fov_y).to_radians().tan();
            (Projection::Perspective { fov_y }, radius / (filled * half))
        }
    };
    let eye = target - distance.max(1e-3 * radius) * towards;
    let up = if towards.z.abs() > 0.9 { DVec3::Y } else { DVec3::Z };
    Camera {
        eye,
        target,
        up,
        projection,
        near: if rng.chance(0.2) { distance * rng.between(0.2, 1.1) } else { 0.0 },
        size: [8 + rng.pick(24) as u32, 8 + rng.pick(24) as u32],
        samples: if rng.chance(0.1) { 2 + rng.pick(3) as u32 } else { 1 },
    }
}

/// Camera with its picture moved by a part of a pixel, to the right and up.
pub(super) fn nudged(camera: &Camera, by: [f64; 2]) -> Option<Camera> {
    let frame = camera.frame().ok()?;
    let along = |pixel: f64| pixel * (by[0] * frame.right + by[1] * frame.up);
    Some(match camera.projection {
        Projection::Orthographic { .. } => {
            let step = along(frame.pixel);
            Camera { eye: camera.eye + step, target: camera.target + step, ..*camera }
        }
        Projection::Perspective { .. } => {
            let distance = camera.eye.distance(camera.target);
            Camera { target: camera.target + along(frame.pixel * distance), ..*camera }
        }
    })
}
