//! A device with no more than every device of WebGPU has, opened with these limits, so that the driver's own checks refuse more:
//! every compositor draws on it what it draws on any.

use crate::drawing::{device, draw_on};
use std::sync::Arc;
use voltet_core::transfer::{OpticalModel, TransferFunction};
use voltet_core::volume::Volume;
use voltet_gpu::Device;
use voltet_integrators::{pre_integrated, pre_integrated_cylindrical, riemann, segments};
use voltet_optics::engine::Compositor;
use voltet_optics::shading::{Integrator, Light, Shading, VisibilityOrder};
use voltet_testing::pictures::compare::{NamedScene, SHADING, within};
use voltet_testing::pictures::grids::{cube, smooth, smooth_gradient};
use voltet_testing::pictures::looks::*;
use voltet_testing::pictures::widgets::{self, widgets};
use voltet_testing::whole_series;

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

/// Draws a scene on both devices, which shows something and differs by `tolerance` at most.
fn same_on(
    devices: [&Arc<Device>; 2],
    scene: &NamedScene,
    shading: &Shading,
    how: (Compositor, VisibilityOrder),
    tolerance: f64,
) {
    let name = format!("{} {how:?}", scene.name);
    let [any, webgpu] = devices.map(|device| {
        let drawn = draw_on(device.clone(), scene, shading, how);
        drawn.unwrap_or_else(|error| panic!("{name}: {error}")).picture
    });
    assert!(any.rgba.iter().any(|pixel| pixel[3] > 0.01), "{name}: nothing to see");
    within(&name, &webgpu, &any, tolerance);
}

#[test]
fn every_compositor_draws_within_the_limits_of_webgpu() {
    let (Some(device), Some(least)) = (device(), least()) else { return };
    let light = Some(Light { direction: glam::DVec3::new(0.4, -0.7, 3.5), ambient: 0.3, diffuse: 0.8 });
    let lit = Shading { light, silhouette: Some(0.5), ..SHADING };
    let tables = pre_integrated(16, 2);
    for (name, look, shading) in [
        ("overlap", overlapping(), SHADING),
        ("lit", overlapping(), lit),
        ("one colour", one_gaussian(), SHADING),
        ("tables of lengths", ramp(), Shading { integrator: tables, ..SHADING }),
    ] {
        let scene = scene(name, look);
        for how in [
            (Compositor::Tiles, VisibilityOrder::Exact),
            (Compositor::Tiles, VisibilityOrder::Centroid),
            (Compositor::Raster, VisibilityOrder::Centroid),
            (Compositor::Triangles, VisibilityOrder::Centroid),
        ] {
            // Lists that need no order are filled in any.
            same_on([&device, &least], &scene, &shading, how, 1e-6);
        }
    }
}

/// An image, a Gaussian over fields and control points within a region, lit: every array of the grid and everything that a scene reads
/// beside its uniform. What integrates them adds its tables. Drawn in each way in a whole series, otherwise each in the next one.
#[test]
fn every_integrator_has_room_for_all_that_a_scene_may_have() {
    let (Some(device), Some(least)) = (device(), least()) else { return };
    let light = Some(Light { direction: glam::DVec3::new(0.4, -0.7, 3.5), ambient: 0.3, diffuse: 0.8 });
    let full = ["table", "nd", "cut ramp"];
    let known = widgets();
    let widget = |name: &str| known.iter().find(|known| known.0 == name).expect("is there").1.clone();
    let models = [OpticalModel::DensityEmitter, OpticalModel::ConstantEmitter { cutoff: 1.0 / 255.0 }];
    let full = models.map(|model| TransferFunction { model, ..look(full.map(widget).to_vec()) });
    let ways = [
        (Compositor::Tiles, VisibilityOrder::Exact),
        (Compositor::Tiles, VisibilityOrder::Centroid),
        (Compositor::Raster, VisibilityOrder::Centroid),
        (Compositor::Raster, VisibilityOrder::Unsorted),
        (Compositor::Triangles, VisibilityOrder::Centroid),
    ];
    let mut drawn = 0;
    // The smallest tables: arrays are counted here, and a device of WebGPU binds no more than 128 MiB of one.
    for integrator in [
        Integrator::ANALYTIC,
        Integrator::adaptive(1e-3),
        segments(1, 2),
        riemann(1),
        pre_integrated(2, 1),
        pre_integrated_cylindrical(2, 1, 1),
    ] {
        let looks = if integrator.has_table_of_lengths() { vec![ramp()] } else { full.to_vec() };
        for look in looks {
            let shading = Shading { integrator, light, silhouette: Some(0.5), ..SHADING };
            let name = format!("{} {:?}", integrator.name(), look.model);
            let scene = widgets::scene(name, look);
            let chosen = match whole_series() {
                true => &ways[..],
                false => &ways[drawn % ways.len()..][..1],
            };
            drawn += 1;
            for &how in chosen {
                same_on([&device, &least], &scene, &shading, how, 0.0);
            }
        }
    }
}
