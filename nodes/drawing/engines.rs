//! The engines that there are: the one list that the nodes that draw, the studies and the commands go by.

use voltet_optics::engine::EngineInfo;

/// The device engine.
#[cfg(feature = "gpu")]
const GPU: EngineInfo = voltet_gpu::ENGINE;
#[cfg(not(feature = "gpu"))]
const GPU: EngineInfo = EngineInfo::absent(
    "gpu",
    "the graphics device, which this build has no engine for",
    "this build has no GPU engine",
);

/// The engines. The first draws every scene; `auto` asks those behind it first, the last before all others, but for those that
/// are taken by name only.
pub const ENGINES: &[EngineInfo] = &[voltet_cpu::ENGINE, GPU];

/// The engine that draws every scene, whatever machine this is.
pub const NATIVE: &EngineInfo = &ENGINES[0];

/// The engine on a device, which the node `gpu-renderer` always takes.
pub const DEVICE: &EngineInfo = &GPU;

#[cfg(all(test, feature = "gpu"))]
mod tests;
