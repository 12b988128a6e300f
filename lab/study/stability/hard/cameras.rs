//! Hard cameras: the eye inside or far away, angles from the widest to the narrowest, rays along edges and faces.

use super::scene::{Hard, cube, moved, outside};
use glam::DVec3;
use voltet_core::camera::{Camera, Projection};

const CENTRE: DVec3 = DVec3::splat(0.5);

/// Every one, before a cube of irregular cells or, for rays along edges, of regular ones.
pub(super) fn scenes() -> Vec<Hard> {
    let irregular = cube([4, 4, 4], 0.2);
    let regular = cube([4, 4, 4], 0.0);
    let perspective = |eye: DVec3, fov_y: f64| Camera {
        eye,
        target: CENTRE + DVec3::new(0.01, 0.02, 0.03),
        projection: Projection::Perspective { fov_y },
        ..outside()
    };
    let straight = |eye: DVec3, height: f64| Camera {
        eye,
        target: CENTRE,
        projection: Projection::Orthographic { height },
        ..outside()
    };
    let side = DVec3::new(-1.0, -1.3, 0.8);
    let scene =
        |name: &str, camera: Camera, base| Hard { camera, ..moved(name.into(), "cameras", base, |p| p) };
    vec![
        scene("an eye inside the grid", perspective(CENTRE, 60.0), &irregular),
        scene("an eye inside, 170 degrees", perspective(CENTRE, 170.0), &irregular),
        scene("an eye inside, 179.9 degrees", perspective(CENTRE, 179.9), &irregular),
        scene("an eye at a corner of cells", perspective(DVec3::splat(0.25), 90.0), &regular),
        scene("an eye in a face of cells", perspective(DVec3::new(0.25, 0.3, 0.4), 90.0), &regular),
        scene(
            "a near plane in the grid",
            Camera { near: 1.2, ..perspective(CENTRE + side, 45.0) },
            &irregular,
        ),
        scene("0.1 degrees", perspective(CENTRE + 400.0 * side, 0.1), &irregular),
        scene("0.01 degrees", perspective(CENTRE + 4e3 * side, 0.01), &irregular),
        scene("a pixel of 1e-6", straight(CENTRE + side, 24e-6), &irregular),
        // 24 pixels over 1.5 of a grid of 4 cells: every fourth ray through edges, and through the grid's own sides.
        scene("rays along edges and faces", straight(CENTRE - 2.0 * DVec3::Y, 1.5), &regular),
        scene("the grid edge on, in perspective", perspective(DVec3::new(0.5, -1.0, 0.0), 40.0), &regular),
    ]
}
