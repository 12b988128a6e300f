//! Anchors: exact segments, the fixtures' 20-digit values, and pictures whose truth is a formula.

use glam::DVec3;
use std::sync::Arc;
use voltet_core::SharedSlice;
use voltet_core::camera::{Camera, Projection};
use voltet_core::grid::generate::{box_of_tetrahedra, sample};
use voltet_core::progress::{NoProgress, Progress};
use voltet_core::transfer::TransferFunction;
use voltet_core::transfer::{OpticalModel, Profile, Region, Widget};
use voltet_core::volume::Volume;
use voltet_optics::scene::Scene;
use voltet_optics::shading::{Light, Shading, VisibilityOrder};
use voltet_optics::trace::Crossing;
use voltet_optics::{Segment, WidgetBlend};
use voltet_reference::{REFERENCE, draw, integrate, tracer};

const PLAIN: Shading =
    Shading { integrator: REFERENCE, overlap: WidgetBlend::Exact, silhouette: None, light: None };

fn gaussian(centre: f64, sigma: f64, extinction: f64) -> Widget {
    let k = 1.0 / (std::f64::consts::SQRT_2 * sigma);
    let profile = Profile::Gaussian { centre: [centre, 0.0], matrix: [[k, 0.0], [0.0, 0.0]] };
    Widget { profile, color: [1.0, 0.5, 0.25], extinction, region: None }
}

fn uniform(extinction: f64) -> Widget {
    let everywhere =
        Region::rectangle([f64::NEG_INFINITY, f64::INFINITY], [f64::NEG_INFINITY, f64::INFINITY]);
    Widget { profile: Profile::Uniform, color: [1.0, 0.5, 0.25], extinction, region: Some(everywhere) }
}

fn look(widgets: Vec<Widget>) -> TransferFunction {
    TransferFunction {
        model: OpticalModel::DensityEmitter,
        unit_distance: 1.0,
        widgets,
        axes: Default::default(),
    }
}

fn segment(length: f64, front: f64, back: f64) -> Segment<'static> {
    Segment { length, front: [front, 0.0], back: [back, 0.0], fields_front: &[], fields_back: &[] }
}

/// A unit cube with s = x, seen along y from the front.
fn cube(counts: [usize; 3], scale: f64, offset: DVec3) -> Volume {
    let grid = box_of_tetrahedra(counts, [offset, offset + DVec3::splat(scale)], 0.0);
    let scalar = sample(&grid, |p| (p.x - offset.x) / scale);
    Volume {
        grid: Arc::new(grid),
        scalar: SharedSlice::from(scalar),
        gradient: None,
        gradient_magnitude: None,
    }
}

/// In exact order.
fn scene(volume: Volume, look: TransferFunction, camera: Camera, shading: Shading) -> Scene {
    let (volume, transfer_function) = (Arc::new(volume), Arc::new(look));
    Scene::new(volume, transfer_function, camera, shading, VisibilityOrder::Exact)
}

fn camera(scale: f64, offset: DVec3, size: [u32; 2]) -> Camera {
    Camera {
        eye: offset + scale * DVec3::new(0.5, -2.0, 0.5),
        target: offset + scale * DVec3::new(0.5, 0.5, 0.5),
        up: DVec3::Z,
        projection: Projection::Orthographic { height: scale },
        near: 0.0,
        size,
        samples: 1,
    }
}

/// T = ρ₀ D √(π/2) σ/Δs (erf b − erf a), a and b the ends over √2 σ: half a width wide to a millionth of the
/// span, centre inside, at the front end and outside. Relative to erf of the library, 1e-15, times the
/// condition: 1e-10 where the centre has 1e6 widths on both sides, else 1e-13.
#[test]
fn gaussian_segments() {
    for (centre, sigma, tolerance) in
        [(0.4, 0.5, 1e-13), (0.4, 1e-6, 1e-9), (0.0, 1e-6, 1e-13), (1.3, 0.2, 1e-13), (0.7, 0.02, 1e-13)]
    {
        let found =
            integrate(&segment(3.0, 0.0, 1.0), &look(vec![gaussian(centre, sigma, 2.0)]), WidgetBlend::Exact)
                .expect("integrates");
        let scale = std::f64::consts::SQRT_2 * sigma;
        let spread = libm::erf((1.0 - centre) / scale) - libm::erf(-centre / scale);
        let exact = 6.0 * scale * 0.5 * std::f64::consts::PI.sqrt() * spread;
        assert!((found.optical_depth / exact - 1.0).abs() < tolerance, "{centre} {sigma}: {found:?}");
        let opacity = -(-exact).exp_m1();
        assert!((found.opacity - opacity).abs() <= tolerance * opacity);
        // One colour: C = c A. The error of C is that of the quadrature.
        assert!((found.color[1] - 0.5 * opacity).abs() < 1e-10 * opacity, "{centre} {sigma}: {found:?}");
    }
}

/// s = 1, ρ = 2, thickness 1: A = 1 − e^(−2) in every pixel, also for rays that lie in the faces and edges of
/// cells (13 pixels over 4 and 13 cells). 32-bit rounding of the picture: 6e-8.
#[test]
fn slab() {
    for counts in [[1, 1, 1], [4, 3, 4], [13, 2, 13]] {
        let volume = cube(counts, 1.0, DVec3::ZERO);
        let view = camera(1.0, DVec3::ZERO, [13, 13]);
        let scene = scene(volume, look(vec![uniform(2.0)]), view, PLAIN);
        let picture = draw(&scene, &NoProgress).expect("draws");
        let exact = -(-2f64).exp_m1();
        for pixel in &picture.rgba {
            assert!((f64::from(pixel[3]) - exact).abs() < 1e-7, "{counts:?}: {pixel:?}");
            assert!((f64::from(pixel[1]) - 0.5 * exact).abs() < 1e-7, "{counts:?}: {pixel:?}");
        }
    }
}

/// One cube gives one picture at every position and size; far away positions have 1e-10 of the
/// cube's size.
#[test]
fn place_and_size_do_not_matter() {
    let picture = |scale: f64, offset: DVec3| {
        let mut looks = look(vec![gaussian(0.5, 0.1, 3.0), gaussian(0.2, 0.05, 9.0)]);
        looks.unit_distance = scale;
        let mut view = camera(scale, offset, [20, 20]);
        view.projection = Projection::Perspective { fov_y: 35.0 };
        view.eye += scale * DVec3::new(0.7, 0.0, 0.4);
        draw(&scene(cube([3, 3, 3], scale, offset), looks, view, PLAIN), &NoProgress).expect("draws")
    };
    let here = picture(1.0, DVec3::ZERO);
    for (scale, offset) in [(1e20, DVec3::ZERO), (1e-20, DVec3::ZERO), (1.0, DVec3::splat(1e6))] {
        let there = picture(scale, offset);
        for (a, b) in here.rgba.iter().zip(&there.rgba) {
            assert!(a.iter().zip(b).all(|(x, y)| (x - y).abs() < 1e-7), "{scale}: {a:?} {b:?}");
        }
    }
}

/// The eye in the middle: half the slab is left; the near plane takes another quarter.
#[test]
fn eye_inside_and_near_plane() {
    let volume = cube([3, 3, 3], 1.0, DVec3::ZERO);
    for (near, left) in [(0.0, 0.5), (0.25, 0.25)] {
        let view = Camera {
            eye: DVec3::splat(0.5),
            target: DVec3::new(0.5, 1.0, 0.5),
            near,
            ..camera(1.0, DVec3::ZERO, [9, 9])
        };
        for projection in [Projection::Orthographic { height: 1.0 }, Projection::Perspective { fov_y: 80.0 }]
        {
            let view = Camera { projection, ..view };
            let looks = look(vec![uniform(1.0)]);
            let scene = scene(volume.clone(), looks, view, PLAIN);
            let tracer = tracer(&scene).expect("is a scene");
            let picture = tracer.draw(&NoProgress).expect("draws");
            for (j, i) in (0..9).flat_map(|j| (0..9).map(move |i| (j, i))) {
                let ray = tracer.ray(i as f64 + 0.5, j as f64 + 0.5);
                let exact = -(-left * ray.stretch()).exp_m1();
                assert!((f64::from(picture.pixel(i, j)[3]) - exact).abs() < 1e-7, "{i} {j} {projection:?}");
                assert!((tracer.trace(&ray).expect("traces").opacity - exact).abs() < 1e-12);
            }
        }
    }
}

/// ĝ along x, viewed along y: the silhouette's factor is 1; viewed at 45°, 1 − √½. Light along x: k_a + k_d.
#[test]
fn silhouette_and_light() {
    let mut volume = cube([2, 2, 2], 1.0, DVec3::ZERO);
    volume.gradient = Some(SharedSlice::from(vec![DVec3::X * 3.0; volume.scalar.len()]));
    let half = std::f64::consts::FRAC_1_SQRT_2;
    for (eye, facing) in [(DVec3::new(0.5, -2.0, 0.5), 0.0), (DVec3::new(2.5, -1.5, 0.5), half)] {
        let view = Camera { eye, target: DVec3::splat(0.5), ..camera(1.0, DVec3::ZERO, [1, 1]) };
        let light = Light { direction: DVec3::X * 7.0, ambient: 0.3, diffuse: 0.5 };
        let looks = look(vec![uniform(1e6)]);
        let lit = Shading { silhouette: Some(2.0), light: Some(light), ..PLAIN };
        let scene = scene(volume.clone(), looks, view, lit);
        let tracer = tracer(&scene).expect("is a scene");
        // A hair beside the middle, where the ray does not lie in the cube's diagonal plane.
        let ray = tracer.ray(0.51, 0.503);
        let seen = tracer.trace(&ray).expect("traces");
        // Each cell is opaque but for the factor.
        let factor = (1.0f64 - facing).powi(2);
        let opacity = 1.0 - (1.0 - factor).powi(seen.segments as i32);
        assert!(seen.segments >= 2 && (seen.opacity - opacity).abs() < 1e-9, "{seen:?} {opacity}");
        assert!((seen.color[0] - 0.8 * opacity).abs() < 1e-9, "{seen:?}");
    }
}

/// Kniss's mix of two widgets that lie one behind the other does not see which is in front.
#[test]
fn mix_forgets_the_order() {
    let (mut red, mut blue) = (gaussian(0.25, 0.05, 30.0), gaussian(0.75, 0.05, 30.0));
    (red.color, blue.color) = ([1.0, 0.0, 0.0], [0.0, 0.0, 1.0]);
    let looks = look(vec![red, blue]);
    let exact = integrate(&segment(1.0, 0.0, 1.0), &looks, WidgetBlend::Exact).expect("integrates");
    let mix = integrate(&segment(1.0, 0.0, 1.0), &looks, WidgetBlend::Mix).expect("integrates");
    assert!(exact.color[0] > 5.0 * exact.color[2]);
    assert!((mix.color[0] - mix.color[2]).abs() < 1e-12 && (mix.opacity - exact.opacity).abs() < 1e-12);
    assert!((mix.color[0] - 0.5 * mix.opacity).abs() < 1e-12);
}

#[test]
fn what_is_missing_is_said() {
    let volume = cube([1, 1, 1], 1.0, DVec3::ZERO);
    let view = camera(1.0, DVec3::ZERO, [4, 4]);
    let error = |looks: TransferFunction, shading: Shading| {
        draw(&scene(volume.clone(), looks, view, shading), &NoProgress).expect_err("refuses").to_string()
    };
    let mut both = gaussian(0.5, 0.1, 1.0);
    if let Profile::Gaussian { matrix, .. } = &mut both.profile {
        matrix[1][1] = 1.0;
    }
    assert!(error(look(vec![both]), PLAIN).contains("gradient magnitude"));
    let unlimited = Widget { region: None, ..uniform(1.0) };
    assert!(error(look(vec![unlimited]), PLAIN).contains("no region"));
    assert!(error(look(vec![]), Shading { silhouette: Some(1.0), ..PLAIN }).contains("gradient"));
    struct Stop;
    impl Progress for Stop {
        fn report(&self, _: &str, _: f64) {}
        fn cancelled(&self) -> bool {
            true
        }
    }
    let looks = look(vec![uniform(1.0)]);
    let stopped = draw(&scene(volume, looks, view, PLAIN), &Stop).expect_err("stops");
    assert_eq!(stopped.kind, voltet_core::error::ErrorKind::Cancelled);
}

/// Entries of one face, found twice, are apart by roundings, and then the exits decide; what is apart by more is not.
#[test]
fn crossings_are_in_the_order_of_their_entries_but_for_rounding() {
    let volume = cube([1, 1, 1], 1.0, DVec3::ZERO);
    let scene = scene(volume, look(vec![uniform(1.0)]), camera(1.0, DVec3::ZERO, [1, 1]), PLAIN);
    let tracer = tracer(&scene).expect("is a scene");
    for (apart, expected) in [(5e-13, [0, 1]), (2e-14, [1, 0])] {
        let crossing = |cell, depth| Crossing { cell, depth, weights: [[0.25; 4]; 2] };
        let mut found = [crossing(1, [1.0 + apart, 2.0]), crossing(0, [1.0, 3.0])];
        tracer.sort(&mut found);
        assert_eq!(found.map(|crossing| crossing.cell), expected, "{apart:e} apart");
    }
}

/// Compositing goes on until less than 1e-22 is left: a black wall of depth 49 leaves 5e-22 of what lies behind it.
#[test]
fn what_is_behind_a_wall_is_seen_through_it() {
    let mut volume = cube([1, 2, 1], 1.0, DVec3::ZERO);
    volume.scalar = volume.grid.points.iter().map(|p| p.y).collect();
    let layer = |s: [f64; 2], extinction, color| {
        let region = Some(Region::rectangle(s, [f64::NEG_INFINITY, f64::INFINITY]));
        Widget { color, region, ..uniform(extinction) }
    };
    let looks = look(vec![layer([-1.0, 0.5], 98.0, [0.0; 3]), layer([0.5, 2.0], 2.0, [1.0; 3])]);
    let scene = scene(volume, looks, camera(1.0, DVec3::ZERO, [1, 1]), PLAIN);
    let tracer = tracer(&scene).expect("is a scene");
    let seen = tracer.trace(&tracer.ray(0.51, 0.503)).expect("traces").color[0];
    let exact = -(-49f64).exp() * (-1f64).exp_m1();
    assert!((seen / exact - 1.0).abs() < 1e-10, "{seen:e} for {exact:e}");
}
