//! Silhouettes and light. Tests of all engines.

use super::Engine;
use super::compare::{NamedScene, SHADING};
use super::grids::{cube, smooth, smooth_gradient};
use super::looks::*;
use glam::DVec3;
use std::sync::Arc;
use voltet_core::camera::Camera;
use voltet_core::grid::Grid;
use voltet_core::transfer::TransferFunction;
use voltet_core::volume::Volume;
use voltet_optics::shading::{Light, Shading};

const LIGHT: Light = Light { direction: DVec3::new(0.4, -0.7, 3.5), ambient: 0.3, diffuse: 0.8 };

fn lit(grid: Grid, gradient: impl Fn(DVec3) -> DVec3) -> Arc<Volume> {
    let vectors = grid.points.iter().map(|&p| gradient(p)).collect();
    Arc::new(Volume { gradient: Some(vectors), ..(*smooth(grid)).clone() })
}

fn shadings() -> [(&'static str, Shading); 5] {
    let even = Light { diffuse: 0.0, ..LIGHT };
    [
        ("light", Shading { light: Some(LIGHT), ..SHADING }),
        ("silhouette 1", Shading { silhouette: Some(1.0), ..SHADING }),
        ("silhouette 0.5", Shading { silhouette: Some(0.5), light: Some(even), ..SHADING }),
        ("silhouette 3.7 and light", Shading { silhouette: Some(3.7), light: Some(LIGHT), ..SHADING }),
        ("silhouette 0", Shading { silhouette: Some(0.0), ..SHADING }),
    ]
}

fn with_every_shading(
    engine: &dyn Engine,
    name: &str,
    volume: &Arc<Volume>,
    look: &TransferFunction,
    camera: Camera,
) {
    for (kind, shading) in shadings() {
        let scene =
            NamedScene { name: format!("{name} {kind}"), volume: volume.clone(), look: look.clone(), camera };
        engine.ordinary_shaded(&scene, &shading);
    }
}

pub fn several_colours(engine: &dyn Engine) {
    let volume = lit(cube([6, 6, 6], 0.2), smooth_gradient);
    with_every_shading(engine, "overlap", &volume, &overlapping(), outside([64, 48]));
    with_every_shading(engine, "ramp", &volume, &ramp(), outside([48, 64]));
}

pub fn one_colour(engine: &dyn Engine) {
    let volume = lit(cube([6, 6, 6], 0.2), smooth_gradient);
    with_every_shading(engine, "one colour", &volume, &one_gaussian(), outside([64, 48]));
}

/// Orthographic rays have one direction; cells that reach behind the eye go their own way.
pub fn cameras(engine: &dyn Engine) {
    let volume = lit(cube([5, 5, 5], 0.2), smooth_gradient);
    let oblique = orthographic([3.0, -2.0, 2.5], [0.5, 0.5, 0.5], 1.9, [40, 40]);
    with_every_shading(engine, "oblique", &volume, &overlapping(), oblique);
    let inside = perspective([0.43, 0.37, 0.52], [0.9, 0.8, 0.45], 90.0, [40, 40]);
    with_every_shading(engine, "inside", &volume, &overlapping(), inside);
    with_every_shading(engine, "inside one colour", &volume, &one_gaussian(), inside);
    let near = Camera { near: 0.2, ..inside };
    with_every_shading(engine, "near", &volume, &overlapping(), near);
}

/// No gradient: the silhouette's factor is 1 and the light's the ambient share; tiny gradients have a direction.
pub fn gradients_without_and_with_little_length(engine: &dyn Engine) {
    let grid = || cube([5, 5, 5], 0.2);
    let nowhere = lit(grid(), |p| if p.x < 0.5 { DVec3::ZERO } else { smooth_gradient(p) });
    with_every_shading(engine, "partly constant", &nowhere, &overlapping(), outside([40, 40]));
    let tiny =
        lit(grid(), |p| if p.x < 0.5 { 1e-20 * DVec3::new(0.3, 1.0, p.y) } else { smooth_gradient(p) });
    with_every_shading(engine, "partly tiny", &tiny, &overlapping(), outside([40, 40]));
    let along = lit(grid(), |p| 1e200 * (DVec3::new(0.5, 0.5, 0.5) - p));
    with_every_shading(engine, "along the rays", &along, &overlapping(), outside([40, 40]));
}

pub fn what_changes_nothing_is_left_out(engine: &dyn Engine) {
    // No gradient in the volume, and none is asked for.
    let scene = NamedScene {
        name: "exponent 0".into(),
        volume: smooth(cube([3, 3, 3], 0.2)),
        look: overlapping(),
        camera: outside([16, 16]),
    };
    let shading = Shading { silhouette: Some(0.0), ..SHADING };
    let rgba = |shading: &Shading| engine.picture(&scene, shading).map(|picture| picture.rgba);
    assert_eq!(rgba(&shading), rgba(&SHADING));
}
