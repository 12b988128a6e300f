//! The device engine as one of the program's engines, and its choice of the faster compositor: a small grid is drawn by both, once,
//! and the times are cached.

use crate::device::adapter::Adapters;
use crate::device::{Device, WorkCounts, locked};
use crate::frame::draw::{SubmittedFrame, begin, draw};
use crate::frame::inputs::can_serve;
use crate::frame::output::{FaceOrderReport, FrameOutput, OrderCheckReport};
use crate::frame::renderer::Renderer;
use glam::DVec3;
use serde_json::json;
use std::collections::HashMap;
use std::sync::atomic::{self, AtomicU64};
use std::sync::{Arc, Mutex};
use std::time::Instant;
use voltet_core::camera::{Camera, Projection};
use voltet_core::diagnostics::{Diagnostics, SavedWork};
use voltet_core::error::ErrorKind;
use voltet_core::grid::generate::box_of_tetrahedra;
use voltet_core::progress::Progress;
use voltet_core::transfer::{ControlPoint, OpticalModel, Profile, TransferFunction, Widget};
use voltet_core::visibility::FaceOrder;
use voltet_core::volume::Volume;
use voltet_core::{Result, SharedSlice};
use voltet_optics::WidgetBlend;
use voltet_optics::engine::{
    Accumulation, Compositor, CompositorChoice, Engine, EngineInfo, KeyValueStore, Pending, PreparedVolume,
    RenderOptions, RenderOutput,
};
use voltet_optics::scene::Scene;
use voltet_optics::shading::{Integrator, Ordering, Shading, VisibilityOrder};

/// The device engine.
pub const ENGINE: EngineInfo = EngineInfo {
    name: "gpu",
    summary: "the graphics device, or an error",
    taken: Some("the GPU if a hardware adapter holds the scene"),
    unavailable_reason: None,
    on_device: true,
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
    compositors: TimingCache,
}

impl GpuEngine {
    /// On this device.
    pub fn new(device: Arc<Device>) -> GpuEngine {
        GpuEngine { device, compositors: TimingCache::default() }
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

    fn choose(
        &self,
        scene: &Scene,
        memory: &dyn KeyValueStore,
        progress: &dyn Progress,
    ) -> Result<Option<CompositorChoice>> {
        let tiles =
            |why: String| Some(CompositorChoice { compositing: Compositor::Tiles, why, measured_secs: None });
        let device = &self.device;
        let needs_order = scene.needs_order();
        if scene.ordering(false) == Ordering::PerPixel {
            return Ok(tiles("each pixel needs its exact order".into()));
        }
        if !device.blends_32_bits() {
            return Ok(tiles("the device blends no 32-bit floats".into()));
        }
        let cell_count = scene.volume.grid.tetrahedra.len() as u64;
        if let Err(error) = device.check_blending(Compositor::Raster, Accumulation::Float, cell_count) {
            return Ok(tiles(error.to_string()));
        }
        let mut known = locked(&self.compositors);
        let begun = Instant::now();
        let mut measured_secs = None;
        let (times, from_before) = match known.get(&needs_order) {
            Some(found) => *found,
            None => match remembered(device, needs_order, memory, progress) {
                Ok(found) => {
                    measured_secs = Some(begun.elapsed().as_secs_f64());
                    *known.entry(needs_order).or_insert(found)
                }
                Err(error) if error.kind == ErrorKind::Cancelled => return Err(error),
                Err(error) => return Ok(tiles(format!("the other one cannot be measured: {error}"))),
            },
        };
        let why = format!(
            "the faster one here: on a small grid{} tiles take {:.3} ms, raster {:.3} ms{}",
            if needs_order { " in the order of centroids" } else { " that needs no order" },
            1e3 * times.tiles,
            1e3 * times.raster,
            if from_before { " (remembered)" } else { "" }
        );
        let compositing = if times.raster < times.tiles { Compositor::Raster } else { Compositor::Tiles };
        Ok(Some(CompositorChoice { compositing, why, measured_secs }))
    }
}

/// A volume on the device.
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
    if let Some(along_faces) = &drawn.along_faces {
        note_order(&mut notes, along_faces);
    }
    if let (Some(why), Some(asked)) = (&drawn.tiles_instead, options.compositing) {
        let asked = asked.name();
        notes.warnings.push(format!("drawn by tiles, in place of compositor = \"{asked}\": {why}"));
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
    let compositing = Compositor::Tiles;
    let instead = drawn.tiles_instead.map(|why| CompositorChoice { compositing, why, measured_secs: None });
    RenderOutput { counts: drawn.counts, instead, notes, ..RenderOutput::new(drawn.picture, drawn.passes) }
}

/// Adds the facts about an exact order that was blended.
fn note_order(notes: &mut Diagnostics, FaceOrderReport { order, checked }: &FaceOrderReport) {
    let FaceOrder { cells, across_gaps, taken_out } = &**order;
    let mut said = format!("{} cells blended in exact order along their faces", cells.len());
    if *across_gaps > 0 {
        said += &format!(", and across the gaps of the grid ({across_gaps} pairs of cells)");
    }
    if *taken_out > 0 {
        said += &format!("; {taken_out} faces in circles are crossed by no pixel's ray");
    }
    let mut figures = json!({ "across_gaps": across_gaps, "taken_out": taken_out });
    if let Some(OrderCheckReport { pixels, largest, disordered, without_tiles }) = checked {
        match without_tiles {
            None => {
                said += &format!("; {pixels} pixels differ by at most {largest:.1e} from those of tiles");
                figures["pixels_checked"] = json!(pixels);
                figures["largest_difference"] = json!(largest);
            }
            Some(why) => notes.warnings.push(format!("the order was not held against tiles: {why}")),
        }
        if let Some(count) = disordered {
            said += &format!("; cells are out of order at {count} pixels");
        }
    }
    notes.find(said, json!({ "order_along_faces": figures }));
}

/// Seconds of a frame by each compositor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct CompositorTimes {
    /// Compute passes over tiles.
    pub tiles: f64,
    /// Blending hardware.
    pub raster: f64,
}

/// Cache of measured times, for scenes that need an order and those that do not; true where they come from an earlier process.
pub(crate) type TimingCache = Mutex<HashMap<bool, (CompositorTimes, bool)>>;

/// The times that the memory holds, or else new ones, which it then holds; and whether they were there.
fn remembered(
    device: &Arc<Device>,
    needs_order: bool,
    memory: &dyn KeyValueStore,
    progress: &dyn Progress,
) -> Result<(CompositorTimes, bool)> {
    let key = key(&device.name, &device.driver, needs_order);
    if let Some(times) = memory.recall(&key).and_then(|text| CompositorTimes::read(&text)) {
        return Ok((times, true));
    }
    let times = measure(device, needs_order, progress)?;
    memory.keep(&key, &times.written());
    Ok((times, false))
}

/// Everything that a measurement holds for. The number changes with what is measured, and with how it is written.
fn key(adapter: &str, driver: &str, needs_order: bool) -> String {
    let line = |text: &str| text.replace(['\n', '\r'], " ");
    let scene = if needs_order { "order of centroids" } else { "no order" };
    let version = env!("CARGO_PKG_VERSION");
    format!("voltet compositors 2\n{}\n{}\nprogram {version}\n{scene}\n", line(adapter), line(driver))
}

impl CompositorTimes {
    fn written(&self) -> String {
        serde_json::json!([self.tiles, self.raster]).to_string()
    }

    /// `None` for what is something else.
    fn read(text: &str) -> Option<CompositorTimes> {
        let [tiles, raster]: [f64; 2] = serde_json::from_str(text).ok()?;
        (tiles > 0.0 && raster > 0.0).then_some(CompositorTimes { tiles, raster })
    }
}

/// Cells along a side of the box, and pixels along a side of the picture: enough to fill a graphics device for the tenth of
/// a second that all frames take, and little for a program that stands in for one.
const HARDWARE: (usize, u32) = (32, 768);
const SOFTWARE: (usize, u32) = (5, 48);

/// Frames after the first, which compiles.
const FRAME_COUNT: usize = 5;

/// Draws a scene of one colour, which needs no order, or one of several in the order of centroids, by both compositors.
///
/// Errors: those of [`draw`]; what the raster compositor lacks on this device.
fn measure(device: &Arc<Device>, needs_order: bool, progress: &dyn Progress) -> Result<CompositorTimes> {
    let (side, pixels) = if device.is_software { SOFTWARE } else { HARDWARE };
    let box_grid = box_of_tetrahedra([side; 3], [DVec3::ZERO, DVec3::ONE], 0.2);
    let s = |p: &DVec3| 0.5 + 0.25 * (4.0 * p.x + p.y).sin() + 0.25 * (3.0 * p.z - 2.0 * p.y).cos();
    let scalar: Vec<f64> = box_grid.points.iter().map(s).collect();
    let volume = Arc::new(Volume {
        grid: Arc::new(box_grid),
        scalar: SharedSlice::from(scalar),
        gradient: None,
        gradient_magnitude: None,
    });
    let renderer = Renderer::new(device.clone(), &volume)?;
    let shading = Shading {
        integrator: Integrator::ANALYTIC,
        overlap: WidgetBlend::Exact,
        silhouette: None,
        light: None,
    };
    let camera = Camera {
        eye: DVec3::new(-0.9, -1.1, 1.4),
        target: DVec3::splat(0.5),
        up: DVec3::Z,
        projection: Projection::Perspective { fov_y: 45.0 },
        near: 0.0,
        size: [pixels; 2],
        samples: 1,
    };
    let transfer_function = Arc::new(look(needs_order));
    let scene = Scene { volume, transfer_function, camera, shading, order: VisibilityOrder::Centroid };
    let seconds = |compositing| -> Result<f64> {
        let mut times = Vec::new();
        for frame in 0..=FRAME_COUNT {
            let begun = Instant::now();
            let drawn = draw(&renderer, &scene, &RenderOptions::with_compositor(compositing), progress)?;
            let whole = begun.elapsed().as_secs_f64();
            // The device's own clock leaves out what the program waits for; both are the same for both compositors.
            let passes: f64 = drawn.passes.iter().map(|pass| pass.seconds).sum();
            if frame > 0 {
                times.push(if passes > 0.0 { passes } else { whole });
            }
        }
        times.sort_by(f64::total_cmp);
        Ok(times[times.len() / 2])
    };
    Ok(CompositorTimes { tiles: seconds(Compositor::Tiles)?, raster: seconds(Compositor::Raster)? })
}

/// A Gaussian, or a ramp of two colours.
fn look(needs_order: bool) -> TransferFunction {
    let point = |s, color, extinction| ControlPoint { s, color, extinction };
    let profile = if needs_order {
        let points = vec![
            point(0.0, [0.1, 0.2, 0.9], 0.0),
            point(0.4, [0.1, 0.8, 0.9], 1.0),
            point(1.0, [0.9, 0.3, 0.1], 4.0),
        ];
        Profile::PiecewiseLinear { points }
    } else {
        Profile::Gaussian { centre: [0.6, 0.0], matrix: [[5.0, 0.0], [0.0, 0.0]] }
    };
    let widget = Widget { profile, color: [1.0, 0.5, 0.2], extinction: 4.0, region: None };
    TransferFunction { model: OpticalModel::DensityEmitter, unit_distance: 1.0, widgets: vec![widget] }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_read_back_as_they_were_written_and_nothing_else_does() {
        let times = CompositorTimes { tiles: 1.25e-3, raster: 3.5e-4 };
        let text = times.written();
        assert_eq!(CompositorTimes::read(&text), Some(times));
        for place in 0..text.len() {
            assert_eq!(CompositorTimes::read(&text[..place]), None, "cut at {place}");
        }
        for wrong in ["[0.0,1.0]", "[null,1.0]", "tiles 1e0 s\nraster 1e0 s\n"] {
            assert_eq!(CompositorTimes::read(wrong), None, "{wrong}");
        }
    }

    #[test]
    fn a_measurement_holds_for_one_adapter_driver_and_kind_of_scene() {
        let known = key("Some GPU (discrete, vulkan)", "driver 1.2", false);
        for other in [
            key("Another GPU", "driver 1.2", false),
            key("Some GPU (discrete, vulkan)", "driver 1.3", false),
            key("Some GPU (discrete, vulkan)", "driver 1.2", true),
        ] {
            assert_ne!(known, other);
        }
        assert_eq!(key("a\nb", "c\r", false).lines().count(), 5, "a name has one line");
    }
}
