//! The renderer: scenes to pictures, on the CPU or a graphics device; pixels of pictures, and files of them.

use super::scene::Scene;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};
use voltet_core::error::ErrorKind;
use voltet_core::picture::Picture;
use voltet_core::progress::Progress;
use voltet_core::volume::Volume as BuiltVolume;
use voltet_core::{Error, Result};
use voltet_cpu as cpu;
use voltet_io::{encode, memory};
use voltet_nodes::drawing::{
    AUTO, DEVICE, NATIVE, OpenEngines, PreparedVolumes, candidate_engines, picture_warnings,
};
use voltet_nodes::files::write_whole;
use voltet_optics::engine::{self, AdapterRequest, Compositor, EngineInfo, RenderStats, StageTiming};
use voltet_optics::scene::Scene as CompiledScene;

/// Engines that a renderer may use.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Engine {
    /// The graphics device where there is one that holds the scene, else the CPU.
    #[default]
    Auto,
    /// The CPU, on all cores and the widest vector units.
    Cpu,
    /// The graphics device.
    Gpu,
}

impl Engine {
    fn name(self) -> &'static str {
        match self {
            Engine::Auto => AUTO,
            Engine::Cpu => NATIVE.name,
            Engine::Gpu => DEVICE.name,
        }
    }
}

/// Options of a renderer, for all of its pictures.
#[derive(Debug, Clone, Default)]
#[non_exhaustive]
pub struct RendererOptions {
    /// The engine.
    pub engine: Engine,
    /// Adapter of the graphics device: a part of its name, or discrete, integrated, virtual, software. Default: the fastest.
    pub adapter: Option<String>,
    /// Number of threads. Default: those of the global pool of rayon.
    pub threads: Option<usize>,
    /// Memory beyond which work is refused before it begins (bytes). Default: what the system has left.
    pub memory_limit: Option<u64>,
}

/// Options of one picture.
#[derive(Clone, Copy, Default)]
#[non_exhaustive]
pub struct RenderOptions<'a> {
    /// Receiver of progress, which may cancel the render.
    pub progress: Option<&'a dyn Progress>,
    /// True if no work is skipped that the picture does not need, for comparison; the picture is the same but for rounding.
    pub exhaustive: bool,
    /// True if pictures of the same view with other widgets follow: the engine may reuse ray segments, and the picture may differ
    /// by rounding.
    pub interactive: bool,
    /// Depth of each pixel's opaque background along the view direction, row by row from the top (world units); infinite where
    /// there is none. Such pictures are rendered on the CPU.
    pub depth_limit: Option<&'a [f32]>,
    /// Compositor of a graphics device. Default: tiles, which also draw, with a warning, where it does not make the scene's order.
    pub compositor: Option<Compositor>,
}

/// A picture: premultiplied linear RGBA in 32-bit floats over transparent black, row 0 at the top.
#[derive(Debug, Clone, PartialEq)]
pub struct Image(Arc<Picture>);

impl Image {
    /// Width (pixels).
    pub fn width(&self) -> usize {
        self.0.width
    }

    /// Height (pixels).
    pub fn height(&self) -> usize {
        self.0.height
    }

    /// Pixels in row-major order: premultiplied linear red, green and blue, and opacity.
    pub fn pixels(&self) -> &[[f32; 4]] {
        &self.0.rgba
    }

    /// 8-bit sRGB of every pixel over a background in linear RGB.
    pub fn srgb8(&self, background: [f64; 3]) -> Vec<[u8; 3]> {
        self.0.rgba.iter().map(|&pixel| encode::srgb8(pixel, background)).collect()
    }

    /// Writes a file whose format its ending states, such as .png, .tif, .webp and .jpg (8-bit sRGB over black) or .exr (linear 32-bit RGBA). An existing
    /// file is replaced in one step.
    ///
    /// # Errors
    /// - an ending of no known format;
    /// - a path that cannot be written.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<()> {
        self.save_over(path, [0.0; 3])
    }

    /// Like [`Image::save`], with a background in linear RGB for formats without opacity.
    ///
    /// # Errors
    /// As of [`Image::save`].
    pub fn save_over(&self, path: impl AsRef<Path>, background: [f64; 3]) -> Result<()> {
        let path = path.as_ref();
        let format = encode::format_by_ending(path)?;
        let (file, _) = format.file(&*self.0, encode::SampleForm::over(background), None)?;
        write_whole(path, &file)
    }
}

impl From<Arc<Picture>> for Image {
    fn from(picture: Arc<Picture>) -> Self {
        Image(picture)
    }
}

impl From<Image> for Arc<Picture> {
    fn from(image: Image) -> Self {
        image.0
    }
}

/// A picture with the record of its render.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct RenderOutput {
    /// The picture.
    pub image: Image,
    /// Counters of cells, segments and pixels.
    pub stats: RenderStats,
    /// Time of each stage.
    pub timings: Vec<StageTiming>,
    /// Name of the engine that rendered.
    pub engine: &'static str,
    /// Device, or vector units and threads.
    pub adapter: String,
    /// True if segments of a former picture were reused ([`RenderOptions::interactive`]).
    pub is_preview: bool,
    /// Warnings about the picture, such as that it is empty.
    pub warnings: Vec<String>,
}

/// Renders scenes. Engines stay open, and the last volume stays on its engine, so that further pictures of it take less time.
pub struct Renderer {
    options: RendererOptions,
    engines: OpenEngines,
    /// The volume of the last picture, on the engines that hold it.
    last: Mutex<Option<(Arc<BuiltVolume>, Arc<PreparedVolumes>)>>,
    pool: Option<ThreadPool>,
}

impl Renderer {
    /// A renderer on the engine that is there ([`Engine::Auto`]).
    ///
    /// # Errors
    /// As of [`Renderer::with`].
    pub fn new() -> Result<Self> {
        Self::with(RendererOptions::default())
    }

    /// A renderer on this engine.
    ///
    /// # Errors
    /// As of [`Renderer::with`].
    pub fn on(engine: Engine) -> Result<Self> {
        Self::with(RendererOptions { engine, ..RendererOptions::default() })
    }

    /// A renderer with these options. A graphics device that is named is opened.
    ///
    /// # Errors
    /// - a graphics device that is not there, or that the build has no engine for;
    /// - threads that cannot be started.
    pub fn with(options: RendererOptions) -> Result<Self> {
        let threads = |count| {
            let pool = ThreadPoolBuilder::new().num_threads(count).build();
            pool.map_err(|error| Error::run("no threads can be had to work with").got(error))
        };
        let pool = options.threads.map(threads).transpose()?;
        let renderer = Renderer { options, engines: OpenEngines::default(), last: Mutex::default(), pool };
        if renderer.options.engine == Engine::Gpu {
            renderer.open(DEVICE)?;
        }
        Ok(renderer)
    }

    /// Renders a picture.
    ///
    /// # Errors
    /// As of [`Renderer::render_with`].
    pub fn render(&self, scene: &Scene) -> Result<Image> {
        Ok(self.render_with(scene, &RenderOptions::default())?.image)
    }

    /// Renders a picture with options, and returns it with its record.
    ///
    /// # Errors
    /// - a scene with a number out of range, or that the integrator or engine does not support;
    /// - memory that does not suffice;
    /// - cancellation.
    pub fn render_with(&self, scene: &Scene, options: &RenderOptions) -> Result<RenderOutput> {
        match &self.pool {
            Some(pool) => pool.install(|| self.render_here(scene, options)),
            None => self.render_here(scene, options),
        }
    }

    /// Renders on this thread and its pool.
    fn render_here(&self, scene: &Scene, options: &RenderOptions) -> Result<RenderOutput> {
        let progress = Limited { progress: options.progress, limit: self.options.memory_limit };
        let scene = scene.compiled(&progress)?;
        let engine = self.options.engine;
        if let Some(depth_limit) = options.depth_limit {
            if engine == Engine::Gpu {
                let error = Error::usage("a depth limit is given to the graphics device");
                return Err(error.expected("Engine::Cpu or Engine::Auto"));
            }
            let picture = render_to_depth(&scene, depth_limit, &progress)?;
            let adapter = self.engines.open(NATIVE, &AdapterRequest::default())?.adapter();
            return Ok(RenderOutput::new(
                &scene,
                NATIVE.name,
                adapter,
                engine::RenderOutput::new(picture, Vec::new()),
            ));
        }
        for candidate in candidate_engines(engine.name(), &scene.shading) {
            match self.render_on(candidate, &scene, options, &progress) {
                Err(error)
                    if engine == Engine::Auto
                        && candidate.on_device
                        && error.kind != ErrorKind::Cancelled => {}
                done => return done,
            }
        }
        Err(Error::run("no engine renders the scene").got(engine.name()))
    }

    fn open(&self, info: &'static EngineInfo) -> Result<Arc<dyn engine::Engine>> {
        let hardware = self.options.engine == Engine::Auto;
        let request = AdapterRequest { name: self.options.adapter.clone(), hardware };
        self.engines.open(info, &request)
    }

    fn render_on(
        &self,
        info: &'static EngineInfo,
        scene: &CompiledScene,
        options: &RenderOptions,
        progress: &dyn Progress,
    ) -> Result<RenderOutput> {
        info.can_serve(&scene.transfer_function, &scene.shading)?;
        let opened = self.open(info)?;
        let compositing = options.compositor.filter(|_| !info.compositing.is_empty());
        let volume = self.volumes(&scene.volume).prepare(info, &opened, scene)?;
        let options = engine::RenderOptions {
            compositing,
            exhaustive: options.exhaustive,
            preview: options.interactive,
        };
        let output = volume.draw(scene, &options, progress)?;
        Ok(RenderOutput::new(scene, info.name, opened.adapter(), output))
    }

    /// Cache of a volume on engines; that of the former one is dropped.
    fn volumes(&self, volume: &Arc<BuiltVolume>) -> Arc<PreparedVolumes> {
        let mut last = self.last.lock().unwrap_or_else(PoisonError::into_inner);
        match &*last {
            Some((known, prepared)) if Arc::ptr_eq(known, volume) => prepared.clone(),
            _ => {
                let prepared = Arc::new(PreparedVolumes::default());
                *last = Some((volume.clone(), prepared.clone()));
                prepared
            }
        }
    }
}

impl RenderOutput {
    fn new(
        scene: &CompiledScene,
        engine: &'static str,
        adapter: String,
        output: engine::RenderOutput,
    ) -> Self {
        let mut warnings = output.notes.warnings;
        warnings.extend(picture_warnings(scene, &output.counts, &output.picture));
        RenderOutput {
            warnings,
            image: Arc::new(output.picture).into(),
            stats: output.counts,
            timings: output.stages,
            engine,
            adapter,
            is_preview: output.is_preview,
        }
    }
}

/// Renders on the CPU a scene whose rays end at the depths of opaque surfaces (see [`RenderOptions::depth_limit`]).
///
/// # Errors
/// - another number of depths than pixels, or a depth that is no number;
/// - a scene that the CPU engine does not support;
/// - cancellation.
pub fn render_to_depth(
    scene: &CompiledScene,
    depth_limit: &[f32],
    progress: &dyn Progress,
) -> Result<Picture> {
    let CompiledScene { volume, transfer_function, camera, shading, .. } = scene;
    let cells =
        cpu::sort(&cpu::cull(volume, transfer_function, camera, progress)?, camera, scene.ordering(false))?;
    let projection = cpu::project(&cells, transfer_function, camera, cpu::needs_gradient(shading), progress)?;
    let ready = cpu::prepare_scene(&projection, scene)?;
    Ok(ready.composite_scene(scene, Some(depth_limit), progress)?.0)
}

/// Progress of the caller, with a limit of memory.
struct Limited<'a> {
    progress: Option<&'a dyn Progress>,
    limit: Option<u64>,
}

impl Progress for Limited<'_> {
    fn report(&self, stage: &str, fraction: f64) {
        if let Some(progress) = self.progress {
            progress.report(stage, fraction);
        }
    }

    fn cancelled(&self) -> bool {
        self.progress.is_some_and(Progress::cancelled)
    }

    fn memory_left(&self) -> Option<u64> {
        let left = self.progress.and_then(Progress::memory_left).or_else(memory::available);
        left.into_iter().chain(self.limit).min()
    }
}
