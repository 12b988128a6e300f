//! Code shared by the nodes that draw: parameters, demand, the engines, and findings about pictures.

mod diagnostics;
mod engines;
mod layers;
mod memory;
mod parts;
mod scene;

pub use diagnostics::warnings as picture_warnings;
pub(crate) use diagnostics::{note, note_bands, note_unsorted, record_unsorted};
pub use engines::*;
pub(crate) use layers::{contributing_cells, image};
pub use memory::MemoryNeed;
pub(crate) use parts::draw_parts;
pub use scene::*;
