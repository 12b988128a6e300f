//! Draws a volume on a device: at once, or submitted and collected once it is finished, so that neither the caller nor the device
//! blocks the other.
//!
//! A device does what is submitted in turn, so the frames of a grid share all buffers but those that they come back by.

use crate::frame::inputs::inputs;
use crate::frame::output::{FrameOutput, PendingStats};
use crate::frame::passes::SubmittedPicture;
use crate::frame::renderer::{ReadbackBuffers, Renderer};
use std::sync::Arc;
use voltet_core::Result;
use voltet_core::progress::Progress;
use voltet_optics::engine::RenderOptions;
use voltet_optics::scene::Scene;

/// Draws a scene of the volume that `renderer` was made from; by tiles where the compositor that is asked for cannot make the scene's
/// order.
///
/// Errors: what the device has no shader for, cannot hold in 32 bits, or has more parts than it binds; memory; a lost device; a
/// stopped run.
pub fn draw(
    renderer: &Renderer,
    scene: &Scene,
    options: &RenderOptions,
    progress: &dyn Progress,
) -> Result<FrameOutput> {
    inputs(renderer, scene, options, progress)?.draw(progress)
}

/// Frames of a grid in flight at most: as many pictures are held on their way back.
const IN_FLIGHT: usize = 4;

/// A submitted frame.
pub enum SubmittedFrame {
    /// In flight.
    InFlight(Box<PendingFrame>),
    /// Drawn already: it takes several submissions, or all slots are taken.
    Finished(Box<FrameOutput>),
}

/// A frame in flight.
pub struct PendingFrame {
    scene: Scene,
    options: RenderOptions,
    pending: PendingStats,
    submitted: SubmittedPicture,
    slot: FrameSlot,
}

struct FrameSlot {
    renderer: Arc<Renderer>,
    readback: Option<ReadbackBuffers>,
}

impl FrameSlot {
    /// A free slot, where there is one.
    fn take(renderer: &Arc<Renderer>) -> Option<FrameSlot> {
        let mut buffers = renderer.buffers();
        if buffers.in_flight >= IN_FLIGHT {
            return None;
        }
        buffers.in_flight += 1;
        let readback = Some(buffers.idle_readbacks.pop().unwrap_or_default());
        Some(FrameSlot { renderer: renderer.clone(), readback })
    }

    /// Frees the slot of a finished frame; the next one reuses its buffers.
    fn finish(mut self) {
        let readback = self.readback.take();
        self.renderer.buffers().idle_readbacks.extend(readback);
    }
}

impl Drop for FrameSlot {
    // The buffers of a frame that nobody took may still be mapped, so they are not used again.
    fn drop(&mut self) {
        self.renderer.buffers().in_flight -= 1;
    }
}

/// Submits a frame, or draws it now where it takes several submissions or all slots are taken. Errors: those of [`draw`].
pub fn begin(
    renderer: &Arc<Renderer>,
    scene: &Scene,
    options: &RenderOptions,
    progress: &dyn Progress,
) -> Result<SubmittedFrame> {
    progress.check_cancelled()?;
    if let Some(mut slot) = FrameSlot::take(renderer) {
        let inputs = inputs(renderer, scene, options, progress)?;
        if let Some(submitted) = inputs.submit(slot.readback.get_or_insert_default())? {
            let (pending, scene, options) = (inputs.pending, scene.clone(), *options);
            let frame = PendingFrame { scene, options, pending, submitted, slot };
            return Ok(SubmittedFrame::InFlight(Box::new(frame)));
        }
        drop(inputs);
        slot.finish();
    }
    draw(renderer, scene, options, progress).map(|output| SubmittedFrame::Finished(Box::new(output)))
}

impl SubmittedFrame {
    /// Blocks until the frame is finished. Errors: those of [`draw`].
    pub fn collect(self, progress: &dyn Progress) -> Result<FrameOutput> {
        let frame = match self {
            SubmittedFrame::Finished(output) => return Ok(*output),
            SubmittedFrame::InFlight(frame) => frame,
        };
        let PendingFrame { scene, options, pending, submitted, slot } = *frame;
        let renderer = slot.renderer.clone();
        let returned = submitted.finish(renderer.device())?;
        slot.finish();
        match returned {
            Some(returned) => Ok(pending.with(returned)),
            None => draw(&renderer, &scene, &options, progress),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::device::Device;
    use std::sync::Arc;
    use voltet_core::progress::NoProgress;
    use voltet_optics::engine::Compositor;
    use voltet_optics::shading::VisibilityOrder;
    use voltet_testing::pictures::compare::{NamedScene, SHADING};
    use voltet_testing::pictures::grids::{cube, smooth};
    use voltet_testing::pictures::looks::{outside, overlapping};

    /// Frames that a lost device had not sent back before are errors that say so, and so is the next one.
    #[test]
    fn a_lost_device_is_an_error() {
        let device = match Device::open(std::env::var("VOLTET_ADAPTER").ok().as_deref(), false) {
            Ok(device) => Arc::new(device),
            Err(why) => return voltet_testing::skipped_without_device(why),
        };
        let volume = smooth(cube([5, 5, 5], 0.2));
        let renderer = Arc::new(Renderer::new(device.clone(), &volume).expect("fits"));
        let scene =
            NamedScene { name: "cube".into(), volume, look: overlapping(), camera: outside([40, 32]) };
        let scene = scene.drawn_by(&SHADING, VisibilityOrder::Exact);
        let options = RenderOptions { compositing: Some(Compositor::Tiles), ..RenderOptions::default() };
        let start = || begin(&renderer, &scene, &options, &NoProgress);
        draw(&renderer, &scene, &options, &NoProgress).expect("draws");
        let frames: Vec<SubmittedFrame> = (0..3).map(|_| start().expect("begins")).collect();
        device.device.destroy();
        for frame in frames {
            // What had come back before may still be taken.
            if let Err(error) = frame.collect(&NoProgress) {
                assert!(error.to_string().contains("lost"), "{error}");
            }
        }
        assert!(start().and_then(|frame| frame.collect(&NoProgress)).is_err());
        assert!(device.is_lost());
    }
}
