//! A grid on the device: points, tetrahedra and the values that transfer functions look at, uploaded once.

use crate::device::device_handle::Device;
use crate::grid::double_single::split;
use crate::grid::split_buffer::{BufferSizes, SplitBuffer};
use glam::DVec3;
use rayon::prelude::*;
use std::collections::HashMap;
use std::sync::atomic::Ordering;
use std::sync::{Arc, Mutex, PoisonError};
use voltet_core::grid::extent;
use voltet_core::volume::Volume;
use voltet_core::{Error, Result};
use voltet_shaders::GridArray;

/// A quantity at the points.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(crate) enum ValueArray {
    Scalar,
    GradientMagnitude,
    Field(String),
    /// A component of ∇s.
    Gradient(usize),
}

/// A quantity on the device: (value − middle) / span, high and low part.
pub(crate) struct DeviceArray {
    pub values: SplitBuffer,
    pub middle: f64,
    /// > 0.
    pub span: f64,
    /// The most that it changes within one cell, in spans.
    pub cell_span: f64,
}

impl DeviceArray {
    /// Smallest and largest value.
    pub fn range(&self) -> [f64; 2] {
        [self.middle - 0.5 * self.span, self.middle + 0.5 * self.span]
    }
}

/// A volume's grid on a device. Values are uploaded as scenes ask for them.
pub(crate) struct DeviceGrid {
    pub device: Arc<Device>,
    pub(crate) positions: SplitBuffer,
    pub(crate) tetrahedra: SplitBuffer,
    pub(crate) point_count: u32,
    pub(crate) cell_count: u32,
    /// World units in the scene length: the diagonal of the grid.
    pub(crate) length: f64,
    /// The longest edge of a cell, world units: no segment is longer.
    pub(crate) longest: f64,
    /// Middle of the grid's box.
    pub(crate) centre: DVec3,
    /// Half the sides of the box, in lengths.
    pub(crate) half: DVec3,
    stored: Mutex<HashMap<ValueArray, Arc<DeviceArray>>>,
}

impl DeviceGrid {
    /// Uploads points and tetrahedra. Errors: what has more parts than the device binds at a time; memory.
    pub fn new(device: Arc<Device>, volume: &Volume) -> Result<DeviceGrid> {
        let grid = &volume.grid;
        let sizes = sizes(volume);
        sizes.check(device.room(), &device.name)?;
        let layout = sizes.layout(device.room());
        let bounds = extent::bounds(&grid.points);
        let length = extent::scene_length(bounds)?;
        let [low, high] = bounds.unwrap_or_default();
        let (sides, centre) = (high - low, low + 0.5 * (high - low));
        let position = |p: usize| {
            let parts = ((grid.points[p] - centre) / length).to_array().map(split);
            [parts[0][0], parts[1][0], parts[2][0], parts[0][1], parts[1][1], parts[2][1]]
        };
        let position_of = |point: u32| (grid.points[point as usize] - centre) / length;
        let edge = |cell: &[u32; 4]| extent::longest_edge_squared(cell.map(position_of));
        let cells = grid.tetrahedra.par_iter().with_min_len(1 << 14);
        let longest = length * cells.map(edge).reduce(|| 0.0, f64::max).sqrt();
        device.work.uploads.fetch_add(2, Ordering::Relaxed);
        Ok(DeviceGrid {
            positions: device.upload_parted(
                GridArray::Positions,
                layout.positions,
                grid.points.len(),
                position,
            )?,
            tetrahedra: device.upload_parted(
                GridArray::Tetrahedra,
                layout.tetrahedra,
                grid.tetrahedra.len(),
                |cell| without_volume(grid.tetrahedra[cell], position_of),
            )?,
            // Checked above.
            point_count: sizes.points as u32,
            cell_count: sizes.cells as u32,
            length,
            longest: if longest > 0.0 { longest } else { length },
            centre,
            half: 0.5 * (sides / length),
            device,
            stored: Mutex::default(),
        })
    }

    /// The quantity, uploaded if it is not there. `volume` is the one that the grid was made from.
    pub(crate) fn stored(&self, volume: &Volume, quantity: ValueArray) -> Result<Arc<DeviceArray>> {
        let known = self.stored.lock().unwrap_or_else(PoisonError::into_inner).get(&quantity).cloned();
        if let Some(stored) = known {
            return Ok(stored);
        }
        let stored = Arc::new(match &quantity {
            ValueArray::Scalar => self.store(volume, &volume.scalar, 1, 0)?,
            ValueArray::GradientMagnitude => match &volume.gradient_magnitude {
                Some(g) => self.store(volume, g, 1, 0)?,
                None => {
                    return Err(Error::usage(
                        "the transfer function looks at the gradient magnitude, and the volume has none",
                    )
                    .expected("a gradient-magnitude node before this one"));
                }
            },
            ValueArray::Field(name) => {
                let arrays = &volume.grid.point_arrays;
                let array = arrays.get(name).filter(|array| array.component_count == 1);
                let Some(array) = array else {
                    return Err(Error::usage(
                        "the transfer function looks at a field that the volume does not have",
                    )
                    .got(name)
                    .expected("a point array of one component that the reader was asked for"));
                };
                self.store(volume, &array.values, 1, 0)?
            }
            ValueArray::Gradient(component) => match &volume.gradient {
                Some(gradient) if gradient.len() == volume.grid.points.len() => {
                    self.store(volume, bytemuck::cast_slice(gradient), 3, *component)?
                }
                _ => {
                    return Err(Error::usage("light and silhouettes need a gradient at every point")
                        .expected("a gradient-magnitude node before this one"));
                }
            },
        });
        let mut all = self.stored.lock().unwrap_or_else(PoisonError::into_inner);
        Ok(all.entry(quantity).or_insert(stored).clone())
    }

    /// Every `stride`th value from `first` on. Vectors keep their direction: no offset, and one scale for all components.
    fn store(&self, volume: &Volume, values: &[f64], stride: usize, first: usize) -> Result<DeviceArray> {
        let [low, high] = extent::range(values).unwrap_or_default();
        let (middle, span) = match stride {
            1 => (low + 0.5 * (high - low), high - low),
            _ => (0.0, low.abs().max(high.abs())),
        };
        let span = if span > 0.0 && span.is_finite() { span } else { 1.0 };
        let value = |point: usize| values[point * stride + first];
        let widest = |cell: &[u32; 4]| {
            let [low, high] = extent::range(&cell.map(|p| value(p as usize))).unwrap_or_default();
            high - low
        };
        let cells = volume.grid.tetrahedra.par_iter().with_min_len(1 << 14);
        let cell_span = cells.map(widest).reduce(|| 0.0, f64::max) / span;
        let parts = |point: usize| split((value(point) - middle) / span);
        let layout = sizes(volume).layout(self.device.room());
        let count = values.len() / stride;
        let values = self.device.upload_parted(GridArray::Quantity, layout.quantity, count, parts)?;
        self.device.work.uploads.fetch_add(1, Ordering::Relaxed);
        Ok(DeviceArray { values, middle, span, cell_span })
    }
}

/// Sizes of the buffers that a grid takes at least.
fn sizes(volume: &Volume) -> BufferSizes {
    let (points, cells) = (volume.grid.points.len() as u64, volume.grid.tetrahedra.len() as u64);
    BufferSizes { points, cells, ..BufferSizes::default() }
}

/// A cell in one place instead of a cell without volume, which no ray crosses: on the device, rounded corners of the latter
/// would be a cell like any other. Without volume: to 64-bit rounding.
fn without_volume(cell: [u32; 4], position: impl Fn(u32) -> DVec3) -> [u32; 4] {
    let at = cell.map(position);
    let edges = [at[1] - at[0], at[2] - at[0], at[3] - at[0]];
    let determinant = edges[0].dot(edges[1].cross(edges[2]));
    let sizes: f64 = edges.iter().map(|edge| edge.length()).product();
    if determinant.abs() <= 16.0 * f64::EPSILON * sizes { [cell[0]; 4] } else { cell }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_on_a_line_or_in_a_plane_become_a_place_and_thin_ones_stay() {
        let third = 1.0 / 3.0;
        let [a, b, c] = [DVec3::new(0.1, 0.1, 0.1), DVec3::new(0.9, 0.2, 0.3), DVec3::new(0.2, 0.9, 0.6)];
        let is_kept =
            |points: [DVec3; 4]| without_volume([0, 1, 2, 3], |p| points[p as usize]) == [0, 1, 2, 3];
        assert!(!is_kept([DVec3::ZERO, DVec3::splat(third), DVec3::splat(2.0 * third), DVec3::ONE]));
        // To rounding in the plane of the others.
        assert!(!is_kept([a, b, c, third * (a + b + c)]));
        assert!(!is_kept([a, b, c, a]));
        assert!(is_kept([a, b, c, third * (a + b + c) + 1e-12 * DVec3::Z]));
        assert!(is_kept([a, b, c, DVec3::ONE].map(|p| 1e-30 * p)));
    }
}
