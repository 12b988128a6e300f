//! Ordinary scenes: every kind of camera, look and picture size. Tests of all engines.

use super::Engine;
use super::compare::NamedScene;
use super::grids::{cube, smooth};
use super::looks::*;
use glam::DVec3;
use voltet_core::camera::Camera;
use voltet_core::transfer::TransferFunction;

fn looks() -> [(&'static str, TransferFunction); 3] {
    [("ramp", ramp()), ("gaussian", one_gaussian()), ("overlap", overlapping())]
}

fn with_every_look(engine: &dyn Engine, name: &str, camera: Camera) {
    let volume = smooth(cube([6, 6, 6], 0.2));
    for (kind, look) in looks() {
        engine.ordinary(&NamedScene { name: format!("{name} {kind}"), volume: volume.clone(), look, camera });
    }
}

pub fn perspective_from_outside(engine: &dyn Engine) {
    with_every_look(engine, "outside", outside([96, 64]));
}

pub fn orthographic_oblique(engine: &dyn Engine) {
    with_every_look(engine, "oblique", orthographic([3.0, -2.0, 2.5], [0.5, 0.5, 0.5], 1.9, [64, 96]));
}

pub fn eye_inside(engine: &dyn Engine) {
    with_every_look(engine, "inside", perspective([0.43, 0.37, 0.52], [0.9, 0.8, 0.45], 90.0, [80, 80]));
}

pub fn eye_inside_orthographic(engine: &dyn Engine) {
    with_every_look(
        engine,
        "inside ortho",
        orthographic([0.43, 0.37, 0.52], [0.9, 0.8, 0.45], 1.2, [80, 80]),
    );
}

pub fn near_plane_cuts_cells(engine: &dyn Engine) {
    let camera = Camera { near: 1.3, ..outside([80, 80]) };
    with_every_look(engine, "near", camera);
    let camera = Camera { near: 0.2, ..perspective([0.43, 0.37, 0.52], [0.9, 0.8, 0.45], 70.0, [80, 80]) };
    with_every_look(engine, "inside near", camera);
    let camera = Camera { near: 3.9, ..orthographic([3.0, -2.0, 2.5], [0.5, 0.5, 0.5], 1.9, [80, 80]) };
    with_every_look(engine, "near ortho", camera);
}

/// The depth of the plane is that of the grid to many digits: what is left of it behind the plane keeps its own.
pub fn near_plane_seen_from_far(engine: &dyn Engine) {
    for distance in [50.0, 1.2e3, 1.2e4, 1e6] {
        let direction = DVec3::new(-0.5, -0.7, 0.51).normalize();
        let eye = DVec3::splat(0.5) + distance * direction;
        let fov_y = 2.0 * (0.9 / distance).atan().to_degrees();
        let camera = perspective(eye.to_array(), [0.5; 3], fov_y, [48, 40]);
        with_every_look(engine, &format!("near from {distance}"), Camera { near: distance, ..camera });
    }
}

/// Cells between the outermost pixels' centres and their outermost samples.
pub fn samples_at_the_border_of_the_picture(engine: &dyn Engine) {
    let volume = smooth(cube([40, 4, 40], 0.1));
    for (name, camera) in [
        ("parallel", orthographic([0.5, -2.0, 0.5], [0.5, 0.5, 0.5], 0.8, [8, 6])),
        ("perspective", perspective([0.5, -2.0, 0.5], [0.5, 0.5, 0.5], 15.0, [8, 6])),
    ] {
        for samples in [9, 5] {
            let (name, camera) = (format!("border {name} {samples}"), Camera { samples, ..camera });
            engine.ordinary(&NamedScene { name, volume: volume.clone(), look: overlapping(), camera });
        }
    }
}

pub fn picture_sizes(engine: &dyn Engine) {
    for size in [[1, 1], [17, 15], [33, 50], [300, 2], [1, 90], [16, 16], [97, 31]] {
        with_every_look(engine, &format!("size {}x{}", size[0], size[1]), outside(size));
    }
}

pub fn several_samples_a_pixel(engine: &dyn Engine) {
    for samples in [4, 3] {
        with_every_look(engine, &format!("{samples} samples"), Camera { samples, ..outside([40, 30]) });
    }
}

pub fn wide_angle_and_telephoto(engine: &dyn Engine) {
    with_every_look(engine, "wide", perspective([0.5, -0.05, 0.5], [0.5, 0.5, 0.5], 150.0, [72, 72]));
    with_every_look(engine, "tele", perspective([-900.0, -1100.0, 1400.0], [0.5, 0.5, 0.5], 0.06, [72, 72]));
}
