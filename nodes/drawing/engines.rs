//! The engines that there are: the one list that the nodes that draw, the studies and the commands go by.

use voltet_core::engine::Declaration;
use voltet_core::reference;
use voltet_core::{Error, Result};

/// The device engine.
#[cfg(feature = "gpu")]
const GPU: Declaration = voltet_gpu::ENGINE;
#[cfg(not(feature = "gpu"))]
const GPU: Declaration = Declaration::absent(
    "gpu",
    "the graphics device, which this build has no engine for",
    "this build has no GPU engine",
);

/// The engines. The first draws every scene; `auto` asks those behind it first, the last before all others.
pub const ENGINES: &[Declaration] = &[voltet_engine::ENGINE, GPU];

/// What the engines are held against. It draws where the integrator is the reference.
pub const REFEREE: &Declaration = &reference::ENGINE;

/// The engine that draws every scene, whatever machine this is.
pub const NATIVE: &Declaration = &ENGINES[0];

/// The engine of that name.
pub fn engine(name: &str) -> Result<&'static Declaration> {
    ENGINES.iter().find(|engine| engine.name == name).ok_or_else(|| {
        Error::usage("there is no engine of this name")
            .found(name)
            .accepted(voltet_core::graph::suggest(name, ENGINES.iter().map(|engine| engine.name)))
    })
}

#[cfg(all(test, feature = "gpu"))]
mod tests;
