//! voltet-cpu: the native engine. Cull, sort, project and composite on all cores with vector units.
//!
//! | module | responsibility |
//! | --- | --- |
//! | `tile`, `tolerances`, `cache`, `counts` | bottom layer: tiles, tolerances, caches, counts |
//! | `view` | world space to pixel coordinates |
//! | `selection`, `attribute` | selected cells; scaled point arrays |
//! | `project` | cells to screen-space planes and bins |
//! | `fragments` | rays intersected with a tile's cells |
//! | `cast` | ray casting through shared faces |
//! | `shade` | segments to colour and opacity |
//! | `segment_cache` | segments cached between pictures |
//! | [`mod@integrator`] | integrators from outside, in lanes |
//! | `composite` | segments in order to pixels |
//! | `cells` | selection with its volume's caches |
//! | `cull` | cells that can contribute |
//! | `projection` | cells prepared for the compositor |
//! | `frame_renderer` | compositing on all threads |
//! | `draw` | stages end to end |
//! | `memory` | memory that drawing takes |
//! | `native` | engine interface |
//! | `introspect` | single segments, for comparison with exact values |
//!
//! Modules import those above them only.

mod attribute;
mod cache;
mod cast;
mod cells;
mod composite;
mod counts;
mod cull;
mod draw;
mod fragments;
mod frame_renderer;
#[doc(hidden)]
pub mod introspect;
mod memory;
mod native;
mod project;
mod projection;
mod segment_cache;
mod selection;
mod shade;
mod tile;
mod tolerances;
mod view;

pub use cells::Cells;
pub use counts::Counts;
pub use cull::{VolumeCache, cull, keep_all};
pub use draw::{composite, draw, integrator, needs_gradient, prepare, project, sort};
pub use frame_renderer::FrameRenderer;
pub use memory::drawing_bytes;
pub use native::ENGINE;
pub use projection::Projection;
pub use selection::{CellSelection, CullSample, Traversal};
pub use shade::integrator;
pub use tolerances::NEGLIGIBLE_DEPTH;
