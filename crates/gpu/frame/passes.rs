//! The passes of a frame, bound to their buffers, and their order.

use crate::bound_pass::{Binder, BoundPass, GridArrays, folded, kinds, run, scene_kinds};
use crate::device::pipelines::{Program, own_kinds};
use crate::device::timing::Timing;
use crate::device::{Device, PendingReadback};
use crate::frame::inputs::FrameInputs;
use crate::frame::output::counters;
use crate::frame::renderer::{FrameBuffers, ReadbackBuffers};
use crate::grid::GrowingSplitBuffer;
use crate::raster::{Blending, CellPrimitive, Raster};
use voltet_core::Result;
use voltet_optics::engine::Stage;
use voltet_shaders::{CompositorProgram, FramePass, GridArray, PlacementRecord, ViewRecord, cells_read};
use wgpu::{Buffer, BufferUsages, CommandEncoder, SubmissionIndex};

/// Passes of the compositor.
enum Last {
    Tiles(BoundPass),
    Raster(Box<Raster>),
}

/// The passes over one window.
pub(crate) struct Passes<'a> {
    device: &'a Device,
    points: BoundPass,
    attributes: Vec<BoundPass>,
    /// Cells, and for tiles starts, lists, sort.
    lists: Vec<BoundPass>,
    last: Last,
    view: Buffer,
    counts: Buffer,
    pixels: Buffer,
    returned: Buffer,
    returned_counts: Buffer,
    picture_bytes: u64,
    keeps_states: bool,
}

/// The counts, from their bytes.
pub(crate) fn counts_of(bytes: &[u8]) -> [u32; counters::ALL] {
    std::array::from_fn(|k| bytemuck::pod_read_unaligned(&bytes[4 * k..4 * k + 4]))
}

/// Bytes of the counts.
const COUNTS_BYTES: u64 = counters::ALL as u64 * 4;

/// Index behind them at which those of the tiles begin: `COUNTED` of `passes/view.wgsl`.
const TILES_COUNTED_AT: u64 = 16 * 4;

impl<'a> Passes<'a> {
    /// Makes what is missing of the buffers, and binds it.
    pub fn new(
        frame: &'a FrameInputs,
        window: [u32; 4],
        capacity: u32,
        buffers: &mut FrameBuffers,
        returning: &mut ReadbackBuffers,
    ) -> Result<Passes<'a>> {
        let (device, grid) = (frame.device(), frame.grid());
        let (sizes, layout) = (&frame.sizes, &frame.shader_key.layout);
        let tiles = u64::from(window[2]) * u64::from(window[3]);
        let picture_bytes = frame.picture_bytes(window);

        let storage = |what: &'static str| move |size: u64| device.storage(what, size);
        let parted = |growing: &mut GrowingSplitBuffer, array| {
            growing.at_least(device, array, sizes, layout.parts(array))
        };
        let arrays = GridArrays {
            grid,
            seen: parted(&mut buffers.seen, GridArray::Seen)?,
            attributes: parted(&mut buffers.attributes, GridArray::Attributes)?,
            bounds: parted(&mut buffers.bounds, GridArray::Bounds)?,
        };
        let entries = buffers.entries.at_least(u64::from(capacity) * 8, storage("the tiles' lists"))?;
        let pixels_bytes = frame.window_bytes(window, buffers.keeps_states);
        let pixels = buffers.picture.at_least(pixels_bytes, storage("the picture"))?;
        let counts = buffers.counts.at_least(TILES_COUNTED_AT + tiles * 4, storage("the tiles' counts"))?;
        let mapped = BufferUsages::MAP_READ | BufferUsages::COPY_DST;
        let back = |size: u64| device.buffer("the picture on its way back", size, mapped);
        let returned = returning.picture.at_least(picture_bytes, back)?;
        let returned_counts = returning.counts.at_least(COUNTS_BYTES, back)?;
        let view = device.uniform("the view", size_of::<ViewRecord>() as u64)?;
        let scene = device.uniform("the scene", frame.scene.len() as u64)?;
        device.write(&scene, 0, &frame.scene);
        let support = device.upload("the widgets' supports", frame.support.len(), |i| frame.support[i])?;

        let most = device.limits.max_compute_workgroups_per_dimension;
        let over_points = folded(grid.point_count, most);
        let over_cells = folded(grid.cell_count, most);
        let over_tiles = [window[2], window[3]];
        let binder = Binder { device, view: &view, arrays: &arrays, layout };
        let step = |pass, workgroups, constants, bindings: &[&Buffer], quantity| {
            binder.step(pass, workgroups, constants, bindings, quantity)
        };
        let scalar = &frame.scalar;
        let stride = ("ATTRIBUTE_STRIDE", sizes.stride as f64);
        let points_step = step(FramePass::Points, over_points, vec![], &[], scalar)?;
        let mut attribute_steps = Vec::new();
        for (slot, (stored, offset)) in frame.attributes.iter().enumerate() {
            let record = PlacementRecord { offset: *offset, slot: slot as u32, padding: 0 };
            let placement = device.uniform("the place of a value", size_of::<PlacementRecord>() as u64)?;
            device.write(&placement, 0, bytemuck::bytes_of(&record));
            attribute_steps.push(step(
                FramePass::Attribute,
                over_points,
                vec![stride],
                &[&placement],
                stored,
            )?);
        }
        let reads_g = if frame.shader_key.reads_gradient_magnitude { 1.0 } else { 0.0 };
        let blended = match frame.shader_key.compositor {
            CompositorProgram::Raster(blend) => Some((CellPrimitive::Outlines, blend)),
            CompositorProgram::Triangles(blend) => Some((CellPrimitive::Triangles, blend)),
            CompositorProgram::None | CompositorProgram::Segments | CompositorProgram::Tiles(_) => None,
        };
        let lists_tiles = if blended.is_some() { 0.0 } else { 1.0 };
        let constants = vec![stride, ("reads_g", reads_g), ("lists_tiles", lists_tiles)];
        let mut lists = vec![step(FramePass::Cells, over_cells, constants, &[&support, &counts], scalar)?];

        let tables = buffers.tables.update(
            device,
            &frame.tables,
            &frame.shader_key,
            &frame.shading,
            &frame.numbers,
        )?;
        let mut read: Vec<(u32, &Buffer)> = vec![(0, &scene)];
        for (name, binding) in frame.shader_key.storage_buffers() {
            read.push((binding, tables.named(&name)?));
        }
        let last = if let Some((form, blend)) = blended {
            let blending = Blending {
                shader: &frame.compositor,
                form,
                blend,
                in_8_bits: frame.in_8_bits,
                depths_add_up: frame.shader_key.depths_add_up(),
                sorted: frame.sorted,
                ordered: frame.ordered.as_ref(),
                window,
                cells_read: cells_read(sizes.stride as usize),
                scalar,
                scene: &read,
                pixels: &pixels,
            };
            Last::Raster(Box::new(Raster::new(&blending, &mut buffers.raster, &binder)?))
        } else {
            lists.push(step(FramePass::Starts, [1, 1], vec![], &[&counts], scalar)?);
            lists.push(step(FramePass::Lists, over_cells, vec![], &[&counts, &entries], scalar)?);
            if frame.sorted {
                lists.push(step(FramePass::Sort, over_tiles, vec![], &[&counts, &entries], scalar)?);
            }
            let in_grid = arrays.buffers(cells_read(sizes.stride as usize), scalar);
            let pipeline = device.pipeline(&Program {
                shader: &frame.compositor,
                entry_point: "composite_tiles",
                // No transparency is less than this.
                constants: if frame.stops_where_opaque { vec![] } else { vec![("OPAQUE", -1.0)] },
                groups: [&scene_kinds(&read), &own_kinds(None), &kinds(&in_grid)],
            })?;
            let bindings = [&counts, &entries, &pixels];
            let mut groups = binder.groups(&pipeline, &bindings, &in_grid);
            groups.push((0, device.bind(&pipeline, 0, &read)));
            let name = ("composite_tiles", Stage::Composite);
            Last::Tiles(BoundPass { name, pipeline, groups, workgroups: over_tiles })
        };
        Ok(Passes {
            device,
            points: points_step,
            attributes: attribute_steps,
            lists,
            last,
            view,
            counts,
            pixels,
            returned,
            returned_counts,
            picture_bytes,
            keeps_states: buffers.keeps_states,
        })
    }

    /// All passes of a sample. The first one of a pixel clears the counts.
    pub fn submit(&self, record: &ViewRecord, timing: &mut Timing) -> Result<SubmissionIndex> {
        self.encode(record, timing, |encoder, timing| {
            let kept = if record.is_first == 1 { 0 } else { TILES_COUNTED_AT };
            encoder.clear_buffer(&self.counts, kept, None);
            run(encoder, &self.points, timing);
            if record.is_first == 1 {
                self.attributes.iter().for_each(|step| run(encoder, step, timing));
            }
            self.lists.iter().for_each(|step| run(encoder, step, timing));
        })
    }

    /// The tiles alone, which go on where they stopped.
    pub fn submit_tiles(&self, record: &ViewRecord, timing: &mut Timing) -> Result<()> {
        self.encode(record, timing, |_, _| {}).map(drop)
    }

    fn encode(
        &self,
        record: &ViewRecord,
        timing: &mut Timing,
        before: impl FnOnce(&mut CommandEncoder, &mut Timing),
    ) -> Result<SubmissionIndex> {
        let submitted = self.device.guarded("the frame", || {
            self.device.write(&self.view, 0, bytemuck::bytes_of(record));
            let mut encoder = self.device.device.create_command_encoder(&Default::default());
            timing.begin();
            before(&mut encoder, timing);
            // Without states to go on from, one unfinished sample is enough for the caller to begin anew.
            if self.keeps_states {
                encoder.clear_buffer(&self.counts, 4 * counters::UNFINISHED as u64, Some(4));
            }
            match &self.last {
                Last::Tiles(tiles) => run(&mut encoder, tiles, timing),
                Last::Raster(raster) => raster.encode(self.device, &mut encoder, timing),
            }
            timing.end(&mut encoder);
            encoder.copy_buffer_to_buffer(&self.counts, 0, &self.returned_counts, 0, COUNTS_BYTES);
            // Where tiles go on, this is seldom the last time.
            if !self.keeps_states {
                self.copy_pixels(&mut encoder);
            }
            self.device.queue.submit([encoder.finish()])
        })?;
        timing.take(self.device)?;
        Ok(submitted)
    }

    /// The counts up to the last submission.
    pub fn counts(&self) -> Result<[u32; counters::ALL]> {
        self.device.read("the counts", &self.returned_counts, COUNTS_BYTES, counts_of)
    }

    /// Readbacks of the last submission: the counts and, where no states are kept, the pixels.
    pub fn send(&self, last: Option<SubmissionIndex>) -> [PendingReadback; 2] {
        let sent = |what, buffer, bytes| self.device.send(what, buffer, bytes, last.clone());
        [
            sent("the counts", &self.returned_counts, COUNTS_BYTES),
            sent("the picture", &self.returned, self.picture_bytes),
        ]
    }

    fn copy_pixels(&self, encoder: &mut CommandEncoder) {
        encoder.copy_buffer_to_buffer(&self.pixels, 0, &self.returned, 0, self.picture_bytes);
    }

    /// The window's pixels after the last submission.
    pub fn picture(&self, take: impl FnOnce(&[u8])) -> Result<()> {
        if self.keeps_states {
            self.device.guarded("the frame", || {
                let mut encoder = self.device.device.create_command_encoder(&Default::default());
                self.copy_pixels(&mut encoder);
                self.device.queue.submit([encoder.finish()]);
            })?;
        }
        self.device.read("the picture", &self.returned, self.picture_bytes, take)
    }
}
