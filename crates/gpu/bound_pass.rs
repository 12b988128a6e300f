//! Passes that are the same for every scene, bound: the view and what is a pass's own in group 1, the grid's arrays in group
//! 2; and the sort of all cells by distance, a radix sort on the device, which gathers the cells that can be seen on its way.

use crate::device::GrowingBuffer;
use crate::device::pipelines::{Binding, Bound, BoundPass, Program, bound, in_order};
use crate::grid::{DeviceArray, DeviceGrid, SplitBuffer};
use voltet_core::Result;
use voltet_optics::engine::Stage;
use voltet_shaders::{Access, FramePass, GridArray, Layout, RoundRecord};
use wgpu::Buffer;

fn stage(pass: FramePass) -> Stage {
    match pass {
        FramePass::Points | FramePass::Attribute | FramePass::Split => Stage::Project,
        FramePass::Cells => Stage::Cull,
        _ => Stage::Sort,
    }
}

/// Compiles passes over one grid, with the arrays that the first of them make, and binds them.
pub(crate) struct Binder<'a> {
    pub grid: &'a DeviceGrid,
    pub view: &'a Buffer,
    pub layout: &'a Layout,
    pub seen: SplitBuffer,
    pub attributes: SplitBuffer,
    pub bounds: SplitBuffer,
}

impl Binder<'_> {
    /// Bindings of the group of the grid. `quantity`: the array that [`GridArray::Quantity`] stands for.
    pub fn bindings<'b>(
        &'b self,
        arrays: &[(GridArray, Access)],
        quantity: &'b DeviceArray,
    ) -> Vec<Binding<'b>> {
        let parts = |(array, access): &(GridArray, Access)| {
            let parted = match array {
                GridArray::Positions => &self.grid.positions,
                GridArray::Quantity => &quantity.values,
                GridArray::Seen => &self.seen,
                GridArray::Attributes => &self.attributes,
                GridArray::Tetrahedra => &self.grid.tetrahedra,
                GridArray::Bounds => &self.bounds,
            };
            let kind = if *access == Access::Read { Bound::Read } else { Bound::Write };
            parted.iter().map(move |buffer| (kind, buffer))
        };
        in_order(arrays.iter().flat_map(parts))
    }

    /// A pass that is the same for every scene. `own`: see [`Binder::own`]; `quantity`: see [`Binder::bindings`].
    pub fn step(
        &self,
        pass: FramePass,
        workgroups: [u32; 3],
        constants: Vec<(&'static str, f64)>,
        own: &[&Buffer],
        quantity: &DeviceArray,
    ) -> Result<BoundPass> {
        let in_grid = self.bindings(pass.grid_arrays(), quantity);
        self.grid.device.pass(&Program {
            name: (pass.entry_point(), stage(pass)),
            shader: &pass.shader(self.layout),
            constants,
            groups: [&[], &self.own(Some(pass), own), &in_grid],
            workgroups,
        })
    }

    /// Group 1 of a pass, or without one of the tiles' compositor: the view, and behind it as many of the buffers as it binds.
    pub fn own<'b>(&'b self, pass: Option<FramePass>, buffers: &[&'b Buffer]) -> Vec<Binding<'b>> {
        let own = bound(pass).iter().zip(buffers).map(|(kind, buffer)| (*kind, *buffer));
        in_order(std::iter::once((Bound::Uniform, self.view)).chain(own))
    }
}

/// Workgroups for so many invocations, folded into rows where one row does not hold them.
pub(crate) fn folded(count: u32, most: u32) -> [u32; 3] {
    in_rows(count.div_ceil(64), most)
}

/// This number of workgroups, or a few more, folded likewise.
pub(crate) fn in_rows(groups: u32, most: u32) -> [u32; 3] {
    let groups = groups.max(1);
    let rows = groups.div_ceil(most);
    [groups.div_ceil(rows), rows, 1]
}

/// Bytes of a cell in the sorted list.
pub(crate) const ENTRY_BYTES: u64 = 8;

/// Rounds that sort every bit of a key; one gathers the cells and leaves them in their order.
pub(crate) const ROUNDS: u32 = 4;

/// Buffers of the sort that stay between frames.
#[derive(Default)]
pub(crate) struct SortBuffers {
    lists: [GrowingBuffer; 2],
    digit_counts: GrowingBuffer,
}

/// The passes, and what they leave.
pub(crate) struct Sort {
    pub steps: Vec<BoundPass>,
    /// Numbers of cells with their keys, in order.
    pub sorted: Buffer,
    /// Their count, behind one number a digit.
    pub digit_counts: Buffer,
}

impl SortBuffers {
    /// The passes of so many rounds, one or [`ROUNDS`], over at most `capacity` items: the cells that can be seen if they begin
    /// `from_cells`, else those of a list that the first round finds. `quantity`: any of the grid's.
    pub fn sort(
        &mut self,
        binder: &Binder,
        capacity: u32,
        rounds: u32,
        from_cells: bool,
        quantity: &DeviceArray,
    ) -> Result<Sort> {
        let device = &binder.grid.device;
        let blocks = capacity.div_ceil(RoundRecord::ITEMS);
        let storage = |size: u64| device.storage("the sorted cells", size);
        let [first, second] = &mut self.lists;
        let size = u64::from(capacity) * ENTRY_BYTES;
        // One round from the cells reads no list.
        let lists =
            [first.at_least(size, storage)?, second.at_least(if rounds > 1 { size } else { 0 }, storage)?];
        let size = 4 * (u64::from(RoundRecord::DIGITS) * (u64::from(blocks) + 1) + 1);
        let digit_counts =
            self.digit_counts.at_least(size, |size| device.storage("the counts of digits", size))?;
        let over_blocks = in_rows(blocks, device.limits.max_compute_workgroups_per_dimension);
        let mut steps = Vec::new();
        for number in 0..rounds {
            let record = RoundRecord {
                shift: 8 * number,
                from_cells: u32::from(from_cells && number == 0),
                capacity,
                padding: 0,
            };
            let round = device.uniform("a round of the sort", bytemuck::bytes_of(&record))?;
            let sorted = &lists[number as usize % 2];
            let unsorted = &lists[(number as usize + 1) % 2];
            let own = [&round, unsorted, &digit_counts, sorted];
            for (pass, workgroups) in [
                (FramePass::CountDigits, over_blocks),
                (FramePass::PlaceDigits, [RoundRecord::DIGITS, 1, 1]),
                (FramePass::MoveDigits, over_blocks),
            ] {
                steps.push(binder.step(pass, workgroups, vec![], &own, quantity)?);
            }
        }
        let [first, second] = lists;
        Ok(Sort { steps, sorted: if rounds % 2 == 1 { first } else { second }, digit_counts })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::device::{Device, Timing};
    use crate::grid::{DeviceGrid, ValueArray};
    use std::sync::Arc;
    use voltet_core::volume::Volume;
    use voltet_shaders::{Layout, ViewRecord};

    #[test]
    fn folded_rows_hold_every_invocation() {
        for (count, most) in [(0, 65535), (1, 65535), (64, 65535), (16_000_000, 65535), (u32::MAX, 65535)] {
            let [columns, rows, _] = folded(count, most);
            assert!(columns <= most && rows <= most);
            assert!(u64::from(columns) * u64::from(rows) * 64 >= u64::from(count), "{count}");
        }
    }

    /// The device of the tests; `None` without one, said loudly; a failure if `VOLTET_REQUIRE_GPU` is 1.
    fn device() -> Option<Device> {
        match Device::open(std::env::var("VOLTET_ADAPTER").ok().as_deref(), false) {
            Ok(device) => Some(device),
            Err(why) => {
                voltet_testing::skipped_without_device(why);
                None
            }
        }
    }

    /// The list that the device makes of `items`, with room for `capacity`.
    fn sorted(grid: &DeviceGrid, volume: &Volume, items: &[[u32; 2]], capacity: u32) -> Vec<[u32; 2]> {
        let device: &Device = &grid.device;
        let mut buffers = SortBuffers::default();
        let view = device.uniform("the view", &[0; size_of::<ViewRecord>()]).expect("fits");
        let nothing = || vec![device.storage("nothing", 16).expect("fits")];
        let (seen, attributes, bounds) = (nothing(), nothing(), nothing());
        let binder = Binder { grid, view: &view, layout: &Layout::WHOLE, seen, attributes, bounds };
        let scalar = grid.stored(volume, ValueArray::Scalar).expect("fits");
        let sort = buffers.sort(&binder, capacity, ROUNDS, false, &scalar).expect("compiles");
        // An even number of rounds ends where it began.
        device.queue.write_buffer(&sort.sorted, 0, bytemuck::cast_slice(items));
        let count = items.len() as u32;
        device.queue.write_buffer(&sort.digit_counts, 4 * 256, bytemuck::bytes_of(&count));
        let mut encoder = device.device.create_command_encoder(&Default::default());
        let mut timing = Timing::new(device).expect("has a clock or none");
        sort.steps.iter().for_each(|step| step.run(&mut encoder, &mut timing));
        let mapped = wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST;
        let bytes = 8 * items.len() as u64;
        let back = device.buffer("the list on its way back", bytes, mapped).expect("fits");
        encoder.copy_buffer_to_buffer(&sort.sorted, 0, &back, 0, bytes);
        device.queue.submit([encoder.finish()]);
        device.read("the list", &back, bytes, bytemuck::pod_collect_to_vec).expect("is there")
    }

    /// Random keys, keys with many ties, keys that are all the same: in order, and ties as they came.
    #[test]
    fn keys_are_sorted_and_ties_stay() {
        let Some(device) = device() else { return };
        let volume = Volume {
            grid: Arc::default(),
            scalar: Default::default(),
            gradient: None,
            gradient_magnitude: None,
        };
        let grid = DeviceGrid::new(Arc::new(device), &volume).expect("fits");
        let mut state = 1u64;
        let mut random = || {
            // Steele, Lea, Flood 2014: SplitMix.
            state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
            let z = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
            (z ^ (z >> 31)) as u32
        };
        for (count, capacity) in
            [(1, 1), (2, 100), (255, 255), (4096, 4096), (4097, 4097), (9000, 20_000), (70_000, 70_000)]
        {
            for mask in [u32::MAX, 0x0003_0100, 0] {
                let items: Vec<[u32; 2]> = (0..count).map(|k| [k, random() & mask]).collect();
                let mut expected = items.clone();
                expected.sort_by_key(|item| item[1]);
                let found = sorted(&grid, &volume, &items, capacity);
                assert!(found == expected, "{count} items, mask {mask:x}");
            }
        }
    }
}
