//! Surfaces and clips in a volume, against the 64-bit referee. Tests of all engines.

use super::compare::{NamedScene, ORDINARY, SHADING, within};
use super::grids::*;
use super::looks::*;
use glam::DVec3;
use std::sync::Arc;
use voltet_core::camera::Camera;
use voltet_core::clip::{Clip, ClipShape};
use voltet_core::colormap::Colormap;
use voltet_core::grid::generate::Random;
use voltet_core::picture::Picture;
use voltet_core::progress::NoProgress;
use voltet_core::surface::{EyeLight, Paint, Surface};
use voltet_core::transfer::TransferFunction;
use voltet_core::tubes::{TubeShape, tubes};
use voltet_core::volume::Volume;
use voltet_optics::scene::Scene;
use voltet_optics::shading::{Light, Shading, VisibilityOrder};

/// Draws a scene; `None` where it cannot be tested here, which was said loudly.
pub type Draw<'a> = &'a dyn Fn(&Scene) -> Option<Picture>;

pub(super) fn scene(
    volume: &Arc<Volume>,
    look: TransferFunction,
    camera: Camera,
    shading: &Shading,
) -> Scene {
    NamedScene { name: String::new(), volume: volume.clone(), look, camera }
        .drawn_by(shading, VisibilityOrder::Exact)
}

pub(super) fn compare(draw: Draw, name: &str, scene: &Scene) {
    let Some(actual) = draw(scene) else { return };
    let expected = voltet_reference::draw(scene, &NoProgress).unwrap_or_else(|e| panic!("{name}: {e}"));
    assert!(
        expected.rgba.iter().any(|p| p[3] > 0.01),
        "{name}: the scene shows nothing, so it proves nothing"
    );
    within(name, &actual, &expected, ORDINARY);
}

fn random_point(random: &mut Random) -> DVec3 {
    DVec3::from([(); 3].map(|()| 1.4 * random.next() - 0.2))
}

/// Some triangles here and there, of one of several paints.
fn triangles(random: &mut Random, count: usize) -> Surface {
    let points: Vec<DVec3> = (0..3 * count).map(|_| random_point(random)).collect();
    let values = (0..3 * count).map(|_| random.next()).collect();
    let paint = match random.next() < 0.5 {
        true => Paint::Uniform([random.next(), random.next(), random.next()]),
        false => Paint::Mapped { values, range: [0.1, 0.8], curve: Colormap::Viridis.curve(), bad: None },
    };
    let opacity = if random.next() < 0.2 { 1.0 } else { 0.6 * random.next() };
    let light = (random.next() < 0.5).then_some(EyeLight { ambient: 0.3, diffuse: 0.7 });
    let normals =
        if random.next() < 0.5 { Vec::new() } else { points.iter().map(|p| *p - 0.5 + 1e-3).collect() };
    let triangles = (0..count as u32).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
    Surface { points, triangles, paint, opacity, light, normals }
}

pub(super) fn cameras() -> [(&'static str, Camera); 5] {
    let several = Camera { samples: 3, ..outside([20, 16]) };
    [
        ("outside", outside([48, 36])),
        ("inside", perspective([0.45, 0.52, 0.48], [1.0, 0.2, 0.6], 70.0, [40, 40])),
        ("parallel", orthographic([-2.0, -1.5, 1.7], [0.5, 0.5, 0.5], 1.6, [40, 30])),
        ("near plane", Camera { near: 2.1, ..outside([40, 40]) }),
        ("several samples", several),
    ]
}

/// Fifty surfaces of random triangles among the cells, in every view.
pub fn fifty_surfaces(draw: Draw) {
    let volume = smooth(cube([5, 5, 5], 0.2));
    for (number, (name, camera)) in cameras().into_iter().enumerate() {
        let mut random = Random(number as u64 + 1);
        let mut scene = scene(&volume, overlapping(), camera, &SHADING);
        scene.surfaces = (0..50).map(|_| Arc::new(triangles(&mut random, 3))).collect();
        compare(draw, &format!("fifty surfaces, {name}"), &scene);
    }
}

/// A helix as a tube and points as spheres, translucent and of colours that change along them, in every view.
pub fn tubes_and_spheres(draw: Draw) {
    let volume = smooth(cube([5, 5, 5], 0.2));
    let mut random = Random(7);
    let turn = |k: u32| 0.4 * f64::from(k);
    let helix =
        (0..24).map(turn).map(|t| DVec3::new(0.5 + 0.3 * t.cos(), 0.5 + 0.3 * t.sin(), 0.1 + 0.08 * t));
    let points: Vec<DVec3> = helix.chain((0..4).map(|_| random_point(&mut random))).collect();
    let line: Vec<u32> = (0..24).collect();
    let shape = TubeShape { radius: 0.07, sides: 8 };
    let made = tubes(&points, &[line], &[24, 25, 26, 27], shape, &NoProgress).expect("tubes");
    let color = |&p: &u32| [0.03 * f64::from(p), 0.3, 1.0 - 0.03 * f64::from(p), 0.2 + 0.02 * f64::from(p)];
    let surface = Arc::new(Surface {
        paint: Paint::Points(made.origins.iter().map(color).collect()),
        points: made.points,
        triangles: made.triangles,
        normals: made.normals,
        opacity: 0.9,
        light: Some(EyeLight { ambient: 0.3, diffuse: 0.7 }),
    });
    for (name, camera) in cameras() {
        let mut scene = scene(&volume, overlapping(), camera, &SHADING);
        scene.surfaces = vec![surface.clone()];
        compare(draw, &format!("tubes and spheres, {name}"), &scene);
    }
}

fn square(corners: [[f64; 3]; 4], color: [f64; 3], opacity: f64) -> Surface {
    Surface {
        points: corners.map(DVec3::from).to_vec(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        paint: Paint::Uniform(color),
        opacity,
        light: None,
        normals: Vec::new(),
    }
}

/// Surfaces that lie in faces of cells, clear ones among them: they neither flicker nor darken.
pub fn surfaces_in_faces_of_cells(draw: Draw) {
    let volume = smooth(cube([4, 4, 4], 0.0));
    let at = |x: f64| [[x, -0.1, -0.2], [x, 1.2, -0.1], [x, 1.1, 1.3], [x, -0.3, 1.1]];
    for (name, camera) in cameras() {
        for opacity in [0.0, 0.3, 1.0] {
            let mut scene = scene(&volume, overlapping(), camera, &SHADING);
            let all = [0.0, 0.25, 0.5, 1.0].map(|x| Arc::new(square(at(x), [0.1, 0.7, 0.3], opacity)));
            scene.surfaces = all.to_vec();
            compare(draw, &format!("in faces, {name}, opacity {opacity}"), &scene);
        }
    }
}

/// A surface before, beside and behind the cells, and where there are none.
pub fn surfaces_without_cells(draw: Draw) {
    let volume = smooth(cube([2, 2, 2], 0.2));
    let camera = perspective([0.5, -4.0, 0.5], [0.5, 0.0, 0.5], 60.0, [64, 40]);
    let at = |y: f64| [[-3.0, y, -0.6], [3.0, y, -0.6], [3.0, y, 0.7], [-3.0, y, 0.7]];
    let mut scene = scene(&volume, one_gaussian(), camera, &SHADING);
    scene.surfaces = [(-1.0, 0.2), (0.4, 0.5), (3.0, 0.7)]
        .map(|(y, a)| Arc::new(square(at(y), [0.9, 0.5, y.abs() / 4.0], a)))
        .to_vec();
    compare(draw, "beside the cells", &scene);
    let hidden = ClipShape::Box { low: DVec3::splat(5.0), high: DVec3::splat(6.0) };
    scene.clips = vec![Clip { shape: hidden, invert: false }];
    compare(draw, "nothing but surfaces", &scene);
}

/// Clips of every shape, inverted and together, of scenes with one colour and with several, lit and not.
pub fn clips(draw: Draw) {
    let vectors = |grid: voltet_core::grid::Grid| {
        let gradient = grid.points.iter().map(|&p| smooth_gradient(p)).collect();
        Arc::new(Volume { gradient: Some(gradient), ..(*smooth(grid)).clone() })
    };
    let volume = vectors(cube([5, 5, 5], 0.2));
    let shapes = [
        ClipShape::Plane { origin: DVec3::new(0.5, 0.4, 0.5), normal: DVec3::new(0.3, 1.0, -0.2) },
        ClipShape::Box { low: DVec3::new(0.1, 0.2, 0.3), high: DVec3::new(0.9, 0.7, 0.8) },
        ClipShape::Sphere { centre: DVec3::new(0.5, 0.5, 0.6), radius: 0.35 },
        ClipShape::Cylinder { from: DVec3::new(0.0, 0.5, 0.4), to: DVec3::new(1.0, 0.6, 0.5), radius: 0.25 },
    ];
    let light = Light { direction: DVec3::new(0.4, -0.7, 3.5), ambient: 0.3, diffuse: 0.8 };
    let lit = Shading { light: Some(light), ..SHADING };
    for (name, camera) in cameras() {
        for (k, shape) in shapes.into_iter().enumerate() {
            for invert in [false, true] {
                let look = if k % 2 == 0 { one_gaussian() } else { overlapping() };
                let mut scene = scene(&volume, look, camera, if invert { &lit } else { &SHADING });
                scene.clips = vec![Clip { shape, invert }];
                if draw(&scene).is_some_and(|picture| picture.rgba.iter().all(|p| p[3] < 0.01)) {
                    // A view from inside what is cut away; the next assertion would refuse it.
                    continue;
                }
                compare(draw, &format!("clip {k}, inverted {invert}, {name}"), &scene);
            }
        }
        let mut scene = scene(&volume, overlapping(), camera, &SHADING);
        scene.clips = shapes.map(|shape| Clip { shape, invert: true }).to_vec();
        scene.clips[1].invert = false;
        let mut random = Random(9);
        scene.surfaces = (0..5).map(|_| Arc::new(triangles(&mut random, 2))).collect();
        compare(draw, &format!("all clips and surfaces, {name}"), &scene);
    }
}

/// Pixels of thousands of segments.
pub fn deep_pixels(draw: Draw) {
    let base = moved(&cube([2, 700, 2], 0.0), |p| DVec3::new(p.x, 3.0 * p.y, p.z));
    let volume = volume(base, |p| 0.5 + 0.5 * (9.0 * p.y + 2.0 * p.x).sin(), |p| p.z);
    let camera = perspective([0.45, -3.0, 0.55], [0.5, 0.0, 0.5], 18.0, [24, 20]);
    let mut scene = scene(&volume, overlapping(), camera, &SHADING);
    let mut random = Random(5);
    scene.surfaces = (0..6).map(|_| Arc::new(triangles(&mut random, 2))).collect();
    let shape = ClipShape::Sphere { centre: DVec3::new(0.5, 0.4, 0.5), radius: 0.3 };
    scene.clips = vec![Clip { shape, invert: true }];
    compare(draw, "deep pixels with surfaces", &scene);
}
