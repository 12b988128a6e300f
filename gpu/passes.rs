//! The passes of a frame, bound to their buffers, and their order.

use crate::buffers::Growing;
use crate::device::Device;
use crate::frame::{Frame, count};
use crate::grid::Stored;
use crate::parts::{GrowingParts, Parted};
use crate::pipelines::{Bound, Program, in_order};
use crate::tables::Tables;
use crate::timing::Timing;
use std::sync::Arc;
use voltet_core::Result;
use voltet_shaders::{Access, FramePass, GRID_GROUP, GridArray, PlacementRecord, TILES_READ, ViewRecord};
use wgpu::{Buffer, BufferUsages, CommandEncoder, ComputePipeline};

/// Buffers that stay between frames.
#[derive(Default)]
pub(crate) struct FrameBuffers {
    seen: GrowingParts,
    attributes: GrowingParts,
    bounds: GrowingParts,
    listed: Growing,
    starts: Growing,
    entries: Growing,
    picture: Growing,
    states: Growing,
    counts: Growing,
    returned: Growing,
    returned_counts: Growing,
    tables: Tables,
    /// Entries of the lists that the last frame needed.
    pub capacity: u32,
    /// Whether tiles have had more work than one dispatch does, so that their pixels' states are kept.
    pub keeps_states: bool,
}

/// A compiled pass and what is bound to it.
struct Step {
    name: &'static str,
    pipeline: Arc<ComputePipeline>,
    groups: Vec<(u32, wgpu::BindGroup)>,
    workgroups: [u32; 2],
}

/// The passes over one window.
pub(crate) struct Passes<'a> {
    device: &'a Device,
    points: Step,
    attributes: Vec<Step>,
    /// Cells, starts, lists, sort.
    lists: Vec<Step>,
    tiles: Step,
    view: Buffer,
    listed: Buffer,
    counts: Buffer,
    pixels: Buffer,
    returned: Buffer,
    returned_counts: Buffer,
    picture_bytes: u64,
    keeps_states: bool,
}

/// What a pass, or without one the tiles' compositor, is bound to in group 1 behind the view.
fn bound(pass: Option<FramePass>) -> &'static [Bound] {
    use Bound::{Read, Uniform, Write};
    match pass {
        Some(FramePass::Points) => &[],
        Some(FramePass::Attribute) => &[Uniform],
        Some(FramePass::Cells) => &[Read, Write, Write],
        Some(FramePass::Starts) => &[Write, Write, Write],
        Some(FramePass::Lists) => &[Write, Write],
        Some(FramePass::Sort) => &[Read, Write],
        None => &[Read, Read, Write, Write, Write],
    }
}

/// Storage buffers of a pass, or of the tiles' compositor, beside those of the grid and of the scene.
pub(crate) fn fixed_buffers(pass: Option<FramePass>) -> u32 {
    bound(pass).iter().filter(|bound| **bound != Bound::Uniform).count() as u32
}

/// The grid's arrays as a pass reads them.
struct GridArrays<'a> {
    frame: &'a Frame<'a>,
    seen: Parted,
    attributes: Parted,
    bounds: Parted,
}

impl GridArrays<'_> {
    /// What is bound to the group of the grid, in order. `quantity`: what [`GridArray::Quantity`] stands for.
    fn of<'b>(&'b self, arrays: &[(GridArray, Access)], quantity: &'b Stored) -> Vec<(Bound, &'b Buffer)> {
        let parts = |(array, access): &(GridArray, Access)| {
            let parted = match array {
                GridArray::Positions => &self.frame.grid.positions,
                GridArray::Quantity => &quantity.values,
                GridArray::Seen => &self.seen,
                GridArray::Attributes => &self.attributes,
                GridArray::Tetrahedra => &self.frame.grid.tetrahedra,
                GridArray::Bounds => &self.bounds,
            };
            let kind = if *access == Access::Read { Bound::Read } else { Bound::Write };
            parted.buffers.iter().map(move |buffer| (kind, buffer))
        };
        arrays.iter().flat_map(parts).collect()
    }
}

/// Bytes of the counts.
const COUNTS_BYTES: u64 = count::ALL as u64 * 4;

impl<'a> Passes<'a> {
    /// Makes what is missing of the buffers, and binds it.
    pub fn new(
        frame: &'a Frame,
        window: [u32; 4],
        capacity: u32,
        buffers: &mut FrameBuffers,
    ) -> Result<Passes<'a>> {
        use Bound::{Read, Uniform};
        let (device, grid) = (frame.device(), frame.grid);
        let (sizes, layout) = (&frame.sizes, &frame.choices.layout);
        let tiles = u64::from(window[2]) * u64::from(window[3]);
        let picture_bytes = frame.picture_bytes(window);
        let states_bytes = if buffers.keeps_states { 2 * picture_bytes } else { 0 };

        let storage = |what: &'static str| move |size: u64| device.storage(what, size);
        let parted =
            |growing: &mut GrowingParts, array| growing.at_least(device, array, sizes, layout.parts(array));
        let arrays = GridArrays {
            frame,
            seen: parted(&mut buffers.seen, GridArray::Seen)?,
            attributes: parted(&mut buffers.attributes, GridArray::Attributes)?,
            bounds: parted(&mut buffers.bounds, GridArray::Bounds)?,
        };
        let listed = buffers.listed.at_least(tiles * 4, storage("the tiles' counts"))?;
        let starts = buffers.starts.at_least((tiles + 1) * 4, storage("the tiles' lists"))?;
        let entries = buffers.entries.at_least(u64::from(capacity) * 8, storage("the tiles' lists"))?;
        let pixels = buffers.picture.at_least(picture_bytes, storage("the picture"))?;
        let states = buffers.states.at_least(states_bytes, storage("the pixels' states"))?;
        let counts = buffers.counts.at_least(COUNTS_BYTES, storage("the counts"))?;
        let mapped = BufferUsages::MAP_READ | BufferUsages::COPY_DST;
        let back = |size: u64| device.buffer("the picture on its way back", size, mapped);
        let returned = buffers.returned.at_least(picture_bytes, back)?;
        let returned_counts = buffers.returned_counts.at_least(COUNTS_BYTES, back)?;
        let view = device.uniform("the view", size_of::<ViewRecord>() as u64)?;
        let scene = device.uniform("the scene", frame.scene.len() as u64)?;
        device.queue.write_buffer(&scene, 0, &frame.scene);
        let numbers = device.upload("the scene's numbers", frame.numbers.len(), |i| frame.numbers[i])?;
        let support = device.upload("the widgets' supports", frame.support.len(), |i| frame.support[i])?;

        let most = device.limits.max_compute_workgroups_per_dimension;
        let over_points = folded(grid.point_count, most);
        let over_cells = folded(grid.cell_count, most);
        let over_tiles = [window[2], window[3]];
        // The bindings of groups 1 and 2 of a pass, or of the tiles' compositor.
        let kinds = |pass: Option<FramePass>| in_order(&[&[Uniform], bound(pass)].concat());
        let grid_kinds =
            |bound: &[(Bound, &Buffer)]| in_order(&bound.iter().map(|b| b.0).collect::<Vec<_>>());
        let groups = |pipeline: &ComputePipeline, bindings: &[&Buffer], in_grid: &[(Bound, &Buffer)]| {
            let mut groups = vec![(1, device.bind(pipeline, 1, &in_order(&[&[&view], bindings].concat())))];
            if !in_grid.is_empty() {
                let in_grid: Vec<&Buffer> = in_grid.iter().map(|(_, buffer)| *buffer).collect();
                groups.push((GRID_GROUP, device.bind(pipeline, GRID_GROUP, &in_order(&in_grid))));
            }
            groups
        };
        let step = |pass: FramePass, workgroups, constants, bindings: &[&Buffer], quantity: &Stored| {
            let in_grid = arrays.of(pass.grid_arrays(), quantity);
            let program = Program {
                shader: &pass.shader(layout),
                entry_point: pass.entry_point(),
                constants,
                groups: [&[], &kinds(Some(pass)), &grid_kinds(&in_grid)],
            };
            let pipeline = device.pipeline(&program)?;
            let groups = groups(&pipeline, bindings, &in_grid);
            Ok(Step { name: pass.entry_point(), pipeline, groups, workgroups })
        };
        let scalar = &frame.scalar;
        let stride = ("ATTRIBUTE_STRIDE", sizes.stride as f64);
        let points_step = step(FramePass::Points, over_points, vec![], &[], scalar)?;
        let mut attribute_steps = Vec::new();
        for (slot, (stored, offset)) in frame.attributes.iter().enumerate() {
            let record = PlacementRecord { offset: *offset, slot: slot as u32, padding: 0 };
            let placement = device.uniform("the place of a value", size_of::<PlacementRecord>() as u64)?;
            device.queue.write_buffer(&placement, 0, bytemuck::bytes_of(&record));
            attribute_steps.push(step(
                FramePass::Attribute,
                over_points,
                vec![stride],
                &[&placement],
                stored,
            )?);
        }
        let reads_g = if frame.reads_g { 1.0 } else { 0.0 };
        let constants = vec![stride, ("reads_g", reads_g)];
        let mut lists =
            vec![step(FramePass::Cells, over_cells, constants, &[&support, &listed, &counts], scalar)?];
        lists.push(step(FramePass::Starts, [1, 1], vec![], &[&listed, &starts, &counts], scalar)?);
        lists.push(step(FramePass::Lists, over_cells, vec![], &[&listed, &entries], scalar)?);
        if frame.sorted {
            lists.push(step(FramePass::Sort, over_tiles, vec![], &[&starts, &entries], scalar)?);
        }

        let tables = buffers.tables.of(device, frame)?;
        let mut read: Vec<(u32, &Buffer)> = vec![(0, &scene)];
        for (name, binding) in &frame.storage_buffers {
            read.push((*binding, if *name == "numbers" { &numbers } else { tables.named(name)? }));
        }
        let kind = |(binding, _): &(u32, &Buffer)| (*binding, if *binding == 0 { Uniform } else { Read });
        let read_kinds: Vec<(u32, Bound)> = read.iter().map(kind).collect();
        let in_grid = arrays.of(TILES_READ, scalar);
        let pipeline = device.pipeline(&Program {
            shader: &frame.compositor,
            entry_point: "composite_tiles",
            constants: vec![],
            groups: [&read_kinds, &kinds(None), &grid_kinds(&in_grid)],
        })?;
        let mut groups = groups(&pipeline, &[&starts, &entries, &pixels, &counts, &states], &in_grid);
        groups.push((0, device.bind(&pipeline, 0, &read)));
        Ok(Passes {
            device,
            points: points_step,
            attributes: attribute_steps,
            lists,
            tiles: Step { name: "composite_tiles", pipeline, groups, workgroups: over_tiles },
            view,
            listed,
            counts,
            pixels,
            returned,
            returned_counts,
            picture_bytes,
            keeps_states: buffers.keeps_states,
        })
    }

    /// All passes of a sample. The first one of a pixel clears the counts.
    pub fn submit(&self, record: &ViewRecord, timing: &mut Timing) -> Result<()> {
        self.encode(record, timing, |encoder, timing| {
            encoder.clear_buffer(&self.listed, 0, None);
            if record.is_first == 1 {
                encoder.clear_buffer(&self.counts, 0, None);
            }
            run(encoder, &self.points, timing);
            if record.is_first == 1 {
                self.attributes.iter().for_each(|step| run(encoder, step, timing));
            }
            self.lists.iter().for_each(|step| run(encoder, step, timing));
        })
    }

    /// The tiles alone, which go on where they stopped.
    pub fn submit_tiles(&self, record: &ViewRecord, timing: &mut Timing) -> Result<()> {
        self.encode(record, timing, |_, _| {})
    }

    fn encode(
        &self,
        record: &ViewRecord,
        timing: &mut Timing,
        before: impl FnOnce(&mut CommandEncoder, &mut Timing),
    ) -> Result<()> {
        self.device.guarded("the frame", || {
            self.device.queue.write_buffer(&self.view, 0, bytemuck::bytes_of(record));
            let mut encoder = self.device.device.create_command_encoder(&Default::default());
            timing.begin();
            before(&mut encoder, timing);
            // Without states to go on from, one unfinished sample is enough for the caller to begin anew.
            if self.keeps_states {
                encoder.clear_buffer(&self.counts, 4 * count::UNFINISHED as u64, Some(4));
            }
            run(&mut encoder, &self.tiles, timing);
            timing.end(&mut encoder);
            encoder.copy_buffer_to_buffer(&self.counts, 0, &self.returned_counts, 0, COUNTS_BYTES);
            encoder.copy_buffer_to_buffer(&self.pixels, 0, &self.returned, 0, self.picture_bytes);
            self.device.queue.submit([encoder.finish()]);
        })?;
        timing.take(self.device)
    }

    /// The counts up to the last submission.
    pub fn counts(&self) -> Result<[u32; count::ALL]> {
        self.device.read("the counts", &self.returned_counts, COUNTS_BYTES, |bytes| {
            std::array::from_fn(|k| bytemuck::pod_read_unaligned(&bytes[4 * k..4 * k + 4]))
        })
    }

    /// The window's pixels after the last submission.
    pub fn picture(&self, take: impl FnOnce(&[u8])) -> Result<()> {
        self.device.read("the picture", &self.returned, self.picture_bytes, take)
    }
}

fn run(encoder: &mut CommandEncoder, step: &Step, timing: &mut Timing) {
    let descriptor =
        wgpu::ComputePassDescriptor { label: Some(step.name), timestamp_writes: timing.next(step.name) };
    let mut compute = encoder.begin_compute_pass(&descriptor);
    compute.set_pipeline(&step.pipeline);
    for (number, group) in &step.groups {
        compute.set_bind_group(*number, group, &[]);
    }
    compute.dispatch_workgroups(step.workgroups[0], step.workgroups[1], 1);
}

/// Workgroups for so many invocations, folded into rows where one row does not hold them.
fn folded(count: u32, most: u32) -> [u32; 2] {
    let groups = count.div_ceil(64).max(1);
    let rows = groups.div_ceil(most);
    [groups.div_ceil(rows), rows]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folded_rows_hold_every_invocation() {
        for (count, most) in [(0, 65535), (1, 65535), (64, 65535), (16_000_000, 65535), (u32::MAX, 65535)] {
            let [columns, rows] = folded(count, most);
            assert!(columns <= most && rows <= most);
            assert!(u64::from(columns) * u64::from(rows) * 64 >= u64::from(count), "{count}");
        }
    }
}
