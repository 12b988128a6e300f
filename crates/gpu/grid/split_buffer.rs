//! Arrays in parts: how those of a scene are split over the bindings of a device, and which grids have more parts than
//! it binds at a time.

use crate::device::bindings::fixed_buffers;
use crate::device::buffers::GrowingBuffer;
use crate::device::device_handle::Device;
use voltet_core::{Error, Result};
use voltet_shaders::{Access, FramePass, GridArray, Layout, Parts, TEXEL_BYTES, cells_read};

/// Bytes in a mebibyte.
const MEBIBYTE: f64 = (1u64 << 20) as f64;

/// Points, cells or a table's numbers that can be counted, so that no dispatch over them passes the last number of 32 bits.
const MAX_COUNT: u64 = 4_000_000_000;

/// Binding limits of a device.
#[derive(Debug, Clone, Copy)]
pub(crate) struct BindingLimits {
    /// Bytes of one binding.
    pub bytes: u64,
    /// Storage buffers of a pass.
    pub buffers: u32,
}

/// Sizes of the buffers that a scene needs.
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
        Layout {
            positions: parts(GridArray::Positions),
            quantity: parts(GridArray::Quantity),
            seen: parts(GridArray::Seen),
            attributes: parts(GridArray::Attributes),
            tetrahedra: parts(GridArray::Tetrahedra),
            bounds: parts(GridArray::Bounds),
            table: Parts::for_elements(self.texels, TEXEL_BYTES, room.bytes),
        }
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
        let pass = |pass: &FramePass| of(pass.grid_arrays()).saturating_add(fixed_buffers(*pass));
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
                format!("{} of {size:.0} MiB in {} parts", name(*array), layout.parts(*array).count)
            })
            .collect();
        if layout.table.count > 1 {
            let size = mib(self.texels.saturating_mul(TEXEL_BYTES));
            parts.push(format!("the integrator's table of {size:.0} MiB in {} parts", layout.table.count));
        }
        let bytes = mib(room.bytes);
        let found = match parts.is_empty() {
            true => format!("{} buffers, {} cells", self.buffers(room), self.cells),
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

/// Name of an array in errors.
fn name(array: GridArray) -> &'static str {
    match array {
        GridArray::Positions => "the grid's points",
        GridArray::Quantity => "the grid's values",
        GridArray::Seen => "the points on the screen",
        GridArray::Attributes => "the points' values",
        GridArray::Tetrahedra => "the grid's cells",
        GridArray::Bounds => "the cells' bounds",
    }
}

/// One of the grid's arrays on a device.
pub(crate) struct SplitBuffer {
    pub buffers: Vec<wgpu::Buffer>,
}

/// One that grows.
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
        let make = |size: u64| device.storage(name(array), size);
        let of = |(growing, part): (&mut GrowingBuffer, u32)| {
            growing.at_least(parts.length(part, sizes.count(array)) * bytes, make)
        };
        Ok(SplitBuffer { buffers: self.0.iter_mut().zip(0..).map(of).collect::<Result<_>>()? })
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
        parts: Parts,
        count: usize,
        element: impl Fn(usize) -> U + Sync,
    ) -> Result<SplitBuffer> {
        let mut buffers = Vec::new();
        let mut first = 0;
        for part in 0..parts.count {
            let length = parts.length(part, count as u64) as usize;
            buffers.push(self.upload(name(array), length, |i| element(first + i))?);
            first += length;
        }
        Ok(SplitBuffer { buffers })
    }
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
}
