//! Ordinary scenes: every kind of camera, look and picture size. Tests of all engines.

use crate::compare::{NamedScene, ordinary};
use crate::grids::{cube, smooth};
use crate::looks::*;
use glam::DVec3;
use voltet_core::camera::Camera;
use voltet_core::transfer::TransferFunction;

fn looks() -> [(&'static str, TransferFunction); 3] {
    [("ramp", ramp()), ("gaussian", one_gaussian()), ("overlap", overlapping())]
}

fn with_every_look(name: &str, camera: Camera) {
    let volume = smooth(cube([6, 6, 6], 0.2));
    for (kind, look) in looks() {
        ordinary(&NamedScene { name: format!("{name} {kind}"), volume: volume.clone(), look, camera });
    }
}

#[test]
fn perspective_from_outside() {
    with_every_look("outside", outside([96, 64]));
}

#[test]
fn orthographic_oblique() {
    with_every_look("oblique", orthographic([3.0, -2.0, 2.5], [0.5, 0.5, 0.5], 1.9, [64, 96]));
}

#[test]
fn eye_inside() {
    with_every_look("inside", perspective([0.43, 0.37, 0.52], [0.9, 0.8, 0.45], 90.0, [80, 80]));
}

#[test]
fn eye_inside_orthographic() {
    with_every_look("inside ortho", orthographic([0.43, 0.37, 0.52], [0.9, 0.8, 0.45], 1.2, [80, 80]));
}

#[test]
fn near_plane_cuts_cells() {
    let camera = Camera { near: 1.3, ..outside([80, 80]) };
    with_every_look("near", camera);
    let camera = Camera { near: 0.2, ..perspective([0.43, 0.37, 0.52], [0.9, 0.8, 0.45], 70.0, [80, 80]) };
    with_every_look("inside near", camera);
    let camera = Camera { near: 3.9, ..orthographic([3.0, -2.0, 2.5], [0.5, 0.5, 0.5], 1.9, [80, 80]) };
    with_every_look("near ortho", camera);
}

/// The depth of the plane is that of the grid to many digits: what is left of it behind the plane keeps its own.
#[test]
fn near_plane_seen_from_far() {
    for distance in [50.0, 1.2e3, 1.2e4, 1e6] {
        let direction = DVec3::new(-0.5, -0.7, 0.51).normalize();
        let eye = DVec3::splat(0.5) + distance * direction;
        let fov_y = 2.0 * (0.9 / distance).atan().to_degrees();
        let camera = perspective(eye.to_array(), [0.5; 3], fov_y, [48, 40]);
        with_every_look(&format!("near from {distance}"), Camera { near: distance, ..camera });
    }
}

/// Cells between the outermost pixels' centres and their outermost samples.
#[test]
fn samples_at_the_border_of_the_picture() {
    let volume = smooth(cube([40, 4, 40], 0.1));
    for (name, camera) in [
        ("parallel", orthographic([0.5, -2.0, 0.5], [0.5, 0.5, 0.5], 0.8, [8, 6])),
        ("perspective", perspective([0.5, -2.0, 0.5], [0.5, 0.5, 0.5], 15.0, [8, 6])),
    ] {
        for samples in [9, 5] {
            let (name, camera) = (format!("border {name} {samples}"), Camera { samples, ..camera });
            ordinary(&NamedScene { name, volume: volume.clone(), look: overlapping(), camera });
        }
    }
}

#[test]
fn picture_sizes() {
    for size in [[1, 1], [17, 15], [33, 50], [300, 2], [1, 90], [16, 16], [97, 31]] {
        with_every_look(&format!("size {}x{}", size[0], size[1]), outside(size));
    }
}

#[test]
fn several_samples_a_pixel() {
    for samples in [4, 3] {
        with_every_look(&format!("{samples} samples"), Camera { samples, ..outside([40, 30]) });
    }
}

#[test]
fn wide_angle_and_telephoto() {
    with_every_look("wide", perspective([0.5, -0.05, 0.5], [0.5, 0.5, 0.5], 150.0, [72, 72]));
    with_every_look("tele", perspective([-900.0, -1100.0, 1400.0], [0.5, 0.5, 0.5], 0.06, [72, 72]));
}
