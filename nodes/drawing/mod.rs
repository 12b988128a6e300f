//! Code shared by the nodes that draw: parameters, demand, the engines, and the CPU engine's stages, which
//! `cull`, `sort`, `project` and `composite` run one by one.

mod alone;
mod bands;
mod engine;
mod engines;
pub mod looked_at;
mod needs;
mod noted;
mod opened;
mod order;
mod prepared;
mod remembered;
mod scene;
mod shading;
mod stages;
mod visible;
mod wished;

pub use alone::Alone;
pub use bands::note_bands;
pub use engine::{ask_engine, candidate_engines, draw, is_asked_by, registered_reason};
pub use engines::{DEVICE, ENGINES, NATIVE};
pub use needs::ask;
pub use opened::{OpenEngines, PreparedVolumes};
pub use order::{ORDER, order, record_unsorted};
pub use prepared::{Culled, Projected};
pub use remembered::CacheFolder;
pub use scene::scene;
pub use shading::{PARAMETERS, shading};
pub use stages::{composite, composite_registered, cull, for_data, project, sort};
pub use visible::warnings as picture_warnings;
pub use wished::{ACCUMULATION, ADAPTER, AUTO, COMPOSITOR, ENGINE, ORDER_CHECK, accumulation, adapter};
