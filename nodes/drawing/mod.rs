//! Code shared by the nodes that draw: parameters, demand, the engines, and findings about pictures.

mod diagnostics;
mod engines;
mod scene;

pub use diagnostics::warnings as picture_warnings;
pub(crate) use diagnostics::{note, note_bands, note_unsorted, record_unsorted};
pub use engines::*;
pub use scene::*;
