//! Cells blended in exact order along their faces: the referee's pictures where there is such an order, those of tiles where not.

use crate::drawing::{device, draw_on, further_device, raster, tiles};
use std::sync::Arc;
use voltet_core::camera::Camera;
use voltet_core::progress::NoProgress;
use voltet_core::transfer::TransferFunction;
use voltet_gpu::{FrameOutput, Renderer};
use voltet_optics::engine::{Accumulation, Compositor, OrderCheck, RenderOptions};
use voltet_optics::shading::VisibilityOrder;
use voltet_testing::pictures::compare::{NamedScene, ORDINARY, SHADING, referee, within};
use voltet_testing::pictures::grids::*;
use voltet_testing::pictures::looks::*;

/// Blended in exact order, checked at every pixel.
fn counted(compositing: Compositor) -> RenderOptions {
    RenderOptions {
        order_check: OrderCheck::Count,
        compositing: Some(compositing),
        ..RenderOptions::default()
    }
}

/// Cells of every shape, none of which is turned over.
fn jittered(look: TransferFunction, camera: Camera) -> NamedScene {
    NamedScene { name: "jittered".into(), volume: smooth(cube([6, 6, 6], 0.2)), look, camera }
}

fn draw(renderer: &Renderer, scene: &NamedScene, options: &RenderOptions) -> FrameOutput {
    let wanted = scene.drawn_by(&SHADING, VisibilityOrder::Exact);
    voltet_gpu::draw(renderer, &wanted, options, &NoProgress)
        .unwrap_or_else(|e| panic!("{}: {e}", scene.name))
}

/// Grids without and with gaps, from everywhere: the order is exact at every pixel, and the picture that of the referee.
#[test]
fn what_is_blended_is_exact() {
    let Some(device) = device() else { return };
    let outside = outside([40, 32]);
    let apart = together(&[0.0, 0.6].map(|x| moved(&cube([2, 3, 2], 0.2), |p| 0.4 * p + x)));
    let views = [
        ("outside", outside),
        ("parallel", orthographic([3.0, -2.0, 2.5], [0.5, 0.5, 0.5], 1.9, [32, 40])),
        ("inside", perspective([0.43, 0.37, 0.52], [0.9, 0.8, 0.45], 90.0, [40, 32])),
        ("near", Camera { near: 1.6, ..outside }),
        ("samples", Camera { samples: 3, size: [20, 16], ..outside }),
    ];
    for (name, grid) in [("cube", cube([5, 5, 5], 0.25)), ("arms", two_arms()), ("apart", apart)] {
        let volume = smooth(grid);
        let renderer = Renderer::new(device.clone(), &volume).expect("fits");
        for (view, camera) in views {
            let (name, volume) = (format!("{name} {view}"), volume.clone());
            let scene = NamedScene { name, volume, look: overlapping(), camera };
            let drawn = draw(&renderer, &scene, &counted(Compositor::Raster));
            assert_eq!(drawn.tiles_instead, None, "{}", scene.name);
            assert_eq!(drawn.counts.pixels_disordered, Some(0), "{}", scene.name);
            let checked = drawn.along_faces.and_then(|along| along.checked).expect("is checked");
            assert!(checked.pixels > 0 && checked.largest < 2e-5, "{}: {checked:?}", scene.name);
            within(&scene.name, &drawn.picture, &referee(&scene), ORDINARY);
            // Triangles are off at rims, whatever their order.
            let drawn = draw(&renderer, &scene, &counted(Compositor::Triangles));
            assert_eq!(drawn.counts.pixels_disordered, Some(0), "{}", scene.name);
            within(&scene.name, &drawn.picture, &referee(&scene), 1.0 / 255.0);
        }
    }
}

/// Bars in a circle have no order: tiles draw them, and say so, or refuse what they do not have.
#[test]
fn circles_are_drawn_by_tiles() {
    let Some(device) = device() else { return };
    let camera = orthographic([0.01, 0.02, 5.0], [0.0, 0.0, 0.0], 4.0, [64, 64]);
    let scene =
        NamedScene { name: "bars".into(), volume: smooth(cyclic_bars()), look: overlapping(), camera };
    let expected = draw_on(device.clone(), &scene, &SHADING, tiles(VisibilityOrder::Exact)).expect("draws");
    for compositing in [Compositor::Raster, Compositor::Triangles] {
        let found =
            draw_on(device.clone(), &scene, &SHADING, (compositing, VisibilityOrder::Exact)).expect("draws");
        let why = found.tiles_instead.expect("is said");
        assert!(why.contains("circles") && why.contains("no order"), "{why}");
        assert_eq!(found.picture.rgba, expected.picture.rgba);
        assert!(found.along_faces.is_none() && found.counts.segments == expected.counts.segments);
    }
    let renderer = Renderer::new(device, &scene.volume).expect("fits");
    let eight = RenderOptions {
        accumulation: Accumulation::Bits8,
        compositing: Some(Compositor::Raster),
        ..RenderOptions::default()
    };
    let wanted = scene.drawn_by(&SHADING, VisibilityOrder::Exact);
    let error = voltet_gpu::draw(&renderer, &wanted, &eight, &NoProgress).expect_err("refused").to_string();
    for word in ["circles", "8-bit", "centroid"] {
        assert!(error.contains(word), "'{word}' is not in: {error}");
    }
}

/// The order is found and sent once for an eye: a widget that moves sends what the frame is told.
#[test]
fn an_order_is_kept() {
    if device().is_none() {
        return;
    }
    let device = Arc::new(further_device());
    let scene = jittered(overlapping(), outside([40, 32]));
    let cells = scene.volume.grid.tetrahedra.len() as u64;
    let renderer = Renderer::new(device.clone(), &scene.volume).expect("fits");
    let sent = |scene: &NamedScene| {
        let before = device.work().bytes_uploaded;
        let drawn = draw(
            &renderer,
            scene,
            &RenderOptions { compositing: Some(Compositor::Raster), ..RenderOptions::default() },
        );
        let made = drawn.passes.iter().any(|part| part.pass == Some("faces (CPU)"));
        (made, device.work().bytes_uploaded - before)
    };
    let (made, bytes) = sent(&scene);
    assert!(made && bytes > 4 * cells);
    // Another look, and another picture from the same eye.
    let wider = Camera { size: [30, 24], ..scene.camera };
    for scene in [NamedScene { look: ramp(), ..scene.clone() }, NamedScene { camera: wider, ..scene.clone() }]
    {
        let (made, bytes) = sent(&scene);
        assert!(!made && bytes < 2048, "{bytes} bytes");
    }
    let elsewhere = perspective([-2.0, 3.0, 1.0], [0.5, 0.5, 0.5], 35.0, [40, 32]);
    let (made, bytes) = sent(&NamedScene { camera: elsewhere, ..scene });
    assert!(made && (4 * cells..4 * cells + 2048).contains(&bytes), "{bytes} bytes");
}

/// Pictures in windows, and in runs of any length.
#[test]
fn windows_and_runs_keep_the_order() {
    let Some(device) = device() else { return };
    let scene = jittered(overlapping(), outside([48, 40]));
    let whole = draw_on(device.clone(), &scene, &SHADING, raster(VisibilityOrder::Exact)).expect("draws");
    let runs = Renderer::new(device, &scene.volume).expect("fits").with_runs_of(100);
    let drawn = draw(
        &runs,
        &scene,
        &RenderOptions { compositing: Some(Compositor::Raster), ..RenderOptions::default() },
    );
    assert_eq!(drawn.picture.rgba, whole.picture.rgba);
    let windows = Arc::new(further_device().with_limits(|limits| limits.max_texture_dimension_2d = 16));
    let drawn = draw_on(windows, &scene, &SHADING, raster(VisibilityOrder::Exact)).expect("draws");
    // Coordinates within a window round otherwise than those of the picture.
    within("windows", &drawn.picture, &whole.picture, 1e-6);
}
