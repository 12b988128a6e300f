//! The device engine as one of the program's engines.

use crate::device::adapter::Adapters;
use crate::device::open::Device;
use crate::frame::draw::{self, draw};
use crate::frame::limits;
use crate::frame::renderer::Renderer;
use crate::measure::segments::Segments;
use crate::measure::{compositors, operations};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use voltet_core::Result;
use voltet_core::engine::{
    AdapterWish, Chosen, Compositing, Counts, Declaration, Drawn, Engine, Forms, Manner, Memory, Prepared,
};
use voltet_core::graph::{Notes, Saving};
use voltet_core::progress::Progress;
use voltet_core::scene::Scene;
use voltet_core::volume::Volume;
use voltet_shaders::compose;

/// The device engine.
pub const ENGINE: Declaration = Declaration {
    name: "gpu",
    summary: "the graphics device, or an error",
    taken: Some("the GPU if a hardware adapter holds the scene"),
    absent: None,
    on_device: true,
    compositing: &Compositing::ALL,
    can_serve: limits::can_serve,
    adapters: || Adapters::find().described(),
    open: |wish| open(wish).map(|opened| Arc::new(opened) as Arc<dyn Engine>),
    open_each: |wish| open(wish).map(|opened| vec![Arc::new(opened) as Arc<dyn Engine>]),
};

fn open(wish: &AdapterWish) -> Result<OnDevice> {
    Ok(OnDevice::new(Arc::new(Device::open(wish.name.as_deref(), wish.hardware)?)))
}

/// The device engine on an open device.
pub struct OnDevice {
    device: Arc<Device>,
    compositors: compositors::Known,
}

impl OnDevice {
    /// On this device.
    pub fn new(device: Arc<Device>) -> OnDevice {
        OnDevice { device, compositors: compositors::Known::default() }
    }
}

impl Engine for OnDevice {
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

    fn prepare(&self, volume: &Arc<Volume>) -> Result<Arc<dyn Prepared>> {
        let before = self.device.work().uploads;
        let renderer = Renderer::new(self.device.clone(), volume)?;
        let uploads = AtomicU64::new(self.device.work().uploads - before);
        Ok(Arc::new(Uploaded { renderer, uploads }))
    }

    fn forms(&self) -> Option<Box<dyn Forms>> {
        Some(Box::new(Segments::new(self.device.clone())))
    }

    fn choose(&self, scene: &Scene, memory: &dyn Memory, progress: &dyn Progress) -> Result<Option<Chosen>> {
        compositors::choose(&self.device, &self.compositors, scene, memory, progress).map(Some)
    }

    fn forget(&self) {
        self.device.forget_pipelines();
    }

    fn multiply_adds_per_second(&self) -> Result<Option<f64>> {
        self.device.multiply_adds_per_second().map(Some)
    }
}

/// A volume on the device.
struct Uploaded {
    renderer: Renderer,
    /// Arrays that were uploaded and are not counted with any picture yet.
    uploads: AtomicU64,
}

impl Prepared for Uploaded {
    fn draw(&self, scene: &Scene, manner: &Manner, progress: &dyn Progress) -> Result<Drawn> {
        let device = self.renderer.device();
        let before = device.work();
        let drawn = draw(&self.renderer, scene, manner, progress)?;
        let after = device.work();
        let mut notes = notes(device, &drawn, manner);
        notes.counts.insert("shader_builds", after.shader_builds - before.shader_builds);
        let uploads = self.uploads.swap(0, Ordering::Relaxed) + after.uploads - before.uploads;
        notes.counts.insert("uploads", uploads);
        notes.counts.insert("bytes_uploaded", after.bytes_uploaded - before.bytes_uploaded);
        let counts = drawn.counts.of_engine(manner);
        Ok(Drawn { counts, picture: drawn.picture, stages: drawn.passes, notes })
    }

    fn operations(&self, scene: &Scene, manner: &Manner, counts: &Counts) -> Result<Option<u64>> {
        let Some(segments) = counts.segments else { return Ok(None) };
        let (choices, _) = draw::choices(&self.renderer, scene, manner)?;
        operations::of_compositor(&compose(&choices), segments).map(Some)
    }
}

/// What only this engine counts and leaves out, and what should be known of the device.
fn notes(device: &Device, drawn: &draw::Drawn, manner: &Manner) -> Notes {
    let mut notes = Notes::default();
    notes.counts.insert("tile_entries", drawn.counts.tile_entries);
    notes.counts.insert("sweeps_further", drawn.counts.sweeps_further);
    if drawn.blended_in_16_bits {
        let off = "what it draws may be off by some thousandths; compositor = \"tiles\" has 32 bits";
        notes.warnings.push(format!("{} blends no 32-bit floats: {off}", device.name));
    }
    if let (Some(leave), false) = (manner.may_leave_out, drawn.parts_left_out.is_empty()) {
        let what = format!("shader parts {}", drawn.parts_left_out.join(", "));
        let saving = Saving::Bytes(drawn.part_bytes_left_out);
        notes.leave_out(leave, what, "the scene asks for nothing of the kind", Some(saving));
    }
    notes
}

impl draw::Counts {
    /// Those that every engine may have. Where nothing may be left out, cells beside the picture are as those between its
    /// pixels: their place is found, and there is nothing more that could be done for them.
    fn of_engine(&self, manner: &Manner) -> Counts {
        let [culled_by_frustum, under_a_pixel] = match manner.may_leave_out {
            Some(_) => [self.culled_by_frustum, self.under_a_pixel],
            None => [0, self.culled_by_frustum + self.under_a_pixel],
        };
        Counts {
            culled_by_transfer_function: Some(self.culled_by_transfer_function),
            culled_by_frustum: Some(culled_by_frustum),
            under_a_pixel: Some(under_a_pixel),
            cells_projected: Some(self.cells_projected),
            segments: self.segments,
            segments_exact: Some(0),
            evaluations: None,
            pixels_disordered: self.pixels_disordered,
            tiles_stopped: Some(self.tiles_stopped),
            cells_hidden: Some(self.cells_hidden),
            tables_built: None,
        }
    }
}
