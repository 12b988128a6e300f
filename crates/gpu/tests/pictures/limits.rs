//! Scenes that the device refuses, orders that are not exact, overlaps mixed, and frames after the first.

use crate::drawing::{device, draw, draw_tiles, try_draw};
use std::sync::Arc;
use voltet_core::transfer::{OpticalModel, TransferFunction};
use voltet_gpu::{Device, FrameOutput, Renderer};
use voltet_optics::WidgetBlend;
use voltet_optics::shading::{Shading, VisibilityOrder};
use voltet_reference::REFERENCE;
use voltet_testing::pictures::compare::{NamedScene, ORDINARY, SHADING, referee, within};
use voltet_testing::pictures::grids::{cube, smooth};
use voltet_testing::pictures::looks::*;
use voltet_testing::pictures::widgets;

fn scene(look: TransferFunction) -> NamedScene {
    NamedScene {
        name: "limits".into(),
        volume: smooth(cube([6, 6, 6], 0.3)),
        look,
        camera: outside([32, 32]),
    }
}

fn refused(scene: &NamedScene, shading: &Shading, words: &[&str]) {
    let Some(outcome) = try_draw(scene, shading, VisibilityOrder::Exact) else { return };
    let error = outcome.expect_err("refused").to_string();
    for word in words {
        assert!(error.contains(word), "'{word}' is not in: {error}");
    }
}

#[test]
fn what_32_bits_cannot_hold_is_refused() {
    let narrow = look(vec![gaussian([0.6, 0.8], [1e-7, 2.0], 1e8, [1.0, 0.5, 0.15])]);
    refused(&scene(narrow), &SHADING, &["narrower than 32 bits", "widgets[0]", "cpu"]);
    let mut far = scene(one_gaussian());
    far.camera = perspective([-900.0, -1100.0, 1400.0], [0.5, 0.5, 0.5], 1e-6, [32, 32]);
    refused(&far, &SHADING, &["view is too narrow", "cpu"]);
    let shading = Shading { integrator: REFERENCE, ..SHADING };
    refused(&scene(one_gaussian()), &shading, &["reference"]);
    let mut without = scene(one_gaussian());
    let mut volume = (*without.volume).clone();
    volume.gradient_magnitude = None;
    without.volume = Arc::new(volume);
    refused(&without, &SHADING, &["gradient magnitude"]);
}

#[test]
fn an_adapter_that_is_not_there_is_named_with_those_that_are() {
    let error =
        Device::open(Some("no such thing"), false).map(|device| device.name.clone()).expect_err("none");
    assert!(error.to_string().contains("no such thing"), "{error}");
}

/// The exact order leaves no pixel disordered; centroids are wrong somewhere in a jittered grid, grid order in more
/// places; and where the colour is one, no order is wrong.
#[test]
fn disordered_pixels_are_counted() {
    let disordered = |order, look| {
        draw(&scene(look), &SHADING, order).map(|d| d.counts.pixels_disordered.expect("tiles count"))
    };
    let Some(exact) = disordered(VisibilityOrder::Exact, overlapping()) else { return };
    let centroid = disordered(VisibilityOrder::Centroid, overlapping()).unwrap_or(0);
    let none = disordered(VisibilityOrder::Unsorted, overlapping()).unwrap_or(0);
    assert_eq!(exact, 0);
    assert!(0 < centroid && centroid < none, "centroid {centroid}, none {none}");
    assert_eq!(disordered(VisibilityOrder::Unsorted, one_gaussian()), Some(0));
}

/// A grid that stays on the device draws the same again, and another look as if it had been uploaded for it.
#[test]
fn frames_after_the_first() {
    let Some(device) = device() else { return };
    let scene = scene(overlapping());
    let renderer = Renderer::new(device, &scene.volume).expect("fits");
    let picture = |look: &TransferFunction| {
        let scene = NamedScene { look: look.clone(), ..scene.clone() };
        draw_tiles(&renderer, &scene, &SHADING, VisibilityOrder::Exact).expect("draws").picture
    };
    let before = picture(&scene.look);
    for look in [
        one_gaussian(),
        ramp(),
        TransferFunction { model: OpticalModel::ConstantEmitter { cutoff: 0.1 }, ..ramp() },
    ] {
        let fresh =
            draw(&NamedScene { look: look.clone(), ..scene.clone() }, &SHADING, VisibilityOrder::Exact);
        // Sums of one colour are free of order, and so of rounding's: lists are filled in any order.
        within("another look", &picture(&look), &fresh.expect("draws").picture, 1e-6);
    }
    assert_eq!(picture(&scene.look).rgba, before.rgba);
}

/// Lists and pictures that do not fit one binding are drawn in windows.
#[test]
fn small_bindings_draw_in_windows() {
    if device().is_none() {
        return;
    }
    let small = |scene: &NamedScene, bytes| {
        let wish = std::env::var("VOLTET_ADAPTER").ok();
        let device = Device::open(wish.as_deref(), false)
            .expect("opened before")
            .with_limits(|limits| limits.max_storage_buffer_binding_size = bytes);
        let renderer = Renderer::new(Arc::new(device), &scene.volume)?;
        draw_tiles(&renderer, scene, &SHADING, VisibilityOrder::Exact)
    };
    // 1,296 cells of 16 bytes fit, 48 × 40 pixels of 16 bytes do not; and of 600 cells along the view, that all tiles
    // list, the lists do not. Where one of nine tiles lists 1,320, and goes on in another dispatch, the states of all
    // pixels do not, 32 bytes each.
    let wide = NamedScene { camera: outside([48, 40]), ..scene(overlapping()) };
    let along = orthographic([0.5, -2.0, 0.5], [0.5, 0.0, 0.5], 0.9, [16, 16]);
    let deep = NamedScene { volume: smooth(cube([1, 100, 1], 0.2)), camera: along, ..scene(overlapping()) };
    let one_tile = orthographic([0.5, -2.0, 0.5], [0.5, 0.0, 0.5], 3.3, [24, 24]);
    let thin = look(overlapping().widgets.iter().map(|widget| widget.with_extinction_times(0.1)).collect());
    let one_tile =
        NamedScene { volume: smooth(cube([1, 220, 1], 0.2)), look: thin, camera: one_tile, ..deep.clone() };
    for (scene, bytes, lists) in [(&wide, 24_000, false), (&deep, 12_000, true), (&one_tile, 12_000, false)] {
        let whole = draw(scene, &SHADING, VisibilityOrder::Exact).expect("draws");
        assert_eq!(whole.tile_entries * 8 > bytes, lists, "{:?}", whole.counts);
        let windows = small(scene, bytes).expect("draws in windows");
        assert_eq!(windows.counts.segments, whole.counts.segments);
        assert_eq!(windows.picture.rgba, whole.picture.rgba);
        let cells = |drawn: &FrameOutput| {
            let counts = drawn.counts;
            [
                counts.culled_by_transfer_function,
                counts.culled_by_frustum,
                counts.under_a_pixel,
                counts.cells_projected,
            ]
            .map(|count| count.expect("is counted"))
        };
        assert_eq!(cells(&windows), cells(&whole));
        assert_eq!(cells(&whole).iter().sum::<u64>(), scene.volume.grid.tetrahedra.len() as u64);
    }
}

#[test]
fn nothing_draws_nothing() {
    let empty = voltet_testing::pictures::grids::volume(
        voltet_testing::pictures::grids::grid(Vec::new(), Vec::new()),
        |_| 0.0,
        |_| 0.0,
    );
    for (volume, look) in [(empty, overlapping()), (smooth(cube([2, 2, 2], 0.0)), look(Vec::new()))] {
        let scene = NamedScene { name: "nothing".into(), volume, look, camera: outside([20, 12]) };
        let Some(drawn) = draw(&scene, &SHADING, VisibilityOrder::Exact) else { return };
        assert_eq!(drawn.counts.segments, Some(0));
        assert!(drawn.picture.rgba.iter().all(|pixel| *pixel == [0.0; 4]));
    }
}

#[test]
fn all_mixed() {
    let mix = Shading { overlap: WidgetBlend::Mix, ..SHADING };
    // The mix leaves out the order of widgets within a segment, and the referee does not: 1e-2 here.
    let scene = widgets::scene("all mixed".into(), widgets::all());
    let Some(drawn) = draw(&scene, &mix, VisibilityOrder::Exact) else { return };
    within("all mixed", &drawn.picture, &referee(&scene), 2e-2);
}

/// Tiles whose pixels are opaque look at no further cell, whatever the order; the picture is the referee's all the same.
#[test]
fn opaque_tiles_stop_early() {
    let fog = |extinction, other| {
        let looks = look(vec![everywhere(extinction, [1.0, 0.5, 0.25]), everywhere(extinction, other)]);
        NamedScene {
            name: format!("fog {extinction} {other:?}"),
            volume: smooth(cube([10, 10, 10], 0.2)),
            look: looks,
            camera: perspective([0.5, -2.0, 0.5], [0.5, 0.0, 0.5], 15.0, [24, 16]),
        }
    };
    for (other, order) in [
        ([1.0, 0.5, 0.25], VisibilityOrder::Exact),
        ([0.2, 0.5, 1.0], VisibilityOrder::Exact),
        ([0.2, 0.5, 1.0], VisibilityOrder::Centroid),
    ] {
        let Some(thin) = draw(&fog(1.0, other), &SHADING, order) else { return };
        assert_eq!((thin.counts.tiles_stopped, thin.counts.cells_hidden), (Some(0), Some(0)));
        let dense = fog(1e4, other);
        let drawn = draw(&dense, &SHADING, order).expect("drew before");
        // All of 3 × 2.
        assert_eq!(drawn.counts.tiles_stopped, Some(6), "{order:?}");
        assert!(drawn.counts.cells_hidden > Some(0) && drawn.counts.segments < thin.counts.segments);
        within(&dense.name, &drawn.picture, &referee(&dense), ORDINARY);
    }
}
