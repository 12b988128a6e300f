//! A device with no more than every device of WebGPU has, opened with these limits, so that the driver's own checks refuse more:
//! every compositor draws on it what it draws on any.

use crate::drawing::{device, draw_on};
use std::sync::Arc;
use voltet_core::engine::{Accumulation, Compositing, Manner};
use voltet_core::progress::Silent;
use voltet_core::shading::{Integrator, Light, Order, Shading};
use voltet_core::transfer::{Profile, Table, TransferFunction, Widget};
use voltet_core::volume::Volume;
use voltet_gpu::{Device, Renderer};
use voltet_testing::pictures::compare::{NamedScene, SHADING, within};
use voltet_testing::pictures::grids::{cube, smooth, smooth_gradient};
use voltet_testing::pictures::looks::*;

fn least() -> Option<Arc<Device>> {
    device()?;
    let wish = std::env::var("VOLTET_ADAPTER").ok();
    Some(Arc::new(Device::open_as_webgpu(wish.as_deref()).expect("opened before")))
}

fn scene(name: &str, look: TransferFunction) -> NamedScene {
    let grid = cube([6, 6, 6], 0.3);
    let gradient = grid.points.iter().map(|&p| smooth_gradient(p)).collect();
    let volume = Arc::new(Volume { gradient: Some(gradient), ..(*smooth(grid)).clone() });
    NamedScene { name: name.into(), volume, look, camera: outside([40, 32]) }
}

fn image() -> TransferFunction {
    let texels = (0..96u32).map(|k| [0.2, 0.5, 0.9, f32::from((k % 7) as u8) / 7.0]).collect();
    let table = Table { width: 12, height: 8, texels, s: [0.0, 1.2], g: [0.0, 1.5] };
    look(vec![Widget { profile: Profile::Table(Arc::new(table)), ..everywhere(3.0, [1.0; 3]) }])
}

#[test]
fn every_compositor_draws_within_the_limits_of_webgpu() {
    let (Some(device), Some(least)) = (device(), least()) else { return };
    let light = Some(Light { direction: glam::DVec3::new(0.4, -0.7, 3.5), ambient: 0.3, diffuse: 0.8 });
    let lit = Shading { light, silhouette: Some(0.5), ..SHADING };
    let tables = Integrator::PreIntegrated { table_size: 16, oversampling: 2 };
    for (name, look, shading) in [
        ("overlap", overlapping(), SHADING),
        ("lit", overlapping(), lit),
        ("one colour", one_gaussian(), SHADING),
        ("tables of lengths", ramp(), Shading { integrator: tables, ..SHADING }),
    ] {
        let scene = scene(name, look);
        for how in [
            (Compositing::Tiles, Order::Exact),
            (Compositing::Tiles, Order::Centroid),
            (Compositing::Raster, Order::Centroid),
            (Compositing::Triangles, Order::Centroid),
        ] {
            let [any, webgpu] = [&device, &least].map(|device| {
                let drawn = draw_on(device.clone(), &scene, &shading, how);
                drawn.unwrap_or_else(|error| panic!("{name} {how:?}: {error}")).picture
            });
            assert!(any.rgba.iter().any(|pixel| pixel[3] > 0.01), "{name}: nothing to see");
            // Lists that need no order are filled in any.
            within(&format!("{name} {how:?}"), &webgpu, &any, 1e-6);
        }
    }
    let scene = scene("few bits", overlapping());
    let renderer = Renderer::new(least, &scene.volume).expect("fits");
    for accumulation in [Accumulation::Bits8, Accumulation::Bits12] {
        let manner = Manner { accumulation, ..Manner::by(Compositing::Triangles) };
        voltet_gpu::draw(&renderer, &scene.drawn_by(&SHADING, Order::Centroid), &manner, &Silent)
            .expect("draws");
    }
}

/// An image over s and g takes two buffers beside those of tiles and of g: one more than there are. What blends has room.
#[test]
fn what_tiles_have_no_room_for_is_refused_and_blended() {
    let Some(least) = least() else { return };
    let scene = scene("image", image());
    let drawn = |compositing| draw_on(least.clone(), &scene, &SHADING, (compositing, Order::Centroid));
    let error = drawn(Compositing::Tiles).expect_err("too many").to_string();
    for word in ["9 buffers", "at most 8 buffers of 128 MiB", "another compositor", "cpu"] {
        assert!(error.contains(word), "'{word}' is not in: {error}");
    }
    let [outlines, triangles] =
        [Compositing::Raster, Compositing::Triangles].map(|way| drawn(way).expect("has room").picture);
    assert!(outlines.rgba.iter().any(|pixel| pixel[3] > 0.01));
    within("image", &triangles, &outlines, 1.0 / 255.0);
}
