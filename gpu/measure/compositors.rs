//! Which compositor is the faster one on a device: a small grid drawn by both.

use crate::device::open::Device;
use crate::frame::draw::{Compositing, How, draw};
use crate::frame::renderer::Renderer;
use glam::DVec3;
use std::sync::Arc;
use std::time::Instant;
use voltet_core::Result;
use voltet_core::camera::{Camera, Projection};
use voltet_core::grid::generate::box_of_tetrahedra;
use voltet_core::optics::Overlap;
use voltet_core::progress::Progress;
use voltet_core::shading::{Integrator, Order, Shading};
use voltet_core::transfer::{ControlPoint, OpticalModel, Profile, TransferFunction, Widget};
use voltet_core::volume::Volume;

/// Seconds of a frame by each compositor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Times {
    /// Compute passes over tiles.
    pub tiles: f64,
    /// Blending hardware.
    pub raster: f64,
}

impl Times {
    /// The faster one.
    pub fn faster(&self) -> Compositing {
        if self.raster < self.tiles { Compositing::Raster } else { Compositing::Tiles }
    }
}

/// Cells along a side of the box, and pixels along a side of the picture: enough to fill a graphics device for the tenth of
/// a second that all frames take, and little for a program that stands in for one.
const HARDWARE: (usize, u32) = (32, 768);
const SOFTWARE: (usize, u32) = (5, 48);

/// Frames after the first, which compiles.
const FRAME_COUNT: usize = 5;

/// Draws a scene of one colour, which needs no order, or one of several in the order of centroids, by both compositors.
///
/// Errors: those of [`draw`]; what the raster compositor lacks on this device.
pub fn measure(device: &Arc<Device>, needs_order: bool, progress: &dyn Progress) -> Result<Times> {
    let (side, pixels) = if device.is_software { SOFTWARE } else { HARDWARE };
    let box_grid = box_of_tetrahedra([side; 3], [DVec3::ZERO, DVec3::ONE], 0.2);
    let s = |p: &DVec3| 0.5 + 0.25 * (4.0 * p.x + p.y).sin() + 0.25 * (3.0 * p.z - 2.0 * p.y).cos();
    let scalar: Vec<f64> = box_grid.points.iter().map(s).collect();
    let volume = Volume {
        grid: Arc::new(box_grid),
        scalar: Arc::new(scalar),
        gradient: None,
        gradient_magnitude: None,
    };
    let renderer = Renderer::new(device.clone(), &volume)?;
    let shading =
        Shading { integrator: Integrator::Analytic, overlap: Overlap::Exact, silhouette: None, light: None };
    let camera = Camera {
        eye: DVec3::new(-0.9, -1.1, 1.4),
        target: DVec3::splat(0.5),
        up: DVec3::Z,
        projection: Projection::Perspective { fov_y: 45.0 },
        near: 0.0,
        size: [pixels; 2],
        samples: 1,
    };
    let look = look(needs_order);
    let seconds = |compositing| -> Result<f64> {
        let how = How { order: Order::Centroid, compositing };
        let mut times = Vec::new();
        for frame in 0..=FRAME_COUNT {
            let begun = Instant::now();
            let drawn = draw(&renderer, &volume, &look, &camera, &shading, how, progress)?;
            let whole = begun.elapsed().as_secs_f64();
            // The device's own clock leaves out what the program waits for; both are the same for both compositors.
            let passes: f64 = drawn.seconds.iter().map(|(_, seconds)| seconds).sum();
            if frame > 0 {
                times.push(if passes > 0.0 { passes } else { whole });
            }
        }
        times.sort_by(f64::total_cmp);
        Ok(times[times.len() / 2])
    };
    Ok(Times { tiles: seconds(Compositing::Tiles)?, raster: seconds(Compositing::Raster)? })
}

/// A Gaussian, or a ramp of two colours.
fn look(needs_order: bool) -> TransferFunction {
    let point = |s, color, extinction| ControlPoint { s, color, extinction };
    let profile = if needs_order {
        let points = vec![
            point(0.0, [0.1, 0.2, 0.9], 0.0),
            point(0.4, [0.1, 0.8, 0.9], 1.0),
            point(1.0, [0.9, 0.3, 0.1], 4.0),
        ];
        Profile::PiecewiseLinear { points }
    } else {
        Profile::Gaussian { centre: [0.6, 0.0], matrix: [[5.0, 0.0], [0.0, 0.0]] }
    };
    let widget = Widget { profile, color: [1.0, 0.5, 0.2], extinction: 4.0, region: None };
    TransferFunction { model: OpticalModel::DensityEmitter, unit_distance: 1.0, widgets: vec![widget] }
}
