//! The sort of all cells by distance: a radix sort on the device, which gathers the cells that can be seen on its way.

use crate::bound_pass::{Binder, BoundPass, in_rows};
use crate::device::GrowingBuffer;
use crate::grid::DeviceArray;
use voltet_core::Result;
use voltet_shaders::{FramePass, RoundRecord};
use wgpu::Buffer;

/// Bytes of a cell in the sorted list.
pub(crate) const ENTRY_BYTES: u64 = 8;

/// Rounds that sort every bit of a key; one gathers the cells and leaves them in their order.
pub(crate) const ROUNDS: u32 = 4;

/// Items to sort.
#[derive(Clone, Copy)]
pub(crate) enum Items<'a> {
    /// The cells of the grid that can be seen.
    Cells,
    /// All cells, in the order of this list, nearest first.
    Ordered(&'a Buffer),
    /// A list that the first round finds.
    #[cfg(test)]
    Listed,
}

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
    /// The passes of so many rounds, one or [`ROUNDS`], over at most `capacity` items. `quantity`: any of the grid's.
    pub fn sort(
        &mut self,
        binder: &Binder,
        capacity: u32,
        rounds: u32,
        items: Items,
        quantity: &DeviceArray,
    ) -> Result<Sort> {
        let device = binder.device;
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
                from_cells: match items {
                    Items::Cells if number == 0 => 1,
                    Items::Ordered(_) if number == 0 => 2,
                    Items::Cells | Items::Ordered(_) => 0,
                    #[cfg(test)]
                    Items::Listed => 0,
                },
                capacity,
                padding: 0,
            };
            let round = device.uniform("a round of the sort", size_of::<RoundRecord>() as u64)?;
            device.write(&round, 0, bytemuck::bytes_of(&record));
            let sorted = &lists[number as usize % 2];
            let unsorted = match items {
                Items::Ordered(list) if number == 0 => list,
                _ => &lists[(number as usize + 1) % 2],
            };
            let bindings = [&round, unsorted, &digit_counts, sorted];
            for (pass, workgroups, count) in [
                (FramePass::CountDigits, over_blocks, 3),
                (FramePass::PlaceDigits, [RoundRecord::DIGITS, 1], 3),
                (FramePass::MoveDigits, over_blocks, 4),
            ] {
                steps.push(binder.step(pass, workgroups, vec![], &bindings[..count], quantity)?);
            }
        }
        let [first, second] = lists;
        Ok(Sort { steps, sorted: if rounds % 2 == 1 { first } else { second }, digit_counts })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bound_pass::GridArrays;
    use crate::device::Device;
    use crate::device::timing::Timing;
    use crate::grid::{DeviceGrid, ValueArray};
    use std::sync::Arc;
    use voltet_core::volume::Volume;
    use voltet_shaders::{Layout, ViewRecord};

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
        let view = device.uniform("the view", size_of::<ViewRecord>() as u64).expect("fits");
        let nothing = || vec![device.storage("nothing", 16).expect("fits")];
        let arrays = GridArrays { grid, seen: nothing(), attributes: nothing(), bounds: nothing() };
        let binder = Binder { device, view: &view, arrays: &arrays, layout: &Layout::WHOLE };
        let scalar = grid.stored(volume, ValueArray::Scalar).expect("fits");
        let sort = buffers.sort(&binder, capacity, ROUNDS, Items::Listed, &scalar).expect("compiles");
        // An even number of rounds ends where it began.
        device.queue.write_buffer(&sort.sorted, 0, bytemuck::cast_slice(items));
        let count = items.len() as u32;
        device.queue.write_buffer(&sort.digit_counts, 4 * 256, bytemuck::bytes_of(&count));
        let mut encoder = device.device.create_command_encoder(&Default::default());
        let mut timing = Timing::new(device).expect("has a clock or none");
        sort.steps.iter().for_each(|step| crate::bound_pass::run(&mut encoder, step, &mut timing));
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
