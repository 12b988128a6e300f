//! The triangles round the thick vertex: held tightly where what the hardware interpolates is exact, closely where it is not,
//! and to the raster compositor in what both share.

use crate::drawing::{How, device, draw_on, further_device, raster};
use crate::raster::{cell, classes, jittered, views};
use glam::DVec3;
use std::sync::Arc;
use voltet_core::camera::Camera;
use voltet_core::picture::Picture;
use voltet_core::progress::NoProgress;
use voltet_core::transfer::TransferFunction;
use voltet_core::volume::Volume;
use voltet_gpu::{Device, FrameOutput, Renderer};
use voltet_integrators::{pre_integrated, pre_integrated_cylindrical, riemann, segments};
use voltet_optics::engine::{Compositor, RenderOptions};
use voltet_optics::shading::{Integrator, Light, Shading, VisibilityOrder};
use voltet_testing::pictures::compare::{NamedScene, ORDINARY, SHADING, referee, within};
use voltet_testing::pictures::grids::*;
use voltet_testing::pictures::looks::*;

fn triangles(order: VisibilityOrder) -> How {
    (Compositor::Triangles, order)
}

fn draw(device: &Arc<Device>, scene: &NamedScene, shading: &Shading, how: How) -> FrameOutput {
    let drawn =
        draw_on(device.clone(), scene, shading, how).unwrap_or_else(|e| panic!("{}: {e}", scene.name));
    assert_eq!(drawn.compositing, how.0, "{}", scene.name);
    drawn
}

fn uniform() -> TransferFunction {
    look(vec![everywhere(2.0, [1.0, 0.5, 0.2])])
}

/// Error that the corners' raster leaves of an ordinary scene: a pixel on the rim of a steep face goes to the wrong side of it. A
/// hundredth part of the pixels at most are seen to change.
fn nearly(scene: &NamedScene, picture: &Picture) {
    let expected = referee(scene);
    assert!(expected.rgba.iter().any(|p| p[3] > 0.01), "{}: nothing to see", scene.name);
    within(&scene.name, picture, &expected, 1.0 / 255.0);
    let differ =
        |(a, b): (&[f32; 4], &[f32; 4])| a.iter().zip(b).any(|(a, b)| f64::from((a - b).abs()) > ORDINARY);
    let count = picture.rgba.iter().zip(&expected.rgba).filter(|pair| differ(*pair)).count();
    assert!(100 * count <= picture.rgba.len(), "{}: {count} pixels differ", scene.name);
}

/// Corners at whole sixteenths of a pixel, so that no hardware moves them, and values that are linear: what is interpolated is
/// exact but for the rounding of 32 bits. At the thick vertex the thickness is a number known by hand.
#[test]
fn cells_whose_corners_stay_are_exact() {
    let Some(device) = device() else { return };
    // 32 pixels across 1 by parallel rays; pixel (20, 16) is the one about the place (20.5, 16.5).
    let parallel = orthographic([0.5, -2.0, 0.5], [0.5, 0.0, 0.5], 1.0, [32, 32]);
    let at = |x: f64, y: f64, z: f64| [x / 32.0, y, 1.0 - z / 32.0];
    // A picture of 90 degrees, 32 pixels across 2 at a depth of 1.
    let wide = perspective([0.0, -1.0, 0.0], [0.0, 0.0, 0.0], 90.0, [32, 32]);
    let seen =
        |x: f64, depth: f64, z: f64| [(x - 16.0) / 16.0 * depth, depth - 1.0, (16.0 - z) / 16.0 * depth];
    for (name, camera, corners, thickness) in [
        // The fourth corner behind the middle of the others, at which their plane has y = 0.3.
        (
            "three",
            parallel,
            [at(4.0, 0.3, 4.5), at(28.5, 0.3, 8.0), at(12.0, 0.3, 30.0), at(20.5, 0.8, 16.5)],
            0.5,
        ),
        // Edges along both axes of the picture, at y = 0.25 and at the middle of 0.5 and 1.
        (
            "four",
            parallel,
            [at(2.5, 0.25, 16.5), at(30.5, 0.25, 16.5), at(20.5, 0.5, 2.5), at(20.5, 1.0, 30.5)],
            0.5,
        ),
        // The same in perspective: one edge at a depth of 1, the other from 2 to 4: as 1/d is linear, 1/(3/8) at its middle.
        (
            "four in perspective",
            wide,
            [seen(2.5, 1.0, 16.5), seen(30.5, 1.0, 16.5), seen(20.5, 2.0, 2.5), seen(20.5, 4.0, 30.5)],
            8.0 / 3.0 - 1.0,
        ),
    ] {
        for turn in 0..4 {
            let mut turned = corners;
            turned.rotate_left(turn);
            let volume = volume(cell(turned), |p| 0.51 + 0.393 * p.x, |p| 0.8 + 0.117 * p.z);
            let scene = NamedScene { name: format!("{name} {turn}"), volume, look: uniform(), camera };
            // Per ray, not per depth.
            let stretch = if camera.size[0] == 32 && name == "four in perspective" {
                (1.0 + (4.5f64 / 16.0).powi(2) + (0.5f64 / 16.0).powi(2)).sqrt()
            } else {
                1.0
            };
            let drawn = draw(&device, &scene, &SHADING, triangles(VisibilityOrder::Exact)).picture;
            let known = -(-2.0 * thickness * stretch).exp_m1();
            let found = f64::from(drawn.pixel(20, 16)[3]);
            assert!((found - known).abs() < 2e-6, "{name} {turn}: {found} for {known}");
            // The ray's length and each value from two dozen roundings.
            within(&scene.name, &drawn, &referee(&scene), 3e-6);
            let valued = NamedScene { look: overlapping(), ..scene };
            let drawn = draw(&device, &valued, &SHADING, triangles(VisibilityOrder::Centroid)).picture;
            within(&format!("{} values", valued.name), &drawn, &referee(&valued), 2e-5);
        }
    }
}

/// One cell of each class, corners on edges and on one another among them; and grids that the eye, or the near plane, cuts.
#[test]
fn every_class_and_place_of_the_eye() {
    let Some(device) = device() else { return };
    for (class, corners) in classes() {
        for (view, camera) in views() {
            let volume = volume(cell(corners), |p| 0.51 + 0.393 * p.x, |p| 0.8 + 0.117 * p.z);
            let scene = NamedScene { name: format!("{class} {view}"), volume, look: uniform(), camera };
            nearly(&scene, &draw(&device, &scene, &SHADING, triangles(VisibilityOrder::Exact)).picture);
        }
    }
    let inside = perspective([0.43, 0.37, 0.52], [0.9, 0.8, 0.45], 90.0, [40, 40]);
    for (name, camera) in [
        ("outside", outside([48, 40])),
        ("inside", inside),
        ("inside near", Camera { near: 0.2, ..inside }),
        ("inside parallel", orthographic([0.43, 0.37, 0.52], [0.9, 0.8, 0.45], 1.2, [40, 40])),
        ("near", Camera { near: 1.3, ..outside([40, 40]) }),
        ("far", perspective([-900.0, -1100.0, 1400.0], [0.5, 0.5, 0.5], 0.06, [40, 40])),
    ] {
        let (volume, look) = (smooth(cube([5, 5, 5], 0.2)), one_gaussian());
        let scene = NamedScene { name: name.into(), volume, look, camera };
        nearly(&scene, &draw(&device, &scene, &SHADING, triangles(VisibilityOrder::Exact)).picture);
    }
    let huge = [[-50.0, 10.0, -50.0], [60.0, 11.0, -45.0], [1.0, 12.0, 70.0], [0.0, 30.0, 2.0]];
    let volume = volume(cell(huge), |p| 0.5 + 0.01 * p.x, |p| 0.8 + 0.01 * p.z);
    for eye in [[0.0, 0.0, 0.0], [0.0, 14.0, 2.0]] {
        let camera = perspective(eye, [0.0, 40.0, 1.0], 30.0, [40, 32]);
        let scene = NamedScene { name: "huge".into(), volume: volume.clone(), look: one_gaussian(), camera };
        nearly(&scene, &draw(&device, &scene, &SHADING, triangles(VisibilityOrder::Exact)).picture);
    }
}

/// Smaller cells come nearer to a smooth field, by the square of their size, as they do by every compositor.
#[test]
fn smaller_cells_come_nearer_to_a_smooth_field() {
    let Some(device) = device() else { return };
    let s = |p: DVec3| 0.5 + 0.3 * (2.0 * p.x + 1.0).sin() * (2.5 * p.z).cos() + 0.2 * p.y * p.y;
    let scene = |n: usize| NamedScene {
        name: format!("{n} cells a side"),
        volume: volume(cube([n; 3], 0.0), s, |_| 0.0),
        look: look(vec![points(&[[0.0, 1.0, 0.5, 0.2, 0.0], [1.0, 1.0, 0.5, 0.2, 3.0]])]),
        camera: outside([24, 24]),
    };
    let finest = referee(&scene(32));
    let errors = [2, 4, 8].map(|n| {
        let drawn = draw(&device, &scene(n), &SHADING, triangles(VisibilityOrder::Exact)).picture;
        let squares = drawn.rgba.iter().zip(&finest.rgba).map(|(a, b)| f64::from(a[3] - b[3]).powi(2));
        (squares.sum::<f64>() / drawn.rgba.len() as f64).sqrt()
    });
    println!("{errors:?}");
    for pair in errors.windows(2) {
        assert!(pair[0] / pair[1] > 3.0, "{errors:?}");
    }
}

/// Cells, their order and what is culled are those of the raster compositor, and so, but for the rims, are pictures by every
/// integrator and in every light.
#[test]
fn what_is_shared_with_outlines_is_the_same() {
    let Some(device) = device() else { return };
    let grid = cube([4, 4, 4], 0.2);
    let gradient = grid.points.iter().map(|&p| smooth_gradient(p)).collect();
    let volume = Arc::new(Volume { gradient: Some(gradient), ..(*smooth(grid)).clone() });
    let light = Some(Light { direction: DVec3::new(0.4, -0.7, 3.5), ambient: 0.3, diffuse: 0.8 });
    let mut shadings = vec![SHADING, Shading { light, silhouette: Some(0.5), ..SHADING }];
    shadings.extend(
        [
            Integrator::adaptive(1e-4),
            segments(4, 64),
            riemann(8),
            pre_integrated(32, 2),
            pre_integrated_cylindrical(32, 2, 1),
        ]
        .map(|integrator| Shading { integrator, ..SHADING }),
    );
    for shading in shadings {
        let scene = NamedScene {
            name: format!("{shading:?}"),
            volume: volume.clone(),
            look: ramp(),
            camera: outside([32, 28]),
        };
        let [both, outlines] =
            [triangles, raster].map(|how| draw(&device, &scene, &shading, how(VisibilityOrder::Centroid)));
        within(&scene.name, &both.picture, &outlines.picture, 1.0 / 255.0);
        let mean = |a: &Picture, b: &Picture| {
            let sum: f32 = a.rgba.iter().zip(&b.rgba).map(|(a, b)| (a[3] - b[3]).abs()).sum();
            f64::from(sum) / a.rgba.len() as f64
        };
        let off = mean(&both.picture, &outlines.picture);
        assert!(off < 2e-5, "{}: {off:e}", scene.name);
        assert_eq!(both.counts, outlines.counts);
    }
}

/// Runs of any length, the last one short, and bindings that hold few corners, are the picture in one.
#[test]
fn runs_and_small_bindings_change_nothing() {
    let Some(device) = device() else { return };
    let scene = jittered(overlapping(), outside([24, 20]));
    let wanted = scene.drawn_by(&SHADING, VisibilityOrder::Centroid);
    let options = RenderOptions { compositing: Some(Compositor::Triangles), ..RenderOptions::default() };
    let whole = draw(&device, &scene, &SHADING, triangles(VisibilityOrder::Centroid)).picture;
    for length in [300, 1296] {
        let runs = Renderer::new(device.clone(), &scene.volume).expect("fits").with_runs_of(length);
        let drawn = voltet_gpu::draw(&runs, &wanted, &options, &NoProgress).expect("draws");
        assert_eq!(drawn.picture.rgba, whole.rgba, "{length}");
    }
    let small = further_device().with_limits(|limits| {
        limits.max_storage_buffer_binding_size = 24_000;
        limits.max_storage_buffers_per_shader_stage = 32;
    });
    let drawn = draw(&Arc::new(small), &scene, &SHADING, triangles(VisibilityOrder::Centroid)).picture;
    assert_eq!(drawn.rgba, whole.rgba);
}
