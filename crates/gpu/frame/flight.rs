//! Frames in flight: begun, and taken when they are there, so that neither the caller nor the device waits for the other.
//!
//! A device does what is submitted in turn, so the frames of a grid share all buffers but those that they come back by.

use crate::frame::buffers::Returning;
use crate::frame::draw::draw;
use crate::frame::drawn::{Drawn, StillEmpty};
use crate::frame::inputs::inputs;
use crate::frame::plan::{Ordered, Plan, check, plan};
use crate::frame::renderer::Renderer;
use crate::frame::windows::Flying;
use std::sync::Arc;
use voltet_core::progress::Progress;
use voltet_core::{Error, Result};
use voltet_optics::engine::RenderOptions;
use voltet_optics::scene::Scene;

/// Frames of a grid in flight at most: as many pictures are held on their way back.
const IN_FLIGHT: usize = 4;

/// A frame in flight.
pub struct InFlight {
    renderer: Arc<Renderer>,
    scene: Scene,
    manner: RenderOptions,
    ordered: Option<Ordered>,
    empty: StillEmpty,
    flying: Flying,
    berth: Berth,
}

/// A frame that was begun.
pub enum Begun {
    /// In flight.
    InFlight(Box<InFlight>),
    /// Drawn: it comes in parts, or enough are in flight.
    Drawn(Box<Drawn>),
}

/// What a frame comes back by; a place among those in flight.
struct Berth {
    renderer: Arc<Renderer>,
    returning: Option<Returning>,
}

impl Berth {
    /// A place, where there is one.
    fn take(renderer: &Arc<Renderer>) -> Option<Berth> {
        let mut buffers = renderer.buffers();
        if buffers.in_flight >= IN_FLIGHT {
            return None;
        }
        buffers.in_flight += 1;
        let returning = Some(buffers.landed.pop().unwrap_or_default());
        Some(Berth { renderer: renderer.clone(), returning })
    }

    /// The frame is there: its buffers serve the next one.
    fn land(mut self) {
        let returning = self.returning.take();
        self.renderer.buffers().landed.extend(returning);
    }
}

impl Drop for Berth {
    // The buffers of a frame that nobody took may still be on their way: others are made.
    fn drop(&mut self) {
        self.renderer.buffers().in_flight -= 1;
    }
}

/// Begins a frame; see [`draw`]. Errors: those of [`draw`].
pub fn begin(
    renderer: &Arc<Renderer>,
    scene: &Scene,
    manner: &RenderOptions,
    progress: &dyn Progress,
) -> Result<Begun> {
    if progress.cancelled() {
        return Err(Error::cancelled());
    }
    let ordered = match plan(renderer, scene, manner)? {
        Plan::AsAsked => None,
        Plan::AlongFaces(ordered) => Some(ordered),
        Plan::Tiles(_) => return drawn(renderer, scene, manner, progress),
    };
    let Some(mut berth) = Berth::take(renderer) else { return drawn(renderer, scene, manner, progress) };
    let inputs = inputs(renderer, scene, manner, ordered.as_ref().map(|ordered| &ordered.0))?;
    let flying = inputs.submit(berth.returning.get_or_insert_default())?;
    let Some(flying) = flying else {
        drop(inputs);
        berth.land();
        return drawn(renderer, scene, manner, progress);
    };
    let empty = inputs.still_empty(scene, manner);
    Ok(Begun::InFlight(Box::new(InFlight {
        renderer: renderer.clone(),
        scene: scene.clone(),
        manner: *manner,
        ordered,
        empty,
        flying,
        berth,
    })))
}

fn drawn(
    renderer: &Renderer,
    scene: &Scene,
    manner: &RenderOptions,
    progress: &dyn Progress,
) -> Result<Begun> {
    draw(renderer, scene, manner, progress).map(|drawn| Begun::Drawn(Box::new(drawn)))
}

impl Begun {
    /// The picture, once it is there. Errors: those of [`draw`].
    pub fn collect(self, progress: &dyn Progress) -> Result<Drawn> {
        match self {
            Begun::Drawn(drawn) => Ok(*drawn),
            Begun::InFlight(frame) => {
                let InFlight { renderer, scene, manner, ordered, empty, flying, berth } = *frame;
                let Some(returned) = flying.land(renderer.device())? else {
                    berth.land();
                    return draw(&renderer, &scene, &manner, progress);
                };
                berth.land();
                let drawn = empty.with(returned);
                match ordered {
                    Some(ordered) => check(&renderer, &scene, &manner, ordered, drawn, progress),
                    None => Ok(drawn),
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::device::open::Device;
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
        let manner = RenderOptions::by(Compositor::Tiles);
        let start = || begin(&renderer, &scene, &manner, &NoProgress);
        draw(&renderer, &scene, &manner, &NoProgress).expect("draws");
        let frames: Vec<Begun> = (0..3).map(|_| start().expect("begins")).collect();
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
