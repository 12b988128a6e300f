//! The compositors that blend: all cells sorted by distance, drawn farthest first and blended by the hardware.
//!
//! The sorted list is drawn in runs. Each is one indirect draw of a fixed number of vertices and triangles a cell, whose
//! indices are the same for all runs; so what drawing takes is a picture, one list of indices, and for triangles the corners
//! of one run, whatever the grid's size.

use crate::bound_pass::{Binder, ENTRY_BYTES, ROUNDS, SortBuffers, folded};
use crate::device::pipelines::{Binding, Bound, BoundGroups, BoundPass, Program, in_order};
use crate::device::{Device, GrowingBuffer, Timing};
use crate::grid::DeviceArray;
use std::sync::Arc;
use voltet_core::{Error, Result, counted};
use voltet_optics::engine::{Compositor, Stage};
use voltet_shaders::{Blend, FramePass, RunRecord, Shader, ViewRecord};
use wgpu::{
    BindingResource, BlendComponent, BlendFactor, BlendState, Buffer, BufferUsages, CommandEncoder,
    DownlevelFlags, ShaderStages, TextureFormat,
};

#[derive(Debug, PartialEq)]
pub(crate) struct CellPrimitive {
    /// Entry points for vertices and for pixels.
    entry_points: [&'static str; 2],
    triangles: &'static [[u32; 3]],
    vertices: u32,
}

/// Outlines of four vertices in a ring, which are found while they are drawn.
pub(crate) const OUTLINES: &CellPrimitive = &CellPrimitive {
    entry_points: ["outline_cell", "blend_cell"],
    triangles: &[[0, 1, 2], [0, 2, 3]],
    vertices: 4,
};

/// Triangles round the thick vertex, the first of five, which a pass splits each run into.
pub(crate) const TRIANGLES: &CellPrimitive = &CellPrimitive {
    entry_points: ["place_corner", "blend_triangle"],
    triangles: &[[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 1]],
    vertices: 5,
};

impl CellPrimitive {
    fn indices(&self, run_length: u32) -> Vec<u32> {
        let of_cell = |cell| self.triangles.as_flattened().iter().map(move |k| self.vertices * cell + k);
        (0..run_length).flat_map(of_cell).collect()
    }
}

const RUN_LENGTH: u32 = 1 << 16;

/// Runs of one submission, so that no system takes a long frame for a hang: 4 million cells.
const RUNS_AT_A_TIME: u32 = 64;

/// Buffers of the raster that stay between frames.
#[derive(Default)]
pub(crate) struct RasterBuffers {
    sort: SortBuffers,
    draws: GrowingBuffer,
    /// With the primitive and the run's length that they are for.
    indices: Option<((&'static CellPrimitive, u32), Buffer)>,
    canvas: Canvas,
    /// The corners of a run's triangles.
    split: GrowingBuffer,
    /// Cells of a run, where it is not [`RUN_LENGTH`].
    pub run_length: Option<u32>,
}

/// Inputs of [`Raster::new`].
pub(crate) struct Blending<'a> {
    pub shader: &'a Shader,
    pub primitive: &'static CellPrimitive,
    pub target: Target,
    pub sorted: bool,
    /// The window, in tiles.
    pub window: [u32; 4],
    pub scalar: &'a DeviceArray,
    /// Group 0: the scene and its tables.
    pub scene: &'a [Binding<'a>],
    /// Group 2: arrays of the grid that are read.
    pub in_grid: &'a [Binding<'a>],
    pub pixels: &'a Buffer,
}

/// The passes over one window.
pub(crate) struct Raster {
    sort: Vec<BoundPass>,
    /// For each run, where cells are split into triangles.
    split: Vec<BoundPass>,
    /// The entry point for pixels.
    name: &'static str,
    pipeline: Arc<wgpu::RenderPipeline>,
    groups: BoundGroups,
    canvas: wgpu::TextureView,
    indices: Buffer,
    draws: Buffer,
    run_count: u32,
    take: BoundPass,
}

impl Raster {
    /// Makes what is missing of the buffers, and binds it.
    pub fn new(blending: &Blending, kept: &mut RasterBuffers, binder: &Binder) -> Result<Raster> {
        let &Blending { shader, primitive, ref target, sorted, window, scalar, scene, in_grid, pixels } =
            blending;
        let (device, cell_count) = (&binder.grid.device, binder.grid.cell_count);
        // A run's corners stand in one binding.
        let fit = (device.most_bytes() / RunRecord::CELL_BYTES).max(1);
        let most = if primitive == TRIANGLES { fit.try_into().unwrap_or(u32::MAX) } else { u32::MAX };
        let run_length = kept.run_length.unwrap_or(RUN_LENGTH).min(most);
        let run_count = cell_count.div_ceil(run_length);
        let rounds = if sorted { ROUNDS } else { 1 };
        let list = kept.sort.sort(binder, cell_count, rounds, true, scalar)?;
        let usage = BufferUsages::STORAGE | BufferUsages::INDIRECT;
        let draws_size = 20 * u64::from(run_count);
        let draws = kept.draws.at_least(draws_size, |size| device.buffer("the draws", size, usage))?;
        let mut steps = list.steps;
        let most = device.limits.max_compute_workgroups_per_dimension;
        // The vertices of triangles are those of a run, others count through the list.
        let vertices = if primitive == OUTLINES { primitive.vertices } else { 0 };
        let constants = vec![
            ("run_length", f64::from(run_length)),
            ("cell_indices", 3.0 * primitive.triangles.len() as f64),
            ("cell_vertices", f64::from(vertices)),
        ];
        let own = [&draws, &list.digit_counts];
        steps.push(binder.step(FramePass::Runs, folded(run_count, most), constants, &own, scalar)?);
        let mut split = Vec::new();
        // What vertices are read from.
        let drawn = if primitive == OUTLINES {
            list.sorted.clone()
        } else {
            let run_cells = run_length.min(cell_count);
            let size = u64::from(run_cells) * RunRecord::CELL_BYTES;
            let corners = kept.split.at_least(size, |size| device.storage("the corners of a run", size))?;
            for number in 0..run_count {
                let record = RunRecord { first: number * run_length, length: run_length, padding: [0; 2] };
                let this = device.uniform("a run", bytemuck::bytes_of(&record))?;
                let own = [&this, &list.sorted, &list.digit_counts, &corners];
                let over_run = folded(run_cells, most);
                split.push(binder.step(FramePass::Split, over_run, vec![], &own, scalar)?);
            }
            corners
        };

        let size = [window[2], window[3]].map(|tiles| tiles * ViewRecord::TILE);
        let canvas = kept.canvas.texture(device, size, target.format)?;
        let own = in_order([(Bound::Uniform, binder.view), (Bound::Read, &drawn)]);
        let groups = [scene, &own, in_grid];
        let pipeline = device.drawing(shader, primitive.entry_points, target, &groups)?;
        let groups = device.bind(&groups, |number| pipeline.get_bind_group_layout(number));

        let mut own = in_order([(Bound::Uniform, binder.view)]);
        own.push((2, Bound::Texels, BindingResource::TextureView(&canvas)));
        own.push((3, Bound::Write, pixels.as_entire_binding()));
        let take = device.pass(&Program {
            name: ("take_blended", Stage::Composite),
            shader,
            constants: vec![],
            groups: [scene, &own, &[]],
            workgroups: [window[2], window[3], 1],
        })?;
        Ok(Raster {
            sort: steps,
            split,
            name: primitive.entry_points[1],
            pipeline,
            groups,
            canvas,
            indices: kept.indices(device, primitive, run_length.min(cell_count))?,
            draws,
            run_count,
            take,
        })
    }

    /// Sorts, draws all runs and takes the picture. A long list is submitted in parts.
    pub fn encode(&self, device: &Device, encoder: &mut CommandEncoder, timing: &mut Timing) {
        self.sort.iter().for_each(|step| step.run(encoder, timing));
        let mut first = 0;
        loop {
            let end = (first + RUNS_AT_A_TIME).min(self.run_count);
            if self.split.is_empty() {
                self.draw(encoder, first..end, timing);
            } else {
                for (number, split) in (first..end).zip(&self.split[first as usize..]) {
                    split.run(encoder, timing);
                    self.draw(encoder, number..number + 1, timing);
                }
            }
            first = end;
            if first == self.run_count {
                break;
            }
            let next = device.device.create_command_encoder(&Default::default());
            device.queue.submit([std::mem::replace(encoder, next).finish()]);
        }
        self.take.run(encoder, timing);
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
        let times = timing.next((self.name, Stage::Composite));
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(self.name),
            color_attachments: &[Some(attachment)],
            timestamp_writes: times.map(|times| wgpu::RenderPassTimestampWrites {
                query_set: times.query_set,
                beginning_of_pass_write_index: times.beginning_of_pass_write_index,
                end_of_pass_write_index: times.end_of_pass_write_index,
            }),
            ..Default::default()
        });
        pass.set_pipeline(&self.pipeline);
        self.groups.iter().for_each(|(number, group)| pass.set_bind_group(*number, group, &[]));
        pass.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint32);
        for number in runs {
            pass.draw_indexed_indirect(&self.draws, 20 * u64::from(number));
        }
    }
}

impl RasterBuffers {
    fn indices(
        &mut self,
        device: &Device,
        primitive: &'static CellPrimitive,
        run_length: u32,
    ) -> Result<Buffer> {
        let key = (primitive, run_length);
        if let Some((_, known)) = self.indices.as_ref().filter(|(known, _)| *known == key) {
            return Ok(known.clone());
        }
        let indices = primitive.indices(run_length);
        let usage = BufferUsages::INDEX | BufferUsages::COPY_DST;
        let made = device.buffer("the indices of a run", 4 * indices.len() as u64, usage)?;
        device.guarded("the indices of a run", || {
            device.write(&made, 0, bytemuck::cast_slice(&indices));
        })?;
        self.indices = Some((key, made.clone()));
        Ok(made)
    }
}

/// Picture that is drawn into: its format, and how each colour is blended with what is there.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Target {
    format: TextureFormat,
    blend: BlendState,
}

impl Target {
    /// One number a pixel where the scene has one colour, else four; of 32 bits where the device blends these.
    ///
    /// Colours come farthest first, each over what is there: C ← C_seg + (1 − A_seg) C. The other way round, each would
    /// be weighted by 1 − A of the sum, which has few digits left where little more is seen.
    pub fn new(blend: Blend, depths_add_up: bool, wide: bool) -> Target {
        let (format, dst_factor) = match blend {
            Blend::Over if wide => (TextureFormat::Rgba32Float, BlendFactor::OneMinusSrcAlpha),
            Blend::Over => (TextureFormat::Rgba16Float, BlendFactor::OneMinusSrcAlpha),
            Blend::Sum => (
                if wide { TextureFormat::R32Float } else { TextureFormat::R16Float },
                if depths_add_up { BlendFactor::One } else { BlendFactor::OneMinusSrc },
            ),
        };
        let operation = wgpu::BlendOperation::Add;
        let component = BlendComponent { src_factor: BlendFactor::One, dst_factor, operation };
        Target { format, blend: BlendState { color: component, alpha: component } }
    }
}

/// Device capabilities that drawing needs beyond those of the tiles' compositor.
const NEEDED: [(DownlevelFlags, &str); 2] = [
    (DownlevelFlags::VERTEX_STORAGE, "storage buffers for vertices"),
    (DownlevelFlags::INDIRECT_EXECUTION, "draws whose counts stand in a buffer"),
];

/// An error that names what is lacking.
fn check_flags(found: DownlevelFlags, device: &str, compositor: &str) -> Result<()> {
    let lacking = NEEDED.iter().filter(|(flag, _)| !found.contains(*flag));
    let lacking: Vec<&str> = lacking.map(|(_, what)| *what).collect();
    if lacking.is_empty() {
        return Ok(());
    }
    Err(Error::run(format!("{device} lacks what compositor = \"{compositor}\" draws with"))
        .got(format!("no {}", lacking.join(", no ")))
        .expected("compositor = \"tiles\""))
}

impl Device {
    /// An error that names what the device lacks for a compositor that blends, or how many cells its list holds.
    pub fn check_blending(&self, compositing: Compositor, cell_count: u64) -> Result<()> {
        let most = self.most_bytes() / ENTRY_BYTES;
        if most < cell_count {
            return Err(Error::run(format!("the sorted cells do not fit one binding of {}", self.name))
                .got(counted(cell_count, "cell"))
                .expected(format!("at most {most}, or compositor = \"tiles\"")));
        }
        check_flags(self.downlevel, &self.name, compositing.name())
    }

    /// The pipeline, compiled if it is not there. `entry_points`: for vertices and for pixels.
    fn drawing(
        &self,
        shader: &Shader,
        entry_points: [&'static str; 2],
        target: &Target,
        groups: &[&[Binding]; 3],
    ) -> Result<Arc<wgpu::RenderPipeline>> {
        let key = (shader.text.clone(), entry_points[1], format!("{target:?}"));
        self.cached(&self.drawings, key, || self.compile_drawing(shader, entry_points, target, groups))
    }

    fn compile_drawing(
        &self,
        shader: &Shader,
        [vertex, fragment]: [&'static str; 2],
        target: &Target,
        groups: &[&[Binding]; 3],
    ) -> Result<wgpu::RenderPipeline> {
        let module = self.module(shader, fragment)?;
        self.guarded(fragment, || {
            let color = wgpu::ColorTargetState {
                format: target.format,
                blend: Some(target.blend),
                write_mask: wgpu::ColorWrites::ALL,
            };
            self.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some(fragment),
                layout: Some(&self.pipeline_layout(fragment, groups, ShaderStages::VERTEX_FRAGMENT)),
                vertex: wgpu::VertexState {
                    module: &module,
                    entry_point: Some(vertex),
                    compilation_options: Default::default(),
                    buffers: &[],
                },
                primitive: wgpu::PrimitiveState::default(),
                depth_stencil: None,
                multisample: wgpu::MultisampleState::default(),
                fragment: Some(wgpu::FragmentState {
                    module: &module,
                    entry_point: Some(fragment),
                    compilation_options: Default::default(),
                    targets: &[Some(color)],
                }),
                multiview_mask: None,
                cache: None,
            })
        })
    }
}

/// A texture to draw into, kept while size and format stay the same.
#[derive(Default)]
pub(crate) struct Canvas {
    made: Option<wgpu::Texture>,
}

impl Canvas {
    /// The texture of exactly this size: a pixel's place in the window is its place in the texture.
    pub fn texture(
        &mut self,
        device: &Device,
        size: [u32; 2],
        format: TextureFormat,
    ) -> Result<wgpu::TextureView> {
        let [width, height] = size;
        let fits = |t: &wgpu::Texture| t.width() == width && t.height() == height && t.format() == format;
        if !self.made.as_ref().is_some_and(fits) {
            // The old one goes first: there may not be room for both.
            self.made = None;
            let descriptor = wgpu::TextureDescriptor {
                label: Some("what is blended"),
                size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
                view_formats: &[],
            };
            let what = format!("the picture that is blended ({width} × {height})");
            self.made = Some(device.guarded(&what, || device.device.create_texture(&descriptor))?);
        }
        let made = self.made.as_ref().expect("made above");
        Ok(made.create_view(&Default::default()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_device_lacks_is_named() {
        check_flags(DownlevelFlags::all(), "it", "raster").expect("lacks nothing");
        let without = DownlevelFlags::all() - DownlevelFlags::VERTEX_STORAGE;
        let error = check_flags(without, "it", "raster").expect_err("lacks one").to_string();
        for word in ["it lacks", "raster", "no storage buffers for vertices", "tiles"] {
            assert!(error.contains(word), "'{word}' is not in: {error}");
        }
        assert!(!error.contains("draws whose"), "{error}");
    }
}
