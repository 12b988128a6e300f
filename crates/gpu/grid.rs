//! A grid on a device: points, tetrahedra and the values that transfer functions look at, uploaded once, each array in parts
//! that fit the device's bindings.

use crate::device::pipelines::storage_buffers;
use crate::device::{Device, GrowingBuffer, MEBIBYTE, locked};
use crate::flat_cells::{FlatCell, FlatCells};
use glam::DVec3;
use rayon::prelude::*;
use std::collections::HashMap;
use std::sync::{Arc, Mutex};
use voltet_core::grid::extent;
use voltet_core::transfer::{AxisScale, TransferFunction};
use voltet_core::volume::Volume;
use voltet_core::{Error, Result, counted};
use voltet_shaders::{Access, Axis, FramePass, GridArray, Layout, Parts, TEXEL_BYTES, cells_read};

/// Points, cells or a table's numbers that can be counted, so that no dispatch over them passes the last number of 32 bits.
const MAX_COUNT: u64 = 4_000_000_000;

#[derive(Debug, Clone, Copy)]
pub(crate) struct BindingLimits {
    /// Bytes of one binding.
    pub bytes: u64,
    /// Storage buffers of a pass.
    pub buffers: u32,
}

#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct BufferSizes {
    pub points: u64,
    pub cells: u64,
    /// Attributes of a point.
    pub stride: u64,
    /// Vectors of what the scene reads beside its uniform, where any are among it.
    pub texels: u64,
    /// Vectors of the table that it is made from, if it is made from another.
    pub source_texels: u64,
    /// Storage buffers of the scene's own that stand in one binding each.
    pub scene_buffers: u32,
    /// Storage buffers of the compositor's own.
    pub own_buffers: u32,
}

impl BufferSizes {
    /// Every array in parts that fit a binding.
    pub fn layout(&self, room: BindingLimits) -> Layout {
        let parts =
            |array: GridArray| Parts::for_elements(self.count(array), array.bytes(self.stride), room.bytes);
        let table = Parts::for_elements(self.texels, TEXEL_BYTES, room.bytes);
        Layout { grid: GridArray::ALL.map(parts), table }
    }

    fn count(&self, array: GridArray) -> u64 {
        match array {
            GridArray::Tetrahedra | GridArray::Bounds => self.cells,
            _ => self.points,
        }
    }

    /// Storage buffers of the pass that binds most.
    pub fn buffers(&self, room: BindingLimits) -> u32 {
        let layout = self.layout(room);
        let of = |arrays: &[(GridArray, Access)]| {
            arrays.iter().map(|(array, _)| layout.parts(*array).count).fold(0, u32::saturating_add)
        };
        let pass = |pass: &FramePass| of(pass.grid_arrays()).saturating_add(storage_buffers(Some(*pass)));
        let table = if self.texels > 0 { layout.table.count } else { 0 };
        let own = self.own_buffers.saturating_add(self.scene_buffers).saturating_add(table);
        let pixels = of(cells_read(self.stride as usize)).saturating_add(own);
        // What fills the table: from another one, or from a list.
        let filling = table.saturating_add(layout.table.with_count(self.source_texels).count);
        FramePass::ALL.iter().map(pass).fold(pixels.max(filling), u32::max)
    }

    fn fits(&self, room: BindingLimits) -> bool {
        let numbers = self.texels.saturating_mul(TEXEL_BYTES / 4);
        self.points.max(self.cells).max(numbers) <= MAX_COUNT && self.buffers(room) <= room.buffers
    }

    /// An error that names the arrays in parts, and how many such cells would do, if a device binds too few buffers.
    pub fn check(&self, room: BindingLimits, device: &str) -> Result<()> {
        if self.fits(room) {
            return Ok(());
        }
        let layout = self.layout(room);
        let mib = |bytes: u64| bytes as f64 / MEBIBYTE;
        let mut parts: Vec<String> = GridArray::ALL
            .iter()
            .filter(|array| layout.parts(**array).count > 1)
            .map(|array| {
                let size = mib(self.count(*array).saturating_mul(array.bytes(self.stride)));
                format!("{} of {size:.0} MiB in {} parts", array.label(), layout.parts(*array).count)
            })
            .collect();
        if layout.table.count > 1 {
            let size = mib(self.texels.saturating_mul(TEXEL_BYTES));
            parts.push(format!("the integrator's table of {size:.0} MiB in {} parts", layout.table.count));
        }
        let bytes = mib(room.bytes);
        let found = match parts.is_empty() {
            true => format!("{}, {}", counted(self.buffers(room), "buffer"), counted(self.cells, "cell")),
            false => format!("{} buffers: {}", self.buffers(room), parts.join(", ")),
        };
        // The largest grid of this kind that would do, to a thousandth.
        let share = |n: u64, k: u64| (u128::from(n) * u128::from(k) / 1000) as u64;
        let scaled =
            |k: u64| BufferSizes { points: share(self.points, k), cells: share(self.cells, k), ..*self };
        let would = (1..1000).rev().map(scaled).find(|sizes| sizes.fits(room));
        // Where nothing stands in parts, no smaller grid would do.
        let other = if parts.is_empty() { "another compositor or adapter" } else { "a smaller table" };
        let would = would.map_or(other.into(), |sizes| format!("about {} such cells", sizes.cells));
        Err(Error::run(format!("the scene has more parts than {device} binds at a time"))
            .got(found)
            .expected(format!(
                "at most {} buffers of {bytes:.0} MiB: {would}, or engine = \"cpu\"",
                room.buffers
            )))
    }
}

/// One of the grid's arrays on a device, in its parts.
pub(crate) type SplitBuffer = Vec<wgpu::Buffer>;

#[derive(Default)]
pub(crate) struct GrowingSplitBuffer(Vec<GrowingBuffer>);

impl GrowingSplitBuffer {
    /// Room for so many elements.
    pub fn at_least(
        &mut self,
        device: &Device,
        array: GridArray,
        sizes: &BufferSizes,
        parts: Parts,
    ) -> Result<SplitBuffer> {
        self.0.resize_with(parts.count as usize, GrowingBuffer::default);
        let bytes = array.bytes(sizes.stride);
        let make = |size: u64| device.storage(array.label(), size);
        let of = |(growing, part): (&mut GrowingBuffer, u32)| {
            growing.at_least(parts.length(part, sizes.count(array)) * bytes, make)
        };
        self.0.iter_mut().zip(0..).map(of).collect()
    }
}

impl Device {
    pub(crate) fn room(&self) -> BindingLimits {
        BindingLimits { bytes: self.most_bytes(), buffers: self.limits.max_storage_buffers_per_shader_stage }
    }

    /// One of the grid's arrays with its content, element by element.
    pub(crate) fn upload_parted<U: bytemuck::Pod + Send>(
        &self,
        array: GridArray,
        layout: &Layout,
        count: usize,
        element: impl Fn(usize) -> U + Sync,
    ) -> Result<SplitBuffer> {
        let parts = layout.parts(array);
        let mut buffers = Vec::new();
        let mut first = 0;
        for part in 0..parts.count {
            let length = parts.length(part, count as u64) as usize;
            buffers.push(self.upload(array.label(), length, |i| element(first + i))?);
            first += length;
        }
        Ok(buffers)
    }
}

/// A quantity at the points.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(crate) enum ValueArray {
    Scalar,
    GradientMagnitude,
    Field(String),
    /// A component of ∇s.
    Gradient(usize),
}

/// A quantity on the device: (value − origin) / span, high and low part.
pub(crate) struct DeviceArray {
    pub values: SplitBuffer,
    pub origin: f64,
    /// > 0.
    pub span: f64,
    /// The most that it changes within one cell, in spans.
    pub cell_span: f64,
    /// Smallest and largest value.
    pub range: [f64; 2],
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
    /// Cells that rounding may spoil.
    pub(crate) flat_cells: FlatCells,
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
        let cell = |cell: usize| without_volume(grid.tetrahedra[cell], position_of);
        let flat = |(number, cell): (usize, &[u32; 4])| {
            let flat = FlatCell::new(number as u32, cell.map(position_of))?;
            (without_volume(*cell, position_of) == *cell).then_some(flat)
        };
        let numbered = grid.tetrahedra.par_iter().enumerate().with_min_len(1 << 14);
        let flat_cells = numbered.filter_map(flat).collect();
        device.count(|work| work.uploads += 2);
        Ok(DeviceGrid {
            positions: device.upload_parted(GridArray::Positions, &layout, grid.points.len(), position)?,
            tetrahedra: device.upload_parted(GridArray::Tetrahedra, &layout, grid.tetrahedra.len(), cell)?,
            // Checked above.
            point_count: sizes.points as u32,
            cell_count: sizes.cells as u32,
            length,
            longest: if longest > 0.0 { longest } else { length },
            centre,
            half: 0.5 * (sides / length),
            flat_cells: FlatCells { cells: flat_cells, centre, length },
            device,
            stored: Mutex::default(),
        })
    }

    /// The quantity, uploaded if it is not there. `volume` is the one that the grid was made from.
    pub(crate) fn stored(&self, volume: &Volume, quantity: ValueArray) -> Result<Arc<DeviceArray>> {
        let known = locked(&self.stored).get(&quantity).cloned();
        if let Some(stored) = known {
            return Ok(stored);
        }
        let needs_gradient = |what| Error::usage(what).expected("a gradient-magnitude node before this one");
        let stored = match &quantity {
            ValueArray::Scalar => self.store(volume, &volume.scalar, 1, 0),
            ValueArray::GradientMagnitude => {
                let what = "the transfer function looks at the gradient magnitude, and the volume has none";
                let found = volume.gradient_magnitude.as_ref();
                self.store(volume, found.ok_or_else(|| needs_gradient(what))?, 1, 0)
            }
            ValueArray::Field(name) => {
                self.store(volume, volume.grid.field("the transfer function", name)?, 1, 0)
            }
            ValueArray::Gradient(component) => {
                let what = "light and silhouettes need a gradient at every point";
                let found = volume.gradient.as_ref().filter(|all| all.len() == volume.grid.points.len());
                let found = found.ok_or_else(|| needs_gradient(what))?;
                self.store(volume, bytemuck::cast_slice(found), 3, *component)
            }
        }?;
        let mut all = locked(&self.stored);
        Ok(all.entry(quantity).or_insert_with(|| Arc::new(stored)).clone())
    }

    /// Every `stride`th value from `first` on. Vectors keep their direction: no offset, and one scale for all components.
    fn store(&self, volume: &Volume, values: &[f64], stride: usize, first: usize) -> Result<DeviceArray> {
        let [low, high] = extent::range(values).unwrap_or_default();
        let (middle, span) = match stride {
            1 => (low + 0.5 * (high - low), high - low),
            _ => (0.0, low.abs().max(high.abs())),
        };
        // From 0 small values keep all their digits, which logarithmic axes show; values far from it are told apart about their middle.
        let origin = if middle.abs() <= span { 0.0 } else { middle };
        let span = if span > 0.0 && span.is_finite() { span } else { 1.0 };
        let value = |point: usize| values[point * stride + first];
        let widest = |cell: &[u32; 4]| {
            let [low, high] = extent::range(&cell.map(|p| value(p as usize))).unwrap_or_default();
            high - low
        };
        let cells = volume.grid.tetrahedra.par_iter().with_min_len(1 << 14);
        let cell_span = cells.map(widest).reduce(|| 0.0, f64::max) / span;
        let parts = |point: usize| split((value(point) - origin) / span);
        let layout = sizes(volume).layout(self.device.room());
        let count = values.len() / stride;
        let values = self.device.upload_parted(GridArray::Quantity, &layout, count, parts)?;
        self.device.count(|work| work.uploads += 1);
        Ok(DeviceArray { values, origin, span, cell_span, range: [low, high] })
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

/// The numbers that the device counts a value from, in units of its span from its origin: high and low part.
pub(crate) fn offset_parts(stored: &DeviceArray, axis: &Axis) -> [f32; 2] {
    split((axis.offset - stored.origin) / stored.span)
}

/// Storage of a value along a segment. `number`: 0 for s, 1 for g, further on for fields.
pub(crate) fn value_axis(stored: &DeviceArray, transfer_function: &TransferFunction, number: usize) -> Axis {
    match scale(transfer_function, number).is_curved() {
        true => Axis { offset: 0.0, scale: stored.span },
        false => widget_axis(stored, transfer_function, number),
    }
}

/// Storage of a value as widgets are compared with it: of its position, on a curved axis.
pub(crate) fn widget_axis(stored: &DeviceArray, transfer_function: &TransferFunction, number: usize) -> Axis {
    let scale = scale(transfer_function, number);
    let (range, span) = match scale.positions(stored.range) {
        _ if !scale.is_curved() => (stored.range, stored.span),
        [low, high] if high > low && high.is_finite() => ([low, high], high - low),
        // Constant, or without positions.
        [_, high] => ([if high.is_finite() { high } else { 0.0 }; 2], 1.0),
    };
    let [low, high] = range;
    // Just beside the values serves, too: widths are counted from 0, however small the least of them.
    let near = low - span..=high + span;
    let centre = transfer_function.axis_origin(number).filter(|centre| near.contains(centre));
    Axis { offset: centre.unwrap_or(low + 0.5 * (high - low)), scale: span }
}

/// Scale of the axis of a value; those of further fields are linear.
fn scale(transfer_function: &TransferFunction, number: usize) -> AxisScale {
    transfer_function.axes_read().get(number).copied().unwrap_or_default()
}

/// A number as the sum of two of 32 bits.
pub(crate) fn split(x: f64) -> [f32; 2] {
    let high = x as f32;
    [high, (x - f64::from(high)) as f32]
}

#[cfg(test)]
mod tests {
    use super::*;

    const MIB: u64 = 1 << 20;

    /// A cube of points, six cells to a voxel.
    fn cube(cells: u64) -> BufferSizes {
        BufferSizes {
            points: cells / 6,
            cells,
            stride: 1,
            scene_buffers: 1,
            own_buffers: 3,
            ..BufferSizes::default()
        }
    }

    #[test]
    fn large_grids_stand_in_so_many_parts() {
        let small = BindingLimits { bytes: 128 * MIB, buffers: 32 };
        let count = |layout: Layout| GridArray::ALL.map(|array| layout.parts(array).count);
        // Positions, a quantity, seen points, attributes, tetrahedra, bounds: 24, 8, 16, 4 bytes a point, 16, 8 a cell.
        assert_eq!(count(cube(16_000_000).layout(small)), [1, 1, 1, 1, 2, 1]);
        assert_eq!(count(cube(100_000_000).layout(small)), [4, 1, 2, 1, 12, 6]);
        let large = BindingLimits { bytes: 2048 * MIB, buffers: 32 };
        assert_eq!(count(cube(16_000_000).layout(large)), [1; 6]);
        assert_eq!(count(cube(100_000_000).layout(large)), [1; 6]);
        assert_eq!(count(cube(1_000_000_000).layout(large)), [3, 1, 2, 1, 8, 4]);
        // Three of the tiles' own, `numbers`, and the parts.
        assert_eq!(cube(16_000_000).buffers(small), 3 + 1 + 5);
        assert_eq!(cube(100_000_000).buffers(small), 3 + 1 + 21);
        assert_eq!(cube(100_000_000).buffers(large), 3 + 1 + 4);
    }

    #[test]
    fn what_has_too_many_parts_is_named_with_what_would_do() {
        let room = BindingLimits { bytes: 128 * MIB, buffers: 10 };
        cube(8_000_000).check(room, "it").expect("fits");
        let error = cube(100_000_000).check(room, "it").expect_err("does not fit").to_string();
        for word in ["25 buffers", "the grid's cells of 1526 MiB in 12 parts", "10 buffers of 128 MiB", "cpu"]
        {
            assert!(error.contains(word), "'{word}' is not in: {error}");
        }
        // 2²⁴ cells fill two bindings, and their bounds one.
        assert!(error.contains("about 16700000 such cells"), "{error}");
        let error = BufferSizes { texels: 1 << 28, ..cube(100) }
            .check(room, "it")
            .expect_err("too large")
            .to_string();
        assert!(
            error.contains("table of 4096 MiB in 32 parts") && error.contains("a smaller table"),
            "{error}"
        );
        let vast = BufferSizes { points: 1 << 40, cells: 1 << 42, ..BufferSizes::default() };
        let error = vast
            .check(BindingLimits { bytes: u64::MAX, buffers: 1 << 20 }, "it")
            .expect_err("too many")
            .to_string();
        assert!(error.contains("4398046511104 cells"), "{error}");
    }

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

    #[test]
    fn two_parts_hold_a_number_to_48_bits() {
        for x in [0.1, -1.0 / 3.0, 1e-9, 0.5] {
            let [high, low] = split(x).map(f64::from);
            assert!((high + low - x).abs() <= x.abs() * 2f64.powi(-47), "{x}");
        }
    }
}
