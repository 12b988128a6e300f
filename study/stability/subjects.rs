//! What is judged: sets of forms, and what draws pictures.

use crate::devices::{self, Device};
use std::sync::Arc;
use voltet_core::camera::Camera;
use voltet_core::picture::Picture;
use voltet_core::progress::Progress;
use voltet_core::shading::Shading;
use voltet_core::transfer::TransferFunction;
use voltet_core::volume::Volume;
use voltet_core::{Error, Result};
use voltet_engine as engine;
use voltet_judge::{Forms, Native64};
use voltet_lanes::LaneSet;

/// The sets of forms and the engines that this build and this machine have.
pub struct Subjects {
    /// 64-bit, 32-bit by lane set, WGSL on a device.
    pub forms: Vec<Box<dyn Forms>>,
    /// What is not judged, why, and how to have it.
    pub left_out: Vec<String>,
    pub(super) painters: Vec<Painter>,
}

/// What draws a picture.
pub(super) enum Painter {
    /// The native engine.
    Native(LaneSet),
    /// The device engine.
    Device(Arc<Device>),
}

/// Everything that can be judged here. `adapter`: a device by its kind or a part of its name; without it the fastest that is
/// hardware, and what is left out where there is none.
///
/// Errors: a device that is named and not there.
pub fn subjects(adapter: Option<&str>) -> Result<Subjects> {
    let sets: Vec<engine::Segments> = engine::Segments::each().collect();
    let painters = sets.iter().map(|set| Painter::Native(set.lanes)).collect();
    let mut forms: Vec<Box<dyn Forms>> = vec![Box::new(Native64)];
    forms.extend(sets.into_iter().map(|set| Box::new(set) as Box<dyn Forms>));
    let mut subjects = Subjects { forms, left_out: Vec::new(), painters };
    match devices::open(adapter) {
        Ok(device) => subjects.add(Arc::new(device)),
        Err(error) if adapter.is_some() => return Err(error),
        Err(error) => subjects.left_out.push(format!("the shaders of a device: {error}")),
    }
    Ok(subjects)
}

impl Subjects {
    fn add(&mut self, device: Arc<Device>) {
        #[cfg(feature = "gpu")]
        self.forms.push(Box::new(voltet_gpu::Segments::new(device.clone())));
        self.painters.push(Painter::Device(device));
    }
}

impl Painter {
    /// For people.
    pub fn name(&self) -> String {
        match self {
            Painter::Native(lanes) => format!("native engine, {}", lanes.name()),
            #[cfg(feature = "gpu")]
            Painter::Device(device) => device.name.clone(),
            #[cfg(not(feature = "gpu"))]
            Painter::Device(device) => match **device {},
        }
    }

    /// The picture in exact order; the inner error says what a device does not hold.
    pub fn draw(
        &self,
        volume: &Arc<Volume>,
        look: &TransferFunction,
        camera: &Camera,
        shading: &Shading,
        progress: &dyn Progress,
    ) -> Result<std::result::Result<Picture, Error>> {
        match self {
            Painter::Native(lanes) => {
                let mut cells = engine::cull(volume, look, camera, progress)?;
                cells.lanes = *lanes;
                Ok(Ok(engine::draw(&cells, look, camera, shading, progress)?.0))
            }
            #[cfg(feature = "gpu")]
            Painter::Device(device) => on_device(device, volume, look, camera, shading, progress),
            #[cfg(not(feature = "gpu"))]
            Painter::Device(device) => match **device {},
        }
    }
}

#[cfg(feature = "gpu")]
fn on_device(
    device: &Arc<Device>,
    volume: &Arc<Volume>,
    look: &TransferFunction,
    camera: &Camera,
    shading: &Shading,
    progress: &dyn Progress,
) -> Result<std::result::Result<Picture, Error>> {
    use voltet_core::shading::Order;
    let draw = || {
        let renderer = voltet_gpu::Renderer::new(device.clone(), volume)?;
        voltet_gpu::draw(&renderer, volume, look, camera, shading, Order::Exact, progress)
    };
    match draw() {
        Ok(drawn) => Ok(Ok(drawn.picture)),
        Err(error) if progress.cancelled() || device.is_lost() => Err(error),
        Err(error) => Ok(Err(error)),
    }
}
