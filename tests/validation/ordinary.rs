//! Ordinary scenes: every kind of camera, look and picture size. Tests of all engines.

use crate::compare::{Scene, ordinary};
use crate::grids::{cube, smooth};
use crate::looks::*;
use voltet_core::camera::Camera;
use voltet_core::transfer::TransferFunction;

fn looks() -> [(&'static str, TransferFunction); 3] {
    [("ramp", ramp()), ("gaussian", one_gaussian()), ("overlap", overlapping())]
}

fn with_every_look(name: &str, camera: Camera) {
    let volume = smooth(cube([6, 6, 6], 0.2));
    for (kind, look) in looks() {
        ordinary(&Scene { name: format!("{name} {kind}"), volume: volume.clone(), look, camera });
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
