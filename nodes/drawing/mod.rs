//! Code shared by the nodes that draw: parameters, demand, the engines, and the CPU engine's stages, which
//! `cull`, `sort`, `project` and `composite` run one by one.

mod bands;
mod diagnostics;
mod disk_cache;
mod engine;
mod engine_cache;
mod engines;
pub mod gradient_mask;
mod needs;
mod order;
mod parameters;
mod prepared;
mod scene;
mod shading;
mod stages;
mod visible;

pub use bands::note_bands;
pub use disk_cache::CacheFolder;
pub use engine::{ask_engine, candidate_engines, draw, is_asked_by, registered_reason};
pub use engine_cache::{OpenEngines, PreparedVolumes};
pub use engines::{DEVICE, ENGINES, NATIVE};
pub use needs::ask;
pub use order::{ORDER, order, record_unsorted};
pub use parameters::{ACCUMULATION, ADAPTER, AUTO, COMPOSITOR, ENGINE, ORDER_CHECK, accumulation, adapter};
pub use prepared::{Culled, Projected};
pub use scene::scene;
pub use shading::{PARAMETERS, shading};
pub use stages::{composite, composite_registered, cull, for_data, project, sort};
pub use visible::warnings as picture_warnings;
