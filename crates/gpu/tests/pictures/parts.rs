//! Grids and tables whose arrays stand in several bindings each draw the same as in one.

use crate::drawing::{device, draw, draw_tiles};
use glam::DVec3;
use std::sync::Arc;
use voltet_core::Result;
use voltet_core::grid::generate::box_of_tetrahedra;
use voltet_core::transfer::{Profile, Table, Widget};
use voltet_core::volume::Volume;
use voltet_gpu::{Device, FrameOutput, Renderer};
use voltet_integrators::{pre_integrated, pre_integrated_cylindrical};
use voltet_optics::shading::{Integrator, Light, Shading, VisibilityOrder};
use voltet_testing::pictures::compare::{NamedScene, ORDINARY, SHADING, referee, within};
use voltet_testing::pictures::grids::{cube, smooth, smooth_gradient, volume};
use voltet_testing::pictures::looks::*;

const LIGHT: Light = Light { direction: DVec3::new(1.0, 2.0, 3.0), ambient: 0.2, diffuse: 0.8 };

/// A device whose bindings hold so little, and so few of them.
fn small(bytes: u64, count: u32) -> Device {
    let wish = std::env::var("VOLTET_ADAPTER").ok();
    let device = Device::open(wish.as_deref(), false).expect("opened before");
    device.with_limits(|limits| {
        limits.max_storage_buffer_binding_size = bytes;
        limits.max_storage_buffers_per_shader_stage = count;
    })
}

fn draw_on(
    device: Device,
    scene: &NamedScene,
    shading: &Shading,
    order: VisibilityOrder,
) -> Result<FrameOutput> {
    let renderer = Renderer::new(Arc::new(device), &scene.volume)?;
    draw_tiles(&renderer, scene, shading, order)
}

/// 1,100 points and 4,860 cells. Bindings of 8 KiB hold 341 positions, 1,024 values, 512 points as they are seen or
/// their four attributes, 512 cells and 1,024 bounds: every array stands in parts. Sums of one colour are free of order:
/// rounding may differ, since lists are filled in any order.
#[test]
fn grids_in_parts_draw_the_same() {
    if device().is_none() {
        return;
    }
    let grid = cube([10, 9, 9], 0.3);
    let gradient = grid.points.iter().map(|&p| smooth_gradient(p)).collect();
    let volume = Arc::new(Volume { gradient: Some(gradient), ..(*smooth(grid)).clone() });
    let lit = Shading { silhouette: Some(1.5), light: Some(LIGHT), ..SHADING };
    for (name, look, shading, order, bound) in [
        ("exact", overlapping(), SHADING, VisibilityOrder::Exact, 0.0),
        ("lit", overlapping(), lit, VisibilityOrder::Exact, 0.0),
        ("centroid", overlapping(), SHADING, VisibilityOrder::Centroid, 0.0),
        ("sum", one_gaussian(), SHADING, VisibilityOrder::Exact, 1e-6),
    ] {
        let scene = NamedScene { name: name.into(), volume: volume.clone(), look, camera: outside([64, 48]) };
        let whole = draw(&scene, &shading, order).expect("draws");
        assert!(whole.counts.segments > Some(0));
        let parts = draw_on(small(8192, 32), &scene, &shading, order).expect("draws in parts");
        assert_eq!(parts.counts.segments, whole.counts.segments, "{name}");
        within(&format!("{name} in parts"), &parts.picture, &whole.picture, bound);
    }
}

/// A table of 32³ vectors is 512 KiB, its tiles 528 KiB, an image of 96 × 64 texels 96 KiB.
#[test]
fn tables_in_parts_draw_the_same() {
    if device().is_none() {
        return;
    }
    let texel = |k: usize| {
        let [x, y] = [k % 96, k / 96].map(|i| i as f32 / 96.0);
        [x, 1.0 - x, (9.0 * y).sin().abs(), 0.2 + 0.5 * (x - y).abs()]
    };
    let texels = (0..96 * 64).map(texel).collect();
    let table = Table { width: 96, height: 64, texels, s: [0.0, 1.0], g: [0.0, 2.5] };
    let image = Widget { profile: Profile::Table(Arc::new(table)), ..one_gaussian().widgets.remove(0) };
    for (look, integrator, bytes) in [
        (ramp(), pre_integrated(32, 2), 1 << 17),
        (ramp(), pre_integrated_cylindrical(32, 2, 1), 1 << 17),
        (look(vec![image]), Integrator::ANALYTIC, 1 << 15),
    ] {
        let shading = Shading { integrator, ..SHADING };
        let name = format!("table of {}", integrator.name());
        let scene =
            NamedScene { name, volume: smooth(cube([5, 5, 5], 0.2)), look, camera: outside([32, 24]) };
        let whole = draw(&scene, &shading, VisibilityOrder::Exact).expect("draws");
        assert!(whole.counts.segments > Some(0));
        let parts =
            draw_on(small(bytes, 16), &scene, &shading, VisibilityOrder::Exact).expect("draws in parts");
        within(&scene.name, &parts.picture, &whole.picture, 0.0);
        // One of 4 and 5 parts, 2 of an image: too many for so few.
        let error = draw_on(small(bytes / 4, 12), &scene, &shading, VisibilityOrder::Exact)
            .expect_err("too many")
            .to_string();
        assert!(error.contains("table of ") && error.contains("parts"), "{error}");
    }
}

/// Arrays with more parts than are bound at a time are refused before anything is uploaded, and named.
#[test]
fn too_many_parts_are_refused_by_name() {
    if device().is_none() {
        return;
    }
    let camera = outside([32, 24]);
    let scene =
        NamedScene { name: String::new(), volume: smooth(cube([6, 6, 6], 0.3)), look: overlapping(), camera };
    let error =
        draw_on(small(2048, 12), &scene, &SHADING, VisibilityOrder::Exact).expect_err("too many").to_string();
    // 1,296 cells of 16 bytes, 128 to a part.
    for word in [
        "more parts than",
        "the grid's cells of 0 MiB in 11 parts",
        "at most 12 buffers",
        "such cells",
        "cpu",
    ] {
        assert!(error.contains(word), "'{word}' is not in: {error}");
    }
}

/// 16.8 million cells: where a binding holds 128 MiB they stand in three parts and their bounds in two. A field that is
/// linear is the same in any cells, so the referee draws it in 162.
#[test]
#[ignore = "takes a GiB of memory"]
fn millions_of_cells_draw_the_same_as_few() {
    let of = |count| {
        let grid = box_of_tetrahedra([count; 3], [DVec3::ZERO, DVec3::ONE], 0.2);
        volume(grid, |p| 0.2 * p.x + 0.3 * p.y + 0.4 * p.z, |_| 0.0)
    };
    let widget = gaussian([0.45, 0.0], [0.2, f64::INFINITY], 4.0, [1.0, 0.5, 0.15]);
    let scene = |count| NamedScene {
        name: format!("{count} hexahedra a side"),
        volume: of(count),
        look: look(vec![widget.clone()]),
        camera: outside([64, 48]),
    };
    let Some(drawn) = draw(&scene(141), &SHADING, VisibilityOrder::Exact) else { return };
    within("millions", &drawn.picture, &referee(&scene(3)), ORDINARY);
}
