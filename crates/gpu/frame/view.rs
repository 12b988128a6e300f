//! The camera as the device's passes read it.

use crate::grid::device_grid::DeviceGrid;
use crate::grid::double_single::split;
use glam::DVec3;
use voltet_core::camera::{Camera, Projection};
use voltet_core::{Error, Result};
use voltet_shaders::ViewRecord;

/// Rounding error of a point that is allowed (pixels). An ordinary picture changes by less than a tenth in a pixel's
/// width, so by less than 1e-4 for this.
const PIXELS_OFF: f64 = 1e-2;

/// Rounding of a position about the base and of its turn into camera axes, in scene lengths.
const ROUNDING: f64 = 2.0 * f32::EPSILON as f64;

/// The grid as a camera sees it, for the sample at `offset` from the middle of a pixel. What belongs to the window and to
/// the scene is 0.
///
/// Errors: a camera out of range; a view so narrow that 32 bits do not tell its pixels apart.
pub(crate) fn view(grid: &DeviceGrid, camera: &Camera, offset: [f64; 2]) -> Result<ViewRecord> {
    camera.check_picture()?;
    let frame = camera.frame()?;
    let perspective = matches!(camera.projection, Projection::Perspective { .. });
    let pixel = if perspective { frame.pixel } else { frame.pixel / grid.length };
    let eye = (camera.eye - grid.centre) / grid.length;
    // The view axis from where it can first meet the grid, which lies within half a scene length of its middle; of a flat grid
    // seen across, within twice its own depth, so that depths in it keep their digits.
    let depth = 2.0 * grid.half.dot(frame.forward.abs());
    let distance = (-eye.dot(frame.forward) - (2.0 * depth).min(0.5)).max(0.0);
    let base = eye + distance * frame.forward;
    let near = camera.near / grid.length - distance;
    // The farthest point seen stands a scene length behind the base, where a pixel is as wide as this.
    let width = if perspective { pixel * (distance + 1.0) } else { pixel };
    let reach = 1.0 + base.length().min(1.0);
    if ROUNDING * reach > PIXELS_OFF * width {
        return Err(Error::run("the view is too narrow for the device's 32 bits")
            .got(format!("pixels of {:.1e} of the grid's diagonal", width))
            .expected(format!("at least {:.1e}, or engine = \"cpu\"", ROUNDING * reach / PIXELS_OFF)));
    }
    let numbers = [pixel, distance, near, base.x, base.y, base.z];
    if numbers.iter().any(|x| !x.is_finite() || x.abs() > 1e15) {
        return Err(Error::run("the camera stands too far from the grid for the device's 32 bits")
            .got(format!("{:.1e} of the grid's diagonal", eye.length()))
            .expected("at most 1e15, or engine = \"cpu\""));
    }
    let vector = |v: DVec3| v.to_array().map(|x| x as f32);
    let parts = base.to_array().map(split);
    let [width, height] = camera.size.map(f64::from);
    Ok(ViewRecord {
        right: vector(frame.right),
        distance: distance as f32,
        down: vector(-frame.up),
        pixel: pixel as f32,
        forward: vector(frame.forward),
        near: near as f32,
        base_high: parts.map(|part| part[0]),
        perspective: if perspective { 1.0 } else { 0.0 },
        base_low: parts.map(|part| part[1]),
        axis: [(0.5 * width - 0.5 - offset[0]) as f32, (0.5 * height - 0.5 - offset[1]) as f32],
        size: camera.size,
        point_count: grid.point_count,
        cell_count: grid.cell_count,
        ..bytemuck::Zeroable::zeroed()
    })
}
