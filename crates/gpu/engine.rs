//! The device engine as one of the program's engines.

use crate::device::adapter::Adapters;
use crate::device::{Device, WorkCounts};
use crate::frame::draw::{SubmittedFrame, begin, draw};
use crate::frame::inputs::can_serve;
use crate::frame::output::FrameOutput;
use crate::frame::renderer::Renderer;
use std::sync::Arc;
use std::sync::atomic::{self, AtomicU64};
use voltet_core::Result;
use voltet_core::diagnostics::{Diagnostics, SavedWork};
use voltet_core::progress::Progress;
use voltet_core::volume::Volume;
use voltet_optics::engine::{
    Compositor, Engine, EngineInfo, Pending, PreparedVolume, RenderOptions, RenderOutput,
};
use voltet_optics::scene::Scene;

/// The device engine.
pub const ENGINE: EngineInfo = EngineInfo {
    name: "gpu",
    summary: "the graphics device, or an error",
    taken: Some("the GPU if a hardware adapter holds the scene"),
    unavailable_reason: None,
    on_device: true,
    draws_parts: false,
    compositing: Compositor::ALL,
    can_serve,
    adapters: || Adapters::find().described(),
    open: |request| {
        let device = Device::open(request.name.as_deref(), request.hardware)?;
        Ok(Arc::new(GpuEngine::new(Arc::new(device))))
    },
};

/// The device engine on an open device.
pub struct GpuEngine {
    pub(crate) device: Arc<Device>,
}

impl GpuEngine {
    /// On this device.
    pub fn new(device: Arc<Device>) -> GpuEngine {
        GpuEngine { device }
    }
}

impl Engine for GpuEngine {
    fn adapter(&self) -> String {
        self.device.name.clone()
    }

    fn reason(&self) -> Option<&str> {
        Some(&self.device.reason)
    }

    fn is_software(&self) -> bool {
        self.device.is_software
    }

    fn is_lost(&self) -> bool {
        self.device.is_lost()
    }

    fn prepare(&self, volume: &Arc<Volume>) -> Result<Arc<dyn PreparedVolume>> {
        let before = self.device.work().uploads;
        let renderer = Renderer::new(self.device.clone(), volume)?;
        let uploads = AtomicU64::new(self.device.work().uploads - before);
        Ok(Arc::new(GpuVolume { renderer: Arc::new(renderer), uploads }))
    }
}

pub(crate) struct GpuVolume {
    pub renderer: Arc<Renderer>,
    /// Arrays that were uploaded and are not counted with any picture yet.
    uploads: AtomicU64,
}

impl PreparedVolume for GpuVolume {
    fn draw(&self, scene: &Scene, options: &RenderOptions, progress: &dyn Progress) -> Result<RenderOutput> {
        let device = self.renderer.device();
        let before = device.work();
        let drawn = draw(&self.renderer, scene, options, progress)?;
        Ok(of_engine(device, drawn, options, self.since(before)))
    }

    fn begin(
        &self,
        scene: &Scene,
        options: &RenderOptions,
        progress: &dyn Progress,
    ) -> Result<Box<dyn Pending>> {
        let before = self.renderer.device().work();
        let begun = begin(&self.renderer, scene, options, progress)?;
        let (device, work) = (self.renderer.device().clone(), self.since(before));
        Ok(Box::new(PendingPicture { device, begun, options: *options, work }))
    }
}

impl GpuVolume {
    /// Work done since, with the arrays that no picture has counted.
    fn since(&self, before: WorkCounts) -> WorkCounts {
        let after = self.renderer.device().work();
        WorkCounts {
            shader_builds: after.shader_builds - before.shader_builds,
            uploads: self.uploads.swap(0, atomic::Ordering::Relaxed) + after.uploads - before.uploads,
            bytes_uploaded: after.bytes_uploaded - before.bytes_uploaded,
        }
    }
}

/// A submitted frame, with the work that was done for it.
struct PendingPicture {
    device: Arc<Device>,
    begun: SubmittedFrame,
    options: RenderOptions,
    work: WorkCounts,
}

impl Pending for PendingPicture {
    fn collect(self: Box<Self>, progress: &dyn Progress) -> Result<RenderOutput> {
        let drawn = self.begun.collect(progress)?;
        Ok(of_engine(&self.device, drawn, &self.options, self.work))
    }
}

/// The output of a frame as every engine gives it, with diagnostics of this engine alone: its counts, the shader parts that it
/// skips, warnings about the device.
fn of_engine(device: &Device, drawn: FrameOutput, options: &RenderOptions, work: WorkCounts) -> RenderOutput {
    let mut notes = Diagnostics::new(options.exhaustive);
    notes.counts.insert("shader_builds", work.shader_builds);
    notes.counts.insert("uploads", work.uploads);
    notes.counts.insert("bytes_uploaded", work.bytes_uploaded);
    notes.counts.insert("tile_entries", drawn.tile_entries);
    notes.counts.insert("sweeps_further", drawn.sweeps_further);
    if let Some(asked) = options.compositing.filter(|asked| *asked != drawn.compositing) {
        let (drawn, asked) = (drawn.compositing.name(), asked.name());
        notes.warnings.push(format!(
            "drawn by {drawn}, in place of compositor = \"{asked}\": each pixel needs its exact order; order = \"centroid\" \
             can be blended"
        ));
    }
    if drawn.blended_in_16_bits {
        let off = "what it draws may be off by some thousandths; compositor = \"tiles\" has 32 bits";
        notes.warnings.push(format!("{} blends no 32-bit floats: {off}", device.name));
    }
    if !drawn.parts_left_out.is_empty() {
        let what = format!("shader parts {}", drawn.parts_left_out.join(", "));
        let saving = SavedWork::Bytes(drawn.part_bytes_left_out);
        notes.record_skipped(what, "the scene asks for nothing of the kind", Some(saving));
    }
    RenderOutput { counts: drawn.counts, notes, ..RenderOutput::new(drawn.picture, drawn.passes) }
}
