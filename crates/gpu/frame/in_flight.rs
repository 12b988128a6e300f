//! Frames in flight: submitted, and collected once they are finished, so that neither the caller nor the device blocks the other.
//!
//! A device does what is submitted in turn, so the frames of a grid share all buffers but those that they come back by.

use crate::frame::buffers::ReadbackBuffers;
use crate::frame::draw::draw;
use crate::frame::inputs::inputs;
use crate::frame::output::{FrameOutput, PendingStats};
use crate::frame::plan::{Plan, TimedFaceOrder, check, plan};
use crate::frame::renderer::Renderer;
use crate::frame::windows::SubmittedPicture;
use std::sync::Arc;
use voltet_core::progress::Progress;
use voltet_core::{Error, Result};
use voltet_optics::engine::RenderOptions;
use voltet_optics::scene::Scene;

/// Frames of a grid in flight at most: as many pictures are held on their way back.
const IN_FLIGHT: usize = 4;

/// A frame in flight.
pub struct PendingFrame {
    renderer: Arc<Renderer>,
    scene: Scene,
    options: RenderOptions,
    ordered: Option<TimedFaceOrder>,
    pending: PendingStats,
    submitted: SubmittedPicture,
    slot: FrameSlot,
}

/// A submitted frame.
pub enum SubmittedFrame {
    /// In flight.
    InFlight(Box<PendingFrame>),
    /// Drawn at once: it comes in parts, or enough are in flight.
    Finished(Box<FrameOutput>),
}

/// Readback slot of a frame in flight.
struct FrameSlot {
    renderer: Arc<Renderer>,
    returning: Option<ReadbackBuffers>,
}

impl FrameSlot {
    /// A free slot, where there is one.
    fn take(renderer: &Arc<Renderer>) -> Option<FrameSlot> {
        let mut buffers = renderer.buffers();
        if buffers.in_flight >= IN_FLIGHT {
            return None;
        }
        buffers.in_flight += 1;
        let returning = Some(buffers.idle_readbacks.pop().unwrap_or_default());
        Some(FrameSlot { renderer: renderer.clone(), returning })
    }

    /// Frees the slot of a finished frame; the next one reuses its buffers.
    fn finish(mut self) {
        let returning = self.returning.take();
        self.renderer.buffers().idle_readbacks.extend(returning);
    }
}

impl Drop for FrameSlot {
    // The buffers of a frame that nobody took may still be on their way: others are made.
    fn drop(&mut self) {
        self.renderer.buffers().in_flight -= 1;
    }
}

/// Submits a frame; see [`draw`]. Errors: those of [`draw`].
pub fn begin(
    renderer: &Arc<Renderer>,
    scene: &Scene,
    options: &RenderOptions,
    progress: &dyn Progress,
) -> Result<SubmittedFrame> {
    if progress.cancelled() {
        return Err(Error::cancelled());
    }
    let ordered = match plan(renderer, scene, options)? {
        Plan::Direct => None,
        Plan::FaceOrder(ordered) => Some(ordered),
        Plan::Tiles(_) => return draw_at_once(renderer, scene, options, progress),
    };
    let Some(mut slot) = FrameSlot::take(renderer) else {
        return draw_at_once(renderer, scene, options, progress);
    };
    let inputs = inputs(renderer, scene, options, ordered.as_ref().map(|ordered| &ordered.0))?;
    let submitted = inputs.submit(slot.returning.get_or_insert_default())?;
    let Some(submitted) = submitted else {
        drop(inputs);
        slot.finish();
        return draw_at_once(renderer, scene, options, progress);
    };
    let pending = inputs.pending_stats(scene, options);
    Ok(SubmittedFrame::InFlight(Box::new(PendingFrame {
        renderer: renderer.clone(),
        scene: scene.clone(),
        options: *options,
        ordered,
        pending,
        submitted,
        slot,
    })))
}

fn draw_at_once(
    renderer: &Renderer,
    scene: &Scene,
    options: &RenderOptions,
    progress: &dyn Progress,
) -> Result<SubmittedFrame> {
    draw(renderer, scene, options, progress).map(|output| SubmittedFrame::Finished(Box::new(output)))
}

impl SubmittedFrame {
    /// Blocks until the frame is finished. Errors: those of [`draw`].
    pub fn collect(self, progress: &dyn Progress) -> Result<FrameOutput> {
        match self {
            SubmittedFrame::Finished(output) => Ok(*output),
            SubmittedFrame::InFlight(frame) => {
                let PendingFrame { renderer, scene, options, ordered, pending, submitted, slot } = *frame;
                let Some(returned) = submitted.finish(renderer.device())? else {
                    slot.finish();
                    return draw(&renderer, &scene, &options, progress);
                };
                slot.finish();
                let output = pending.with(returned);
                match ordered {
                    Some(ordered) => check(&renderer, &scene, &options, ordered, output, progress),
                    None => Ok(output),
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::device::device_handle::Device;
    use voltet_core::progress::NoProgress;
    use voltet_optics::engine::Compositor;
    use voltet_optics::shading::VisibilityOrder;
    use voltet_testing::pictures::compare::{NamedScene, SHADING};
    use voltet_testing::pictures::grids::{cube, smooth};
    use voltet_testing::pictures::looks::{outside, overlapping};

    /// A device that is lost in between is an error for each of the frames, whatever becomes of them, and for the next one.
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
        let options = RenderOptions::with_compositor(Compositor::Tiles);
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
