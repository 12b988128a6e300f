//! Pipelines, compiled once for each text, entry point and set of constants, and their bindings.

use crate::device::{Device, PassName, PipelineCache, PipelineKey, Timing, locked};
use std::sync::Arc;
use voltet_core::Result;
use voltet_optics::engine::Compositor;
use voltet_shaders::{FramePass, Shader};
use wgpu::{BindingResource, Buffer, BufferBindingType, CommandEncoder, ShaderStages};

/// Kind of a binding, in the order of the bindings of a group.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Bound {
    Uniform,
    Read,
    Write,
    /// A texture that is read texel by texel.
    Texels,
}

/// A resource in a group, with its binding and kind.
pub(crate) type Binding<'a> = (u32, Bound, BindingResource<'a>);

/// Buffers bound at 0, 1, …
pub(crate) fn in_order<'a>(buffers: impl IntoIterator<Item = (Bound, &'a Buffer)>) -> Vec<Binding<'a>> {
    (0..).zip(buffers).map(|(binding, (kind, buffer))| (binding, kind, buffer.as_entire_binding())).collect()
}

/// Bindings of a pass, or without one of the tiles' compositor, in group 1 behind the view.
pub(crate) fn bound(pass: Option<FramePass>) -> &'static [Bound] {
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

pub(crate) struct Program<'a> {
    /// Entry point and stage.
    pub name: PassName,
    pub shader: &'a Shader,
    pub constants: Vec<(&'static str, f64)>,
    /// Groups 0, 1 and 2.
    pub groups: [&'a [Binding<'a>]; 3],
    pub workgroups: [u32; 3],
}

/// A compiled pass and what is bound to it.
pub(crate) struct BoundPass {
    name: PassName,
    pipeline: Arc<wgpu::ComputePipeline>,
    groups: BoundGroups,
    pub workgroups: [u32; 3],
}

/// The groups of a pass that bind anything, by number.
pub(crate) type BoundGroups = Vec<(u32, wgpu::BindGroup)>;

impl BoundPass {
    pub fn run(&self, encoder: &mut CommandEncoder, timing: &mut Timing) {
        let (label, timestamp_writes) = (Some(self.name.0), timing.next(self.name));
        let mut compute =
            encoder.begin_compute_pass(&wgpu::ComputePassDescriptor { label, timestamp_writes });
        compute.set_pipeline(&self.pipeline);
        self.groups.iter().for_each(|(number, group)| compute.set_bind_group(*number, group, &[]));
        let [x, y, z] = self.workgroups;
        compute.dispatch_workgroups(x, y, z);
    }
}

impl Device {
    /// The pass, compiled if it is not there. A compiler's complaint comes at the piece's own file and line.
    pub(crate) fn pass(&self, program: &Program) -> Result<BoundPass> {
        let Program { name, shader, constants, groups, workgroups } = program;
        let key = (shader.text.clone(), name.0, format!("{constants:?}"));
        let pipeline = self.cached(&self.passes, key, || self.compile(program))?;
        let groups = self.bind(groups, |number| pipeline.get_bind_group_layout(number));
        Ok(BoundPass { name: *name, pipeline, groups, workgroups: *workgroups })
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
        let &Program { name: (entry_point, _), shader, ref constants, ref groups, .. } = program;
        let module = self.module(shader, entry_point)?;
        self.guarded(entry_point, || {
            self.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(entry_point),
                layout: Some(&self.pipeline_layout(entry_point, groups, ShaderStages::COMPUTE)),
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
        groups: &[&[Binding]; 3],
        visibility: ShaderStages,
    ) -> wgpu::PipelineLayout {
        let buffer = |ty| wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None };
        let entry = |(binding, bound, _): &Binding| wgpu::BindGroupLayoutEntry {
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
        let layouts = groups.map(|group| {
            let entries: Vec<_> = group.iter().map(entry).collect();
            let descriptor = wgpu::BindGroupLayoutDescriptor { label: None, entries: &entries };
            (!group.is_empty()).then(|| self.device.create_bind_group_layout(&descriptor))
        });
        self.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(label),
            bind_group_layouts: &layouts.each_ref().map(Option::as_ref),
            immediate_size: 0,
        })
    }

    /// Binds the groups of a pipeline that are not empty.
    pub(crate) fn bind(
        &self,
        groups: &[&[Binding]; 3],
        layout: impl Fn(u32) -> wgpu::BindGroupLayout,
    ) -> BoundGroups {
        let bind = |(number, group): (u32, &&[Binding])| {
            let entries = group.iter().map(|(binding, _, resource)| wgpu::BindGroupEntry {
                binding: *binding,
                resource: resource.clone(),
            });
            let entries: Vec<_> = entries.collect();
            let descriptor =
                wgpu::BindGroupDescriptor { label: None, layout: &layout(number), entries: &entries };
            (number, self.device.create_bind_group(&descriptor))
        };
        (0..).zip(groups).filter(|(_, group)| !group.is_empty()).map(bind).collect()
    }
}
