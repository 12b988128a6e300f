//! Pipelines: compiled once for each text, entry point and set of constants, and kept by the device.

use crate::device::bindings::Bound;
use crate::device::device_handle::Device;
use crate::device::pipeline_cache::PassKey;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use voltet_core::Result;
use voltet_shaders::Shader;
use wgpu::{BufferBindingType, ShaderStages};

/// A pass to compile: groups 0, 1 and 2.
pub(crate) struct Program<'a> {
    pub shader: &'a Shader,
    pub entry_point: &'static str,
    pub constants: Vec<(&'static str, f64)>,
    /// Bindings, in their order.
    pub groups: [&'a [(u32, Bound)]; 3],
}

impl Device {
    /// The pipeline, compiled if it is not there. A compiler's complaint comes at the piece's own file and line.
    pub(crate) fn pipeline(&self, program: &Program) -> Result<Arc<wgpu::ComputePipeline>> {
        let key = PassKey {
            text: program.shader.text.clone(),
            entry_point: program.entry_point,
            constants: program.constants.iter().map(|(name, x)| (*name, x.to_bits())).collect(),
        };
        self.passes.get_or_compile(key, || {
            let compiled = self.compile(program)?;
            self.work.shader_builds.fetch_add(1, Ordering::Relaxed);
            Ok(compiled)
        })
    }

    /// The entry points of what is compiled, by name, each once.
    pub fn compiled(&self) -> Vec<&'static str> {
        let mut names: Vec<&str> = self.passes.locked().keys().map(|key| key.entry_point).collect();
        names.extend(self.drawings.locked().keys().map(|key| key.fragment));
        names.sort_unstable();
        names.dedup();
        names
    }

    /// Lets go of all that was compiled, so that building it can be measured.
    pub fn forget_pipelines(&self) {
        self.passes.locked().clear();
        self.drawings.locked().clear();
    }

    fn compile(&self, program: &Program) -> Result<wgpu::ComputePipeline> {
        let Program { shader, entry_point, constants, groups } = program;
        let text = wgpu::ShaderSource::Wgsl(shader.text.as_str().into());
        let descriptor = wgpu::ShaderModuleDescriptor { label: Some(entry_point), source: text };
        let made = self.guarded(entry_point, || self.device.create_shader_module(descriptor));
        // The tests of `voltet-shaders` validate the text without a device; what is left is a driver's complaint.
        let module = made.map_err(|error| shader.error(1, &error.to_string()))?;
        let layout = |group| self.layout(group, ShaderStages::COMPUTE);
        let layouts = groups.map(|group| (!group.is_empty()).then(|| layout(group)));
        self.guarded(entry_point, || {
            let layout = self.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some(entry_point),
                bind_group_layouts: &layouts.each_ref().map(Option::as_ref),
                immediate_size: 0,
            });
            self.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(entry_point),
                layout: Some(&layout),
                module: &module,
                entry_point: Some(entry_point),
                compilation_options: wgpu::PipelineCompilationOptions { constants, ..Default::default() },
                cache: None,
            })
        })
    }

    pub(crate) fn layout(&self, group: &[(u32, Bound)], visibility: ShaderStages) -> wgpu::BindGroupLayout {
        let buffer = |ty| wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None };
        let entry = |(binding, bound): &(u32, Bound)| wgpu::BindGroupLayoutEntry {
            binding: *binding,
            visibility,
            ty: match bound {
                Bound::Uniform => buffer(BufferBindingType::Uniform),
                Bound::Read => buffer(BufferBindingType::Storage { read_only: true }),
                Bound::Write => buffer(BufferBindingType::Storage { read_only: false }),
                Bound::Texels => wgpu::BindingType::Texture {
                    sample_type: wgpu::TextureSampleType::Float { filterable: false },
                    view_dimension: wgpu::TextureViewDimension::D2,
                    multisampled: false,
                },
            },
            count: None,
        };
        let entries: Vec<_> = group.iter().map(entry).collect();
        let descriptor = wgpu::BindGroupLayoutDescriptor { label: None, entries: &entries };
        self.device.create_bind_group_layout(&descriptor)
    }

    /// Buffers bound to group `number` of a pipeline.
    pub(crate) fn bind(
        &self,
        pipeline: &wgpu::ComputePipeline,
        number: u32,
        buffers: &[(u32, &wgpu::Buffer)],
    ) -> wgpu::BindGroup {
        let mut resources = Vec::with_capacity(buffers.len());
        for (binding, buffer) in buffers {
            resources.push((*binding, buffer.as_entire_binding()));
        }
        self.bind_group(&pipeline.get_bind_group_layout(number), resources)
    }

    pub(crate) fn bind_group(
        &self,
        layout: &wgpu::BindGroupLayout,
        resources: Vec<(u32, wgpu::BindingResource)>,
    ) -> wgpu::BindGroup {
        let entry = |(binding, resource)| wgpu::BindGroupEntry { binding, resource };
        let entries: Vec<_> = resources.into_iter().map(entry).collect();
        let descriptor = wgpu::BindGroupDescriptor { label: None, layout, entries: &entries };
        self.device.create_bind_group(&descriptor)
    }
}
