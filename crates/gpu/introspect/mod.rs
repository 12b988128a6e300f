//! Measurements of a device, and single ray segments through the composed shaders, for comparison with exact values. No part of the
//! public interface: it changes with the engine.

mod peak;
mod segments;

pub use segments::SegmentRunner;

use crate::device::device_handle::Device;
use crate::engine::{GpuEngine, GpuVolume};
use crate::frame::inputs::shader_key;
use std::any::Any;
use std::sync::Arc;
use voltet_core::Result;
use voltet_optics::engine::{Engine, PreparedVolume, RenderOptions};
use voltet_optics::scene::Scene;
use voltet_shaders::{Shader, compose};

/// Device of an engine, if it is this crate's.
pub fn device_of(engine: &dyn Engine) -> Option<&Arc<Device>> {
    (engine as &dyn Any).downcast_ref().map(|GpuEngine { device, .. }| device)
}

/// Shader that composites a scene of a volume that this crate's engine prepared. Errors: those of drawing the scene.
pub fn compositor_shader(
    volume: &dyn PreparedVolume,
    scene: &Scene,
    options: &RenderOptions,
) -> Result<Option<Shader>> {
    let Some(GpuVolume { renderer, .. }) = (volume as &dyn Any).downcast_ref() else { return Ok(None) };
    Ok(Some(compose(&shader_key(renderer, scene, options)?.0)))
}
