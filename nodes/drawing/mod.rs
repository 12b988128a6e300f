//! Code shared by the nodes that draw: parameters, demand, the engines, and the CPU engine's stages, which
//! `cull`, `sort`, `project` and `composite` run one by one.

mod diagnostics;
mod engines;
mod shading;
mod stages;

pub use diagnostics::{note_bands, warnings as picture_warnings};
pub use engines::{
    ACCUMULATION, ADAPTER, AUTO, COMPOSITOR, CacheFolder, DEVICE, ENGINE, ENGINES, NATIVE, ORDER_CHECK,
    OpenEngines, PreparedVolumes, accumulation, adapter, ask_engine, candidate_engines, draw, is_asked_by,
    registered_reason,
};
pub use shading::{ORDER, PARAMETERS, ask, order, record_unsorted, shading};
pub use stages::{Culled, Projected, composite, composite_registered, cull, for_data, project, scene, sort};
