//! Data sent to the device after the first frame of a grid: parameters alone, where a camera or a widget moves.

use crate::drawing::{device, draw, draw_tiles, further_device};
use std::sync::Arc;
use voltet_core::progress::NoProgress;
use voltet_core::transfer::{OpticalModel, Profile, Region, Table, TransferFunction, Widget};
use voltet_gpu::Renderer;
use voltet_integrators::segments;
use voltet_optics::engine::{Compositor, RenderOptions};
use voltet_optics::shading::{Shading, VisibilityOrder};
use voltet_testing::pictures::compare::{NamedScene, SHADING, within};
use voltet_testing::pictures::grids::{cube, smooth};
use voltet_testing::pictures::looks::*;

fn scene(look: TransferFunction) -> NamedScene {
    NamedScene { name: "moved".into(), volume: smooth(cube([6, 6, 6], 0.3)), look, camera: outside([32, 32]) }
}

/// A widget that moves leaves the images and the integrator's table where they are; another image or model does not.
#[test]
fn a_moved_widget_sends_no_tables() {
    if device().is_none() {
        return;
    }
    // One of its own, since all tests upload to the common one.
    let device = Arc::new(further_device());
    let integrator = segments(2, 64);
    let shading = Shading { integrator, ..SHADING };
    let texels = |alpha: f32| (0..64 * 64).map(|k| [0.9, 0.5, 0.2, alpha * (k % 7) as f32]).collect();
    let of = |alpha| {
        let table = Table { width: 64, height: 64, texels: texels(alpha), s: [0.0, 1.0], g: [0.0, 2.0] };
        let image = Widget { profile: Profile::Table(Arc::new(table)), ..everywhere(2.0, [1.0; 3]) };
        look([vec![image], overlapping().widgets].concat())
    };
    let first = NamedScene { volume: smooth(cube([5; 3], 0.2)), ..scene(of(0.1)) };
    let renderer = Renderer::new(device.clone(), &first.volume).expect("fits");
    let sent = |look: &TransferFunction| {
        let before = device.work().bytes_uploaded;
        let scene = NamedScene { look: look.clone(), ..first.clone() };
        let drawn = draw_tiles(&renderer, &scene, &shading, VisibilityOrder::Exact).expect("draws");
        let alone = draw(&scene, &shading, VisibilityOrder::Exact).expect("there is a device");
        within("as if it were the first", &drawn.picture, &alone.picture, 0.0);
        device.work().bytes_uploaded - before
    };
    // 64² texels of 16 bytes, as many entries of 4.
    let tables = 64 * 64 * (16 + 4);
    assert!(tables < sent(&first.look));
    let mut moved = first.look.clone();
    moved.widgets[1].extinction = 7.0;
    moved.widgets[2].region = Some(Region::rectangle([0.3, 0.7], [0.1, 1.2]));
    for _ in 0..2 {
        let bytes = sent(&moved);
        assert!(0 < bytes && bytes < 2048, "{bytes} bytes");
    }
    let model = OpticalModel::ConstantEmitter { cutoff: 0.01 };
    for other in [of(0.2), TransferFunction { model, ..first.look.clone() }] {
        assert!(tables < sent(&other));
    }
}

/// After its first frame a grid stays: a camera or a widget that moves sends what the frame is told alone, by every compositor,
/// however large the grid is.
#[test]
fn a_moved_camera_or_widget_uploads_parameters_alone() {
    if device().is_none() {
        return;
    }
    // One of its own, since all tests upload to the common one.
    let device = Arc::new(further_device());
    let moved_look =
        look(overlapping().widgets.iter().map(|widget| widget.with_extinction_times(0.7)).collect());
    let mut per_grid = Vec::new();
    for side in [5, 9] {
        let first = NamedScene { volume: smooth(cube([side; 3], 0.2)), ..scene(overlapping()) };
        let mut bytes = Vec::new();
        for compositing in [Compositor::Tiles, Compositor::Raster, Compositor::Triangles] {
            let renderer = Renderer::new(device.clone(), &first.volume).expect("fits");
            let sent = |scene: &NamedScene| {
                let before = device.work();
                let wanted = scene.drawn_by(&SHADING, VisibilityOrder::Centroid);
                voltet_gpu::draw(
                    &renderer,
                    &wanted,
                    &RenderOptions { compositing: Some(compositing), ..RenderOptions::default() },
                    &NoProgress,
                )
                .expect("draws");
                let after = device.work();
                [after.bytes_uploaded - before.bytes_uploaded, after.uploads - before.uploads]
            };
            sent(&first);
            let [camera, widget] = [
                NamedScene { camera: outside([30, 24]), ..first.clone() },
                NamedScene { look: moved_look.clone(), ..first.clone() },
            ]
            .map(|scene| sent(&scene));
            for [count, arrays] in [camera, widget] {
                assert!(
                    0 < count && count < 2048 && arrays == 0,
                    "{compositing:?}: {count} bytes, {arrays} arrays"
                );
            }
            bytes.push([camera, widget]);
        }
        per_grid.push(bytes);
    }
    println!("{per_grid:?}");
    assert_eq!(per_grid[0], per_grid[1]);
}
