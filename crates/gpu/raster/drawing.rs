//! Pipelines that draw and blend, and what they draw into. Compiled once for each text and target, and kept by the
//! device.

use crate::device::bindings::Bound;
use crate::device::device_handle::Device;
use crate::device::pipeline_cache::DrawingKey;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use voltet_core::{Error, Result};
use voltet_optics::engine::{Accumulation, Compositor};
use voltet_shaders::{Blend, Shader};
use wgpu::{BlendComponent, BlendFactor, DownlevelFlags, ShaderStages, TextureFormat};

/// Blending of the compositor: formats, factors, and the initial content.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Target {
    /// Format of each picture that is drawn into.
    pub formats: Vec<TextureFormat>,
    /// Content of an unseen pixel.
    pub clear: wgpu::Color,
    factors: [BlendFactor; 2],
}

impl Target {
    /// One number a pixel where the scene has one colour, else four; of 32 bits where the device blends these.
    ///
    /// Colours come farthest first, each over what is there: C ← C_seg + (1 − A_seg) C. The other way round, each would
    /// be weighted by 1 − A of the sum, which has few digits left where little more is seen.
    ///
    /// Without 32 bits what is rounded is not served: [`Device::check_blending`].
    pub fn new(blend: Blend, depths_add_up: bool, wide: bool, in_8_bits: bool) -> Target {
        let formats = match (blend, wide) {
            (Blend::Over, _) if in_8_bits => vec![TextureFormat::Rgba8Unorm],
            (Blend::Over, true) => vec![TextureFormat::Rgba32Float],
            (Blend::Over, false) => vec![TextureFormat::Rgba16Float],
            (Blend::Sum, true) => vec![TextureFormat::R32Float],
            (Blend::Sum, false) => vec![TextureFormat::R16Float],
            (Blend::Rounded { .. }, _) => vec![TextureFormat::Rgba32Float, TextureFormat::R32Float],
        };
        let behind = match blend {
            Blend::Over | Blend::Rounded { .. } => BlendFactor::OneMinusSrcAlpha,
            Blend::Sum if depths_add_up => BlendFactor::One,
            Blend::Sum => BlendFactor::OneMinusSrc,
        };
        let about = f64::from(blend.about());
        let clear = wgpu::Color { r: about, g: about, b: about, a: 0.0 };
        Target { formats, clear, factors: [BlendFactor::One, behind] }
    }

    fn blend(&self) -> wgpu::BlendState {
        let [src_factor, dst_factor] = self.factors;
        let component = BlendComponent { src_factor, dst_factor, operation: wgpu::BlendOperation::Add };
        wgpu::BlendState { color: component, alpha: component }
    }
}

/// Sources of a render pipeline.
pub(crate) struct Drawing<'a> {
    pub shader: &'a Shader,
    /// Entry points for vertices and for pixels.
    pub entry_points: [&'static str; 2],
    pub target: Target,
    /// Bound buffers, by binding.
    pub groups: [&'a [(u32, Bound)]; 3],
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

/// Bytes of a cell in the sorted list.
pub(crate) const ENTRY_BYTES: u64 = 8;

impl Device {
    /// An error that names what the device lacks for a compositor that blends, or how many cells its list holds.
    pub fn check_blending(
        &self,
        compositing: Compositor,
        accumulation: Accumulation,
        cell_count: u64,
    ) -> Result<()> {
        let most = self.most_bytes() / ENTRY_BYTES;
        if most < cell_count {
            return Err(Error::run(format!("the sorted cells do not fit one binding of {}", self.name))
                .got(format!("{cell_count} cells"))
                .expected(format!("at most {most}, or compositor = \"tiles\"")));
        }
        let is_rounded = matches!(accumulation, Accumulation::Bits12 | Accumulation::Bits16);
        if is_rounded && !self.blends_32_bits {
            let words = format!("accumulation = \"{}\"", accumulation.name());
            return Err(Error::run(format!("{} blends no 32-bit floats", self.name))
                .got(format!("{words}, which is made of these"))
                .expected("accumulation = \"float\" or \"8-bit\""));
        }
        check_flags(self.downlevel, &self.name, compositing.name())
    }

    /// True if pixels are blended in 32-bit floats, not in 16 bits.
    pub fn blends_32_bits(&self) -> bool {
        self.blends_32_bits
    }

    /// The pipeline, compiled if it is not there.
    pub(crate) fn drawing(&self, program: &Drawing) -> Result<Arc<wgpu::RenderPipeline>> {
        let Target { formats, factors, .. } = &program.target;
        let text = program.shader.text.clone();
        let fragment = program.entry_points[1];
        let key = DrawingKey { text, fragment, formats: formats.clone(), factors: *factors };
        self.drawings.get_or_compile(key, || {
            let compiled = self.compile_drawing(program)?;
            self.work.shader_builds.fetch_add(1, Ordering::Relaxed);
            Ok(compiled)
        })
    }

    fn compile_drawing(&self, program: &Drawing) -> Result<wgpu::RenderPipeline> {
        let Drawing { shader, entry_points: [vertex, fragment], target, groups } = program;
        let text = wgpu::ShaderSource::Wgsl(shader.text.as_str().into());
        let descriptor = wgpu::ShaderModuleDescriptor { label: Some(fragment), source: text };
        let made = self.guarded(fragment, || self.device.create_shader_module(descriptor));
        let module = made.map_err(|error| shader.error(1, &error.to_string()))?;
        let layouts = groups.map(|group| Some(self.layout(group, ShaderStages::VERTEX_FRAGMENT)));
        self.guarded(fragment, || {
            let layout = self.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some(fragment),
                bind_group_layouts: &layouts.each_ref().map(Option::as_ref),
                immediate_size: 0,
            });
            let color = |format: &TextureFormat| {
                Some(wgpu::ColorTargetState {
                    format: *format,
                    blend: Some(target.blend()),
                    write_mask: wgpu::ColorWrites::ALL,
                })
            };
            let targets: Vec<_> = target.formats.iter().map(color).collect();
            self.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some(fragment),
                layout: Some(&layout),
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
                    targets: &targets,
                }),
                multiview_mask: None,
                cache: None,
            })
        })
    }
}

/// A texture to draw into, kept while it is large enough.
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
