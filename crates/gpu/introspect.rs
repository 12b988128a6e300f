//! Device of an engine, and single ray segments through the composed shaders, for comparison with exact values. No part of the
//! public interface: it changes with the engine.

use crate::device::pipelines::{Binding, Bound, Program, in_order};
use crate::device::{Device, Timing};
use crate::engine::GpuEngine;
use std::any::Any;
use std::sync::Arc;
use voltet_core::Result;
use voltet_core::transfer::TransferFunction;
use voltet_optics::engine::{Engine, Stage};
use voltet_optics::integrators::Extent;
use voltet_optics::shading::{Integrator, Shading};
use voltet_optics::{Contribution, Segment, WidgetBlend};
use voltet_shaders::segment_list::{CONTRIBUTION, axes, constants, contributions, holds, row};
use voltet_shaders::{CompositorProgram, Parameters, Resources, Shader, ShaderKey, compose, compose_pieces};
use wgpu::BufferUsages;

/// Device of an engine, if it is this crate's.
pub fn device_of(engine: &dyn Engine) -> Option<&Arc<Device>> {
    (engine as &dyn Any).downcast_ref().map(|GpuEngine { device, .. }| device)
}

/// Segments that one dispatch composites: a software driver ends loops after 65,535 rounds in all.
const CHAIN_PART: usize = 1 << 14;

/// Single segments.
impl Device {
    /// Integrates a segment by the closed forms. The inner error is the reason that the device refuses it before it draws.
    /// Errors: a device that fails on the way.
    pub fn integrate_segment(
        &self,
        transfer_function: &TransferFunction,
        segment: &Segment,
        overlap: WidgetBlend,
    ) -> Result<std::result::Result<Contribution, &'static str>> {
        let shading = Shading { integrator: Integrator::ANALYTIC, overlap, silhouette: None, light: None };
        let shader_key = ShaderKey::new(transfer_function, &shading, CompositorProgram::Segments)?;
        let axes = axes(transfer_function, segment);
        let length = segment.length;
        let Ok(parameters) = Parameters::new(transfer_function, &shading, &axes, length) else {
            return Ok(Err("numbers leave the range of 32 bits"));
        };
        if holds(&shader_key, transfer_function, segment).is_err() {
            return Ok(Err("the device refuses what 32 bits do not hold, and `auto` takes the CPU"));
        }
        let scene = self.uniform("the scene", &parameters.scene_bytes())?;
        // Closed forms read no table of lengths.
        let extent = Extent { scalar: [0.0; 2], longest: 1.0 };
        let numbers = &parameters.numbers;
        let resources =
            Resources::new(&shader_key, transfer_function, &shading, axes[0], length, &extent, numbers)?;
        let mut numbers = Vec::new();
        for buffer in &resources.buffers {
            if let Some(binding) = buffer.binding {
                numbers.push((binding, self.upload_items("the scene's numbers", &buffer.contents.bytes)?));
            }
        }
        let mut read = in_order([(Bound::Uniform, &scene)]);
        read.extend(numbers.iter().map(|(at, buffer)| (*at, Bound::Read, buffer.as_entire_binding())));
        let shader = compose(&shader_key);
        let rows = self.upload_items("a segment", &row(&shader_key, &axes, length, segment))?;
        let constants = constants(&shader_key, &shader);
        let initial = [f32::NAN; CONTRIBUTION];
        let found = self.run_on_rows("integrate_segments", &shader, constants, &read, &rows, &initial)?;
        Ok(Ok(contributions(&found)[0]))
    }

    fn upload_items<U: bytemuck::Pod + Send + Sync>(&self, what: &str, items: &[U]) -> Result<wgpu::Buffer> {
        self.upload(what, items.len(), |i| items[i])
    }

    /// A pass of one workgroup over rows; `values`: what its output holds before.
    fn run_on_rows(
        &self,
        entry_point: &'static str,
        shader: &Shader,
        constants: &[(&'static str, f64)],
        read: &[Binding],
        rows: &wgpu::Buffer,
        values: &[f32],
    ) -> Result<Vec<f32>> {
        let bytes = size_of_val(values) as u64;
        let output = self.upload_items("the values", values)?;
        let usage = BufferUsages::MAP_READ | BufferUsages::COPY_DST;
        let returned = self.buffer("the values on their way back", bytes, usage)?;
        let pass = self.pass(&Program {
            name: (entry_point, Stage::Composite),
            shader,
            constants: constants.to_vec(),
            groups: [read, &in_order([(Bound::Read, rows), (Bound::Write, &output)]), &[]],
            workgroups: [1; 3],
        })?;
        self.submit("a segment", |encoder| {
            pass.run(encoder, &mut Timing::default());
            encoder.copy_buffer_to_buffer(&output, 0, &returned, 0, bytes);
        })?;
        self.read("the values", &returned, bytes, bytemuck::pod_collect_to_vec)
    }

    /// The pass `evaluate` of a piece, over rows of four numbers.
    fn evaluate(&self, piece: &str, rows: &[[f32; 4]], values: &[f32]) -> Result<Vec<f32>> {
        let shader = compose_pieces("", &[piece]);
        let rows = self.upload_items("the rows", rows)?;
        self.run_on_rows("evaluate", &shader, &[], &[], &rows, values)
    }

    /// Composites segments front to back: r, g, b, A as it is summed, 1 − A, and A. Errors: a device that fails on the way.
    pub fn composite_chain(&self, segments: &[Contribution]) -> Result<[f64; 6]> {
        let row = |c: &Contribution| [c.color[0], c.color[1], c.color[2], c.opacity].map(|x| x as f32);
        let rows: Vec<[f32; 4]> = segments.iter().map(row).collect();
        // Nothing yet, and a transparency of 1.
        let mut values = vec![0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0];
        for part in rows.chunks(CHAIN_PART) {
            values = self.evaluate("measured/compositing_chain", part, &values)?;
        }
        Ok(std::array::from_fn(|i| f64::from(values[i])))
    }

    /// ψ, F, B and ζ of linear extinction from a to b. Errors: a device that fails on the way.
    pub fn partial_integrals(&self, a: f64, b: f64) -> Result<[f64; 4]> {
        let rows = [[a as f32, b as f32, (0.5 * (a + b)) as f32, 0.0]];
        let values = self.evaluate("measured/partial_integrals", &rows, &[f32::NAN; 4])?;
        Ok(std::array::from_fn(|i| f64::from(values[i])))
    }
}
