//! voltet-introspect: measurements of the engines beyond pictures, which their own traits do not have.

#![allow(missing_docs, reason = "unpublished: names say what fields and short functions are")]

mod lanes;
#[cfg(feature = "gpu")]
mod wgsl;

pub use lanes::LaneEvaluator;
#[cfg(feature = "gpu")]
pub use wgsl::WgslEvaluator;

use std::sync::Arc;
use voltet_core::Result;
use voltet_cpu::introspect::{engine_on, lane_sets, lanes_of};
#[cfg(feature = "gpu")]
use voltet_gpu::introspect::{compositor_shader, device_of};
use voltet_judge::SegmentEvaluator;
use voltet_optics::engine::{AdapterRequest, Engine, EngineInfo, PreparedVolume, RenderOptions, RenderStats};
use voltet_optics::scene::Scene;

/// Variants of an engine that are judged one by one: the CPU engine on each lane set, others as they are.
///
/// # Errors
///
/// - Those of [`EngineInfo::open`].
pub fn open_variants(engine: &EngineInfo, request: &AdapterRequest) -> Result<Vec<Arc<dyn Engine>>> {
    if *engine == voltet_cpu::ENGINE {
        return Ok(lane_sets().map(engine_on).collect());
    }
    Ok(vec![engine.open(request)?])
}

/// Formulas that the engine integrates segments with; `None` where only its pictures can be judged.
pub fn evaluator(engine: &dyn Engine) -> Option<Box<dyn SegmentEvaluator>> {
    if let Some(lanes) = lanes_of(engine) {
        return Some(Box::new(LaneEvaluator::new(lanes)));
    }
    #[cfg(feature = "gpu")]
    if let Some(device) = device_of(engine) {
        return Some(Box::new(WgslEvaluator::new(device.clone())));
    }
    None
}

/// Drops what a device caches for further scenes, so that the next set-up starts from nothing.
pub fn clear_caches(#[cfg_attr(not(feature = "gpu"), expect(unused))] engine: &dyn Engine) {
    #[cfg(feature = "gpu")]
    if let Some(device) = device_of(engine) {
        device.forget_pipelines();
    }
}

/// Rate of 32-bit multiply-adds of a device (1/s), measured; `None` of other engines. Errors: a lost device.
pub fn multiply_adds_per_second(
    #[cfg_attr(not(feature = "gpu"), expect(unused))] engine: &dyn Engine,
) -> Result<Option<f64>> {
    #[cfg(feature = "gpu")]
    if let Some(device) = device_of(engine) {
        return device.multiply_adds_per_second().map(Some);
    }
    Ok(None)
}

/// Lower bound of the floating-point operations of the compositor in a picture with these statistics, where it is known.
///
/// # Errors
///
/// - Those of drawing the scene.
pub fn compositor_operations(
    volume: &dyn PreparedVolume,
    scene: &Scene,
    options: &RenderOptions,
    stats: &RenderStats,
) -> Result<Option<u64>> {
    #[cfg(feature = "gpu")]
    if let (Some(segments), Some(shader)) = (stats.segments, compositor_shader(volume, scene, options)?) {
        return wgsl::compositor_operations(&shader, segments).map(Some);
    }
    #[cfg(not(feature = "gpu"))]
    let _ = (volume, scene, options, stats);
    Ok(None)
}
