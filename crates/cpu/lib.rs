//! voltet-cpu: the native engine. Cull, sort, project and composite on all cores with vector units.
//!
//! Modules import those before them only: `tile`, `tolerances`, `cache`, `counts`; `view`, world space to pixel coordinates; `selection` of
//! cells and scaled point arrays (`attribute`); `project`, cells to screen-space planes and bins; `fragments`, rays intersected with a
//! tile's cells; `cast`, rays through shared faces; `shade`, segments to colour and opacity, and within it [`mod@integrator`], integrators
//! from outside, in lanes; `segment_cache`; `composite`, segments in order to pixels; `cells` with their volume's caches; `cull`;
//! `projection`, cells prepared for the compositor; `frame_renderer`, compositing on all threads; `draw`, the stages end to end; `memory`;
//! `native`, the engine's interface; `introspect`, single segments, for comparison with exact values.

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
pub use cull::{VolumeCache, cull};
pub use draw::{composite, draw, integrator, needs_gradient, prepare, prepare_scene, project, sort};
pub use frame_renderer::FrameRenderer;
pub use memory::drawing_bytes;
pub use native::ENGINE;
pub use projection::Projection;
pub use selection::{CellSelection, CullSample, Traversal};
pub use shade::integrator;
pub use tolerances::NEGLIGIBLE_DEPTH;
