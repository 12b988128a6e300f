//! Pipelines, compiled once for each text, entry point and set of constants, and their bindings.

use crate::device::{Device, PipelineCache, PipelineKey, locked};
use std::sync::Arc;
use voltet_core::Result;
use voltet_optics::engine::Compositor;
use voltet_shaders::{FramePass, Shader};
use wgpu::{BufferBindingType, ShaderStages};

/// Kind of a binding, in the order of the bindings of a group.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Bound {
    Uniform,
    Read,
    Write,
    /// A texture that is read texel by texel.
    Texels,
}

/// Things bound at 0, 1, …
pub(crate) fn in_order<T: Copy>(things: &[T]) -> Vec<(u32, T)> {
    things.iter().enumerate().map(|(binding, thing)| (binding as u32, *thing)).collect()
}

/// Bindings of a pass, or without one of the tiles' compositor, in group 1 behind the view.
fn bound(pass: Option<FramePass>) -> &'static [Bound] {
    use Bound::{Read, Uniform, Write};
    match pass {
        Some(FramePass::Points) => &[],
        Some(FramePass::Attribute) => &[Uniform],
        Some(FramePass::Cells) => &[Read, Write],
        Some(FramePass::Starts) => &[Write],
        Some(FramePass::Lists) => &[Write, Write],
        Some(FramePass::Sort) => &[Read, Write],
        Some(FramePass::CountDigits | FramePass::PlaceDigits) => &[Uniform, Read, Write],
        Some(FramePass::MoveDigits) => &[Uniform, Read, Write, Write],
        Some(FramePass::Runs) => &[Write, Read],
        Some(FramePass::Split) => &[Uniform, Read, Read, Write],
        None => &[Write, Read, Write],
    }
}

/// Storage buffers of a compositor of pixels, beside those of the grid and of the scene.
pub(crate) fn compositor_buffers(compositing: Compositor) -> u32 {
    match compositing {
        Compositor::Tiles => storage_buffers(None),
        // The list of cells, or their corners; then the picture alone.
        Compositor::Raster | Compositor::Triangles => 1,
    }
}

/// Storage buffers of a pass beside those of the grid; without one, of the tiles' compositor.
pub(crate) fn storage_buffers(pass: Option<FramePass>) -> u32 {
    bound(pass).iter().filter(|bound| **bound != Bound::Uniform).count() as u32
}

/// Bindings of group 1 of a pass, or of the tiles' compositor.
pub(crate) fn own_kinds(pass: Option<FramePass>) -> Vec<(u32, Bound)> {
    in_order(&[&[Bound::Uniform], bound(pass)].concat())
}

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
        let key = (program.shader.text.clone(), program.entry_point, format!("{:?}", program.constants));
        self.cached(&self.passes, key, || self.compile(program))
    }

    /// The pipeline of that key, compiled if it is not there; compiling blocks no other thread.
    pub(crate) fn cached<P>(
        &self,
        cache: &PipelineCache<P>,
        key: PipelineKey,
        compile: impl FnOnce() -> Result<P>,
    ) -> Result<Arc<P>> {
        let known = locked(cache).get(&key).cloned();
        if let Some(pipeline) = known {
            return Ok(pipeline);
        }
        let compiled = Arc::new(compile()?);
        self.count(|work| work.shader_builds += 1);
        Ok(locked(cache).entry(key).or_insert(compiled).clone())
    }

    /// The entry points of what is compiled, by name, each once.
    pub fn compiled(&self) -> Vec<&'static str> {
        let mut names: Vec<&str> = locked(&self.passes).keys().map(|key| key.1).collect();
        names.extend(locked(&self.drawings).keys().map(|key| key.1));
        names.sort_unstable();
        names.dedup();
        names
    }

    /// Lets go of all that was compiled, so that building it can be measured.
    pub fn forget_pipelines(&self) {
        locked(&self.passes).clear();
        locked(&self.drawings).clear();
    }

    fn compile(&self, program: &Program) -> Result<wgpu::ComputePipeline> {
        let Program { shader, entry_point, constants, groups } = program;
        let module = self.module(shader, entry_point)?;
        let layouts =
            groups.map(|group| (!group.is_empty()).then(|| self.group_layout(group, ShaderStages::COMPUTE)));
        self.guarded(entry_point, || {
            self.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(entry_point),
                layout: Some(&self.pipeline_layout(entry_point, &layouts)),
                module: &module,
                entry_point: Some(entry_point),
                compilation_options: wgpu::PipelineCompilationOptions { constants, ..Default::default() },
                cache: None,
            })
        })
    }

    /// The compiled text. The tests of `voltet-shaders` validate it without a device; what is left is a driver's complaint.
    pub(crate) fn module(&self, shader: &Shader, label: &str) -> Result<wgpu::ShaderModule> {
        let source = wgpu::ShaderSource::Wgsl(shader.text.as_str().into());
        let descriptor = wgpu::ShaderModuleDescriptor { label: Some(label), source };
        let made = self.guarded(label, || self.device.create_shader_module(descriptor));
        made.map_err(|error| shader.error(1, &error.to_string()))
    }

    pub(crate) fn pipeline_layout(
        &self,
        label: &str,
        groups: &[Option<wgpu::BindGroupLayout>; 3],
    ) -> wgpu::PipelineLayout {
        self.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(label),
            bind_group_layouts: &groups.each_ref().map(Option::as_ref),
            immediate_size: 0,
        })
    }

    pub(crate) fn group_layout(
        &self,
        group: &[(u32, Bound)],
        visibility: ShaderStages,
    ) -> wgpu::BindGroupLayout {
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
