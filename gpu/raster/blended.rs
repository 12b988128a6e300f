//! The raster compositor: all cells sorted by distance, drawn farthest first and blended by the hardware.
//!
//! The sorted list is drawn in runs. Each is one indirect draw of four vertices and two triangles a cell, whose indices
//! are the same for all runs; so what drawing takes is a picture, and one list of indices, whatever the grid's size.

use crate::device::bindings::{Bound, in_order};
use crate::device::buffers::Growing;
use crate::device::open::Device;
use crate::device::pipelines::Program;
use crate::device::timing::Timing;
use crate::grid::uploaded::Stored;
use crate::pass::steps::{Binder, Step, buffers, folded, kinds, run, scene_kinds};
use crate::raster::drawing::{Canvas, Drawing, Target};
use crate::raster::sort::{ROUNDS, SortBuffers};
use std::sync::Arc;
use voltet_core::Result;
use voltet_core::engine::Stage;
use voltet_shaders::{Blend, CELLS_READ, FramePass, GRID_GROUP, Shader, ViewRecord};
use wgpu::{Buffer, BufferUsages, CommandEncoder};

/// Cells of a run.
const RUN_LENGTH: u32 = 1 << 16;

/// Runs of one submission, so that no system takes a long frame for a hang: 4 million cells.
const RUNS_AT_A_TIME: u32 = 64;

/// Buffers of the raster that stay between frames.
#[derive(Default)]
pub(crate) struct RasterBuffers {
    sort: SortBuffers,
    draws: Growing,
    /// With the run's length that they are for.
    indices: Option<(u32, Buffer)>,
    canvas: Canvas,
    /// Cells of a run, where it is not [`RUN_LENGTH`].
    pub run_length: Option<u32>,
}

/// What is drawn.
pub(crate) struct Blending<'a> {
    pub shader: &'a Shader,
    pub blend: Blend,
    /// Whether optical depths add up; else opacities are composited.
    pub depths_add_up: bool,
    pub sorted: bool,
    /// The window, in tiles.
    pub window: [u32; 4],
    pub scalar: &'a Stored,
    /// Group 0: the scene and its tables.
    pub scene: &'a [(u32, &'a Buffer)],
    /// Where the picture goes.
    pub pixels: &'a Buffer,
}

/// The passes over one window.
pub(crate) struct Raster {
    sort: Vec<Step>,
    pipeline: Arc<wgpu::RenderPipeline>,
    groups: [wgpu::BindGroup; 3],
    canvas: wgpu::TextureView,
    indices: Buffer,
    draws: Buffer,
    run_count: u32,
    take: Step,
}

/// Six indices a cell: two triangles of its four vertices.
fn indices(run_length: u32) -> Vec<u32> {
    (0..run_length).flat_map(|cell| [0, 1, 2, 0, 2, 3].map(|corner| 4 * cell + corner)).collect()
}

impl Raster {
    /// Makes what is missing of the buffers, and binds it.
    pub fn new(blending: &Blending, kept: &mut RasterBuffers, binder: &Binder) -> Result<Raster> {
        let &Blending { shader, blend, depths_add_up, sorted, window, scalar, scene, pixels } = blending;
        let (device, cell_count) = (binder.device, binder.arrays.grid.cell_count);
        let scene_kinds = scene_kinds(scene);
        let run_length = kept.run_length.unwrap_or(RUN_LENGTH);
        let run_count = cell_count.div_ceil(run_length);
        let rounds = if sorted { ROUNDS } else { 1 };
        let list = kept.sort.sort(binder, cell_count, rounds, true, scalar)?;
        let usage = BufferUsages::STORAGE | BufferUsages::INDIRECT;
        let draws_size = 20 * u64::from(run_count);
        let draws = kept.draws.at_least(draws_size, |size| device.buffer("the draws", size, usage))?;
        let mut steps = list.steps;
        steps.push(binder.step(
            FramePass::Runs,
            folded(run_count, device.limits.max_compute_workgroups_per_dimension),
            vec![("run_length", f64::from(run_length))],
            &[&draws, &list.digit_counts],
            scalar,
        )?);

        let target = Target::new(blend, depths_add_up, device.blends_32_bits);
        let size = [window[2], window[3]].map(|tiles| tiles * ViewRecord::TILE);
        let canvas = kept.canvas.of(device, size, target.format)?;
        let in_grid = binder.arrays.of(CELLS_READ, scalar);
        let pipeline = device.drawing(&Drawing {
            shader,
            entry_points: ["outline_cell", "blend_cell"],
            target,
            groups: [&scene_kinds, &in_order(&[Bound::Uniform, Bound::Read]), &kinds(&in_grid)],
        })?;
        let group = |number, list: &[(u32, &Buffer)]| {
            device.bind_group(&pipeline.get_bind_group_layout(number), whole(list))
        };
        let groups = [
            group(0, scene),
            group(1, &[(0, binder.view), (1, &list.sorted)]),
            group(GRID_GROUP, &buffers(&in_grid)),
        ];

        let take_kinds = [(0, Bound::Uniform), (2, Bound::Texels), (3, Bound::Write)];
        let take = device.pipeline(&Program {
            shader,
            entry_point: "take_blended",
            constants: vec![],
            groups: [&scene_kinds, &take_kinds, &[]],
        })?;
        let mut resources = whole(&[(0, binder.view), (3, pixels)]);
        resources.push((2, wgpu::BindingResource::TextureView(&canvas)));
        let take_groups = vec![
            (0, device.bind(&take, 0, scene)),
            (1, device.bind_group(&take.get_bind_group_layout(1), resources)),
        ];
        Ok(Raster {
            sort: steps,
            pipeline,
            groups,
            canvas,
            indices: kept.indices(device, run_length)?,
            draws,
            run_count,
            take: Step {
                name: ("take_blended", Stage::Composite),
                pipeline: take,
                groups: take_groups,
                workgroups: [window[2], window[3]],
            },
        })
    }

    /// Sorts, draws all runs and takes the picture. A long list is submitted in parts.
    pub fn encode(&self, device: &Device, encoder: &mut CommandEncoder, timing: &mut Timing) {
        self.sort.iter().for_each(|step| run(encoder, step, timing));
        let mut first = 0;
        loop {
            let end = (first + RUNS_AT_A_TIME).min(self.run_count);
            self.draw(encoder, first..end, timing);
            first = end;
            if first == self.run_count {
                break;
            }
            let next = device.device.create_command_encoder(&Default::default());
            device.queue.submit([std::mem::replace(encoder, next).finish()]);
        }
        run(encoder, &self.take, timing);
    }

    fn draw(&self, encoder: &mut CommandEncoder, runs: std::ops::Range<u32>, timing: &mut Timing) {
        let load = match runs.start {
            0 => wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
            _ => wgpu::LoadOp::Load,
        };
        let attachment = wgpu::RenderPassColorAttachment {
            view: &self.canvas,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations { load, store: wgpu::StoreOp::Store },
        };
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("blend_cell"),
            color_attachments: &[Some(attachment)],
            timestamp_writes: timing.next_drawing(("blend_cell", Stage::Composite)),
            ..Default::default()
        });
        pass.set_pipeline(&self.pipeline);
        for (number, group) in self.groups.iter().enumerate() {
            pass.set_bind_group(number as u32, group, &[]);
        }
        pass.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint32);
        for number in runs {
            pass.draw_indexed_indirect(&self.draws, 20 * u64::from(number));
        }
    }
}

fn whole<'a>(list: &[(u32, &'a Buffer)]) -> Vec<(u32, wgpu::BindingResource<'a>)> {
    list.iter().map(|(binding, buffer)| (*binding, buffer.as_entire_binding())).collect()
}

impl RasterBuffers {
    fn indices(&mut self, device: &Device, run_length: u32) -> Result<Buffer> {
        if let Some((_, known)) = self.indices.as_ref().filter(|(length, _)| *length == run_length) {
            return Ok(known.clone());
        }
        let indices = indices(run_length);
        let usage = BufferUsages::INDEX | BufferUsages::COPY_DST;
        let made = device.buffer("the indices of a run", 4 * indices.len() as u64, usage)?;
        device.guarded("the indices of a run", || {
            device.queue.write_buffer(&made, 0, bytemuck::cast_slice(&indices));
        })?;
        self.indices = Some((run_length, made.clone()));
        Ok(made)
    }
}
