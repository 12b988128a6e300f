//! Grids and tables whose arrays stand in several bindings each draw the same as in one.

use crate::compare::{SHADING, Scene, within};
use crate::drawing::{device, draw};
use crate::grids::{cube, smooth, smooth_gradient};
use crate::looks::*;
use glam::DVec3;
use std::sync::Arc;
use voltet_core::Result;
use voltet_core::progress::Silent;
use voltet_core::shading::{Light, Order, Shading};
use voltet_core::volume::Volume;
use voltet_gpu::{Device, DeviceGrid, Drawn};

const LIGHT: Light = Light { direction: DVec3::new(1.0, 2.0, 3.0), ambient: 0.2, diffuse: 0.8 };

/// A device whose bindings hold so little, and so few of them.
fn small(bytes: u64, count: u32) -> Device {
    let wish = std::env::var("VOLTET_ADAPTER").ok();
    let device = Device::open(wish.as_deref(), false).expect("opened before");
    device.with_bindings_of(bytes).with_buffers_at_a_time(count)
}

fn draw_on(device: Device, scene: &Scene, shading: &Shading, order: Order) -> Result<Drawn> {
    let grid = DeviceGrid::new(Arc::new(device), &scene.volume)?;
    voltet_gpu::draw(&grid, &scene.volume, &scene.look, &scene.camera, shading, order, &Silent)
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
    let volume = Arc::new(Volume { gradient: Some(Arc::new(gradient)), ..(*smooth(grid)).clone() });
    let lit = Shading { silhouette: Some(1.5), light: Some(LIGHT), ..SHADING };
    for (name, look, shading, order, bound) in [
        ("exact", overlapping(), SHADING, Order::Exact, 0.0),
        ("lit", overlapping(), lit, Order::Exact, 0.0),
        ("centroid", overlapping(), SHADING, Order::Centroid, 0.0),
        ("sum", one_gaussian(), SHADING, Order::Exact, 1e-6),
    ] {
        let scene = Scene { name: name.into(), volume: volume.clone(), look, camera: outside([64, 48]) };
        let whole = draw(&scene, &shading, order).expect("draws");
        assert!(whole.counts.segments > Some(0));
        let parts = draw_on(small(8192, 32), &scene, &shading, order).expect("draws in parts");
        assert_eq!(parts.counts.segments, whole.counts.segments, "{name}");
        within(&format!("{name} in parts"), &parts.picture, &whole.picture, bound);
    }
}

/// What has more parts than are bound at a time is refused before anything is uploaded, and named.
#[test]
fn too_many_parts_are_refused_by_name() {
    if device().is_none() {
        return;
    }
    let camera = outside([32, 24]);
    let scene =
        Scene { name: String::new(), volume: smooth(cube([6, 6, 6], 0.3)), look: overlapping(), camera };
    let error = draw_on(small(2048, 12), &scene, &SHADING, Order::Exact).expect_err("too many").to_string();
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
