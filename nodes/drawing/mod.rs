//! What the nodes that draw share: parameters, what a scene needs, and the stages themselves, which `renderer`
//! runs in one and `cull`, `sort`, `project` and `composite` one by one.

mod bands;
#[cfg(feature = "gpu")]
mod compositor;
#[cfg(feature = "gpu")]
mod device;
mod engine;
mod needs;
mod order;
mod prepared;
#[cfg(feature = "gpu")]
mod remembered;
mod scene;
mod shading;
mod stages;

pub use bands::note_bands;
#[cfg(feature = "gpu")]
pub use device::draw_by;
pub use engine::{ADAPTER, COMPOSITOR, ENGINE, ask_engine, compositors, draw, has_order};
pub use needs::{ask, needs_order};
pub use order::{ORDER, leave_out_order, order};
pub use prepared::{Culled, Projected};
pub use scene::{Scene, scene};
pub use shading::{PARAMETERS, shading};
pub use stages::{composite, cull, for_data, project, referee, sort};
