//! The raster compositor, held against the referee: scenes of one colour, which need no order, and stacks of cells whose
//! centroids are in the order of their entries.

use crate::drawing::{device, draw_on, further_device, raster, tiles};
use glam::DVec3;
use std::sync::Arc;
use voltet_core::camera::Camera;
use voltet_core::grid::Grid;
use voltet_core::picture::Picture;
use voltet_core::progress::NoProgress;
use voltet_core::transfer::TransferFunction;
use voltet_core::volume::Volume;
use voltet_gpu::{FrameOutput, Renderer};
use voltet_integrators::{pre_integrated, pre_integrated_cylindrical, riemann, segments};
use voltet_optics::engine::{Compositor, RenderOptions};
use voltet_optics::shading::{Integrator, Light, Shading, VisibilityOrder};
use voltet_testing::pictures::compare::{NamedScene, ORDINARY, SHADING, referee_shaded, within};
use voltet_testing::pictures::grids::*;
use voltet_testing::pictures::looks::*;

fn draw(scene: &NamedScene, shading: &Shading, order: VisibilityOrder) -> Option<FrameOutput> {
    let drawn = draw_on(device()?, scene, shading, raster(order));
    let drawn = drawn.unwrap_or_else(|e| panic!("{}: {e}", scene.name));
    assert_eq!(drawn.compositing, Compositor::Raster, "{}", scene.name);
    Some(drawn)
}

/// Asserts the bound of ordinary scenes, and that there is something to see.
fn ordinary(scene: &NamedScene, shading: &Shading, order: VisibilityOrder) {
    let Some(drawn) = draw(scene, shading, order) else { return };
    let expected = referee_shaded(scene, shading);
    assert!(expected.rgba.iter().any(|p| p[3] > 0.01), "{}: nothing to see", scene.name);
    within(&scene.name, &drawn.picture, &expected, ORDINARY);
}

/// One cell alone.
pub fn cell(corners: [[f64; 3]; 4]) -> Grid {
    grid(corners.map(DVec3::from).to_vec(), vec![[0, 1, 2, 3]])
}

/// Cells of each class of Shirley and Tuchman, by name.
pub fn classes() -> [(&'static str, [[f64; 3]; 4]); 7] {
    let [a, b, c] = [[0.1, 0.0, 0.1], [0.9, 0.0, 0.15], [0.4, 0.05, 0.9]];
    [
        // The fourth corner before the triangle of the others, and behind it.
        ("three triangles", [a, b, c, [0.45, -0.4, 0.4]]),
        ("three triangles behind", [a, b, c, [0.45, 0.6, 0.4]]),
        // Two edges cross.
        ("four triangles", [a, b, c, [0.8, 0.5, 0.8]]),
        // A corner behind an edge: a face seen as a line.
        ("edge-on", [a, b, c, [0.5, 0.5, 0.125]]),
        // A corner behind another.
        ("two triangles", [a, b, c, [0.1, 0.5, 0.1]]),
        ("flat", [a, b, c, [0.45, 1e-5, 0.4]]),
        ("sliver", [a, [0.9, 0.0, 0.9], [0.5, 0.1, 0.54], [0.5, 0.5, 0.46]]),
    ]
}

/// Views of them: both sides, by parallel rays and in perspective.
pub fn views() -> [(&'static str, Camera); 3] {
    [
        ("ortho", orthographic([0.503, -2.0, 0.507], [0.503, 0.0, 0.507], 1.1, [33, 33])),
        ("perspective", perspective([0.5, -1.5, 0.5], [0.5, 0.0, 0.5], 45.0, [33, 33])),
        ("from behind", perspective([0.45, 2.0, 0.55], [0.5, 0.0, 0.5], 40.0, [33, 33])),
    ]
}

/// One cell of each class of Shirley and Tuchman, in all orders of its corners, from both sides.
#[test]
fn single_cells_of_every_class() {
    for (class, corners) in classes() {
        for turn in 0..4 {
            let mut turned = corners;
            turned.rotate_left(turn);
            if turn % 2 == 1 {
                turned.swap(0, 1);
            }
            for (view, camera) in views() {
                // No pixel's ray runs within the edge of a region.
                let volume = volume(cell(turned), |p| 0.51 + 0.393 * p.x, |p| 0.8 + 0.117 * p.z);
                let name = format!("{class} {turn} {view}");
                let shown = NamedScene { name, volume, look: overlapping(), camera };
                let Some(drawn) = draw(&shown, &SHADING, VisibilityOrder::Centroid) else { return };
                within(&shown.name, &drawn.picture, &referee_shaded(&shown, &SHADING), ORDINARY);
                let looked = NamedScene { look: look(vec![everywhere(2.0, [1.0, 0.5, 0.2])]), ..shown };
                ordinary(&looked, &SHADING, VisibilityOrder::Exact);
            }
        }
    }
}

fn one_color() -> [(&'static str, TransferFunction); 2] {
    [("gaussian", one_gaussian()), ("uniform", look(vec![everywhere(2.0, [1.0, 0.5, 0.25])]))]
}

fn with_one_color(name: &str, camera: Camera) {
    for (kind, look) in one_color() {
        let (name, volume) = (format!("{name} {kind}"), smooth(cube([6, 6, 6], 0.2)));
        ordinary(&NamedScene { name, volume, look, camera }, &SHADING, VisibilityOrder::Exact);
    }
}

#[test]
fn one_color_from_every_view() {
    with_one_color("outside", outside([64, 48]));
    with_one_color("ortho", orthographic([3.0, -2.0, 2.5], [0.5, 0.5, 0.5], 1.9, [48, 64]));
    with_one_color("wide", perspective([0.5, -0.05, 0.5], [0.5, 0.5, 0.5], 150.0, [48, 48]));
    with_one_color("tele", perspective([-900.0, -1100.0, 1400.0], [0.5, 0.5, 0.5], 0.06, [48, 48]));
    for size in [[1, 1], [17, 15], [120, 2], [1, 90]] {
        with_one_color(&format!("size {}x{}", size[0], size[1]), outside(size));
    }
}

#[test]
fn eye_inside_and_near_planes() {
    let inside = perspective([0.43, 0.37, 0.52], [0.9, 0.8, 0.45], 90.0, [48, 48]);
    with_one_color("inside", inside);
    with_one_color("inside near", Camera { near: 0.2, ..inside });
    with_one_color("inside ortho", orthographic([0.43, 0.37, 0.52], [0.9, 0.8, 0.45], 1.2, [48, 48]));
    with_one_color("near", Camera { near: 1.3, ..outside([48, 48]) });
    let ortho = orthographic([3.0, -2.0, 2.5], [0.5, 0.5, 0.5], 1.9, [48, 48]);
    with_one_color("near ortho", Camera { near: 3.9, ..ortho });
}

/// No pixel twice or missed where rays run in faces and edges that cells share: 1 − e^(−ρ) in each.
#[test]
fn rays_in_shared_faces_and_edges() {
    for counts in [[1, 1, 1], [2, 2, 2], [4, 4, 4], [5, 3, 7]] {
        for pixels in [8u32, 9, 20, 35] {
            let scene = NamedScene {
                name: format!("faces {counts:?} {pixels}"),
                volume: volume(cube(counts, 0.0), |_| 0.5, |_| 0.0),
                look: look(vec![everywhere(2.0, [1.0; 3])]),
                camera: orthographic([0.5, -2.0, 0.5], [0.5, 0.0, 0.5], 1.0, [pixels, pixels]),
            };
            let Some(drawn) = draw(&scene, &SHADING, VisibilityOrder::Exact) else { return };
            let n = pixels as usize;
            let known = Picture { width: n, height: n, rgba: vec![[-(-2f64).exp_m1() as f32; 4]; n * n] };
            // Rounding of a dozen 32-bit segments, whose ends round like the grid's diagonal.
            within(&scene.name, &drawn.picture, &known, 5e-6);
        }
    }
}

#[test]
fn holes_flat_cells_and_far_places() {
    let shown = |name: &str, volume, camera| {
        ordinary(
            &NamedScene { name: name.into(), volume, look: one_gaussian(), camera },
            &SHADING,
            VisibilityOrder::Exact,
        );
    };
    shown("arms", smooth(two_arms()), perspective([0.7, -2.0, 0.8], [0.5, 0.5, 0.5], 35.0, [56, 48]));
    for thickness in [1e-3, 1e-6, 1e-12, 0.0] {
        for (name, camera) in [
            ("across", orthographic([-2.0, 0.503, 0.507], [0.0, 0.503, 0.507], 0.9, [32, 32])),
            ("along", orthographic([0.503, -2.0, 0.507], [0.503, 0.0, 0.507], 0.9, [32, 32])),
            ("oblique", outside([40, 40])),
        ] {
            shown(&format!("flat {thickness:e} {name}"), smooth(with_flat_layer(thickness)), camera);
        }
    }
    let ortho = orthographic([3.1, -2.0, 2.5], [0.51, 0.52, 0.53], 40.0, [21, 21]);
    shown("tiny cells", smooth(cube([12, 12, 12], 0.2)), ortho);
    let corners = [[-50.0, 10.0, -50.0], [60.0, 11.0, -45.0], [1.0, 12.0, 70.0], [0.0, 30.0, 2.0]];
    let huge = volume(cell(corners), |p| 0.5 + 0.01 * p.x, |p| 0.8 + 0.01 * p.z);
    for eye in [[0.0, 0.0, 0.0], [0.0, 14.0, 2.0]] {
        shown("huge cell", huge.clone(), perspective(eye, [0.0, 40.0, 1.0], 30.0, [56, 40]));
    }
}

/// Slabs of cells one behind the other, each a convex part: where no ray meets two cells of one slab, centroids are in
/// the order of the entries.
fn stack() -> Grid {
    let slab = |k: usize| {
        let y = 0.1 * k as f64;
        cell([[-0.4, y, -0.3], [1.5, y + 0.02, -0.35], [0.5, y + 0.01, 1.6], [0.45, y + 0.09, 0.4]])
    };
    together(&(0..9).map(slab).collect::<Vec<_>>())
}

#[test]
fn a_stack_in_the_order_of_its_centroids_is_exact() {
    let volume = volume(stack(), |p| 0.5 + 0.4 * (9.0 * p.y).sin(), |p| 0.5 + p.x);
    for (view, camera) in [
        ("ortho", orthographic([0.5, -2.0, 0.5], [0.5, 0.0, 0.5], 1.2, [40, 32])),
        ("perspective", perspective([0.5, -2.0, 0.5], [0.5, 0.0, 0.5], 30.0, [40, 32])),
        ("from behind", perspective([0.5, 3.0, 0.5], [0.5, 0.0, 0.5], 20.0, [40, 32])),
    ] {
        for (kind, look) in [("ramp", ramp()), ("overlap", overlapping())] {
            let (name, volume) = (format!("stack {view} {kind}"), volume.clone());
            ordinary(&NamedScene { name, volume, look, camera }, &SHADING, VisibilityOrder::Centroid);
        }
    }
}

/// Cells of every shape, in no order of their own.
pub fn jittered(look: TransferFunction, camera: Camera) -> NamedScene {
    NamedScene { name: "jittered".into(), volume: smooth(cube([6, 6, 6], 0.3)), look, camera }
}

/// The order of centroids, and that of the grid, are those of the tiles, over all bits of the key.
#[test]
fn orders_are_those_of_tiles() {
    let Some(device) = device() else { return };
    for camera in [outside([40, 32]), orthographic([3.0, -2.0, 2.5], [0.5, 0.5, 0.5], 1.9, [32, 40])] {
        for order in [VisibilityOrder::Centroid, VisibilityOrder::Unsorted] {
            // More cells than a block of the sort holds.
            let scene =
                NamedScene { volume: smooth(cube([10, 9, 9], 0.3)), ..jittered(overlapping(), camera) };
            let tiles = draw_on(device.clone(), &scene, &SHADING, tiles(order)).expect("draws");
            let raster = draw_on(device.clone(), &scene, &SHADING, raster(order)).expect("draws");
            // Tiles give up what is behind 1 − 1e-6, and count from the front.
            within(&format!("{order:?}"), &raster.picture, &tiles.picture, 1e-5);
            assert_eq!((raster.counts.segments, raster.counts.pixels_disordered), (None, None));
            assert_eq!(raster.counts.cells_projected, tiles.counts.cells_projected);
        }
    }
}

/// What blends has no order of its own for each pixel: tiles draw, and the output says so.
#[test]
fn an_exact_order_is_that_of_tiles() {
    let Some(device) = device() else { return };
    let scene = jittered(overlapping(), outside([40, 32]));
    let expected = draw_on(device.clone(), &scene, &SHADING, tiles(VisibilityOrder::Exact)).expect("draws");
    for how in [raster(VisibilityOrder::Exact), (Compositor::Triangles, VisibilityOrder::Exact)] {
        let found = draw_on(device.clone(), &scene, &SHADING, how).expect("draws");
        assert_eq!(found.compositing, Compositor::Tiles);
        assert_eq!((found.counts, found.picture.rgba), (expected.counts, expected.picture.rgba.clone()));
    }
    // One colour needs none; where nothing is left out, it is blended in that of centroids.
    let scene = jittered(one_gaussian(), outside([40, 32]));
    let renderer = Renderer::new(device, &scene.volume).expect("fits");
    for exhaustive in [false, true] {
        let options =
            RenderOptions { exhaustive, compositing: Some(Compositor::Raster), ..RenderOptions::default() };
        let wanted = scene.drawn_by(&SHADING, VisibilityOrder::Exact);
        let found = voltet_gpu::draw(&renderer, &wanted, &options, &NoProgress).expect("draws");
        assert_eq!(found.compositing, Compositor::Raster);
        within("one colour", &found.picture, &referee_shaded(&scene, &SHADING), ORDINARY);
    }
}

#[test]
fn several_samples_a_pixel() {
    for samples in [4, 3] {
        with_one_color(&format!("{samples} samples"), Camera { samples, ..outside([32, 24]) });
    }
}

/// Runs of any length, the last one short, and pictures in windows are the picture in one.
#[test]
fn runs_and_windows_change_nothing() {
    let Some(device) = device() else { return };
    let scene = jittered(overlapping(), outside([48, 40]));
    let whole = draw_on(device.clone(), &scene, &SHADING, raster(VisibilityOrder::Centroid)).expect("draws");
    for length in [7, 100, 1296] {
        let runs = Renderer::new(device.clone(), &scene.volume).expect("fits").with_runs_of(length);
        let wanted = scene.drawn_by(&SHADING, VisibilityOrder::Centroid);
        let drawn = voltet_gpu::draw(
            &runs,
            &wanted,
            &RenderOptions { compositing: Some(Compositor::Raster), ..RenderOptions::default() },
            &NoProgress,
        )
        .expect("draws");
        assert_eq!(drawn.picture.rgba, whole.picture.rgba, "{length}");
    }
    for windows in [
        further_device().with_limits(|limits| limits.max_storage_buffer_binding_size = 24_000),
        further_device().with_limits(|limits| limits.max_texture_dimension_2d = 16),
    ] {
        let drawn =
            draw_on(Arc::new(windows), &scene, &SHADING, raster(VisibilityOrder::Centroid)).expect("draws");
        // Coordinates within a window round otherwise than those of the picture.
        within("windows", &drawn.picture, &whole.picture, 1e-6);
    }
}

/// Targets of 16 bits hold 11 digits: some thousandths after dozens of segments; and it is said.
#[test]
fn sixteen_bits_are_near_and_said() {
    let Some(device) = device() else { return };
    let narrow = Arc::new(further_device().blending_16_bits());
    for (look, order) in
        [(overlapping(), VisibilityOrder::Centroid), (one_gaussian(), VisibilityOrder::Exact)]
    {
        let scene = jittered(look, outside([32, 24]));
        let wide = draw_on(device.clone(), &scene, &SHADING, raster(order)).expect("draws");
        let half = draw_on(narrow.clone(), &scene, &SHADING, raster(order)).expect("draws");
        assert!(half.blended_in_16_bits);
        within("16 bits", &half.picture, &wide.picture, 1e-2);
        assert_ne!(half.picture.rgba, wide.picture.rgba);
    }
}

/// Neither compositor's passes are compiled for the other, nor a sort where no order is needed.
#[test]
fn what_is_not_asked_for_is_not_compiled() {
    if device().is_none() {
        return;
    }
    let first = ["bound_cells", "place_attribute", "see_points"];
    let lists = ["composite_tiles", "fill_lists", "start_lists"];
    let drawn = ["aim_runs", "blend_cell", "count_digits", "move_digits", "place_digits", "take_blended"];
    let mut triangles = drawn.map(|name| if name == "blend_cell" { "blend_triangle" } else { name }).to_vec();
    triangles.push("split_cells");
    for (look, how, further) in [
        (overlapping(), tiles(VisibilityOrder::Exact), [&lists[..], &["sort_lists"]].concat()),
        (one_gaussian(), tiles(VisibilityOrder::Exact), lists.to_vec()),
        (overlapping(), raster(VisibilityOrder::Centroid), drawn.to_vec()),
        (overlapping(), raster(VisibilityOrder::Exact), [&lists[..], &["sort_lists"]].concat()),
        (overlapping(), (Compositor::Triangles, VisibilityOrder::Centroid), triangles.to_vec()),
        (one_gaussian(), raster(VisibilityOrder::Exact), drawn.to_vec()),
    ] {
        let device = Arc::new(further_device());
        let scene = jittered(look, outside([16, 16]));
        let drawn = draw_on(device.clone(), &scene, &SHADING, how).expect("draws");
        // Each pass by its own time, where the adapter has a clock.
        let timed = |pass: &&str| drawn.passes.iter().any(|known| known.pass == Some(pass));
        assert!(drawn.passes.is_empty() || further.iter().all(timed), "{:?}", drawn.passes);
        let mut expected = [&first[..], &further].concat();
        expected.sort_unstable();
        assert_eq!(device.compiled(), expected, "{how:?}");
    }
}

/// Every integrator, light, silhouettes, fields and tables come by composition: the pictures of the tiles in the same
/// order, and of one colour the referee's.
#[test]
fn every_integrator_and_light_is_that_of_tiles() {
    let Some(device) = device() else { return };
    let grid = cube([4, 4, 4], 0.2);
    let gradient = grid.points.iter().map(|&p| smooth_gradient(p)).collect();
    let volume = Arc::new(Volume { gradient: Some(gradient), ..(*smooth(grid)).clone() });
    let light = Some(Light { direction: DVec3::new(0.4, -0.7, 3.5), ambient: 0.3, diffuse: 0.8 });
    let mut shadings = vec![
        Shading { light, ..SHADING },
        Shading { silhouette: Some(1.5), ..SHADING },
        Shading { silhouette: Some(0.5), light, ..SHADING },
    ];
    shadings.extend(
        [
            Integrator::adaptive(1e-4),
            segments(4, 64),
            riemann(8),
            pre_integrated(32, 2),
            pre_integrated_cylindrical(32, 2, 1),
            Integrator::ANALYTIC,
        ]
        .map(|integrator| Shading { integrator, ..SHADING }),
    );
    let camera = outside([32, 28]);
    let mut served = 0;
    for shading in shadings {
        for (kind, look) in [("ramp", ramp()), ("overlap", overlapping()), ("one colour", one_gaussian())] {
            if voltet_gpu::can_serve(&look, &shading).is_err() {
                continue;
            }
            served += 1;
            let scene =
                NamedScene { name: format!("{kind} {shading:?}"), volume: volume.clone(), look, camera };
            let [tiles, raster] = [tiles(VisibilityOrder::Centroid), raster(VisibilityOrder::Centroid)]
                .map(|how| draw_on(device.clone(), &scene, &shading, how).expect("draws").picture);
            // Tiles give up what is behind 1 − 1e-6.
            within(&scene.name, &raster, &tiles, 1e-5);
            if kind == "one colour" && shading.light.is_none() && shading.silhouette.is_some() {
                within(&scene.name, &raster, &referee_shaded(&scene, &shading), ORDINARY);
            }
        }
    }
    // The ramp by all nine, and what tables of the scalar do not serve by the others.
    assert!(served >= 9 + 6, "{served} pictures");
}

/// A grid whose arrays stand in several bindings each.
#[test]
fn a_grid_in_parts_is_the_same() {
    let Some(device) = device() else { return };
    let scene =
        NamedScene { volume: smooth(cube([5, 5, 5], 0.3)), ..jittered(overlapping(), outside([16, 16])) };
    let whole = draw_on(device, &scene, &SHADING, raster(VisibilityOrder::Centroid)).expect("draws");
    // 750 cells of 16 bytes, and as many places of 8 bytes in the sorted list.
    let small = further_device().with_limits(|limits| {
        limits.max_storage_buffer_binding_size = 6200;
        limits.max_storage_buffers_per_shader_stage = 32;
    });
    let parts = draw_on(Arc::new(small), &scene, &SHADING, raster(VisibilityOrder::Centroid))
        .expect("draws in parts");
    within("parts", &parts.picture, &whole.picture, 1e-6);
    // The sorted list stands in one binding.
    let smaller = further_device().with_limits(|limits| {
        limits.max_storage_buffer_binding_size = 5000;
        limits.max_storage_buffers_per_shader_stage = 64;
    });
    let error =
        draw_on(Arc::new(smaller), &scene, &SHADING, raster(VisibilityOrder::Centroid)).expect_err("no room");
    for word in ["sorted cells", "750 cells", "at most 625", "tiles"] {
        assert!(error.to_string().contains(word), "'{word}' is not in: {error}");
    }
}
