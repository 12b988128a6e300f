//! The parts of the node `probe`: its parameters, and what it says.

mod found;
mod parameters;

pub use found::{figures, sentence};
pub use parameters::{PARAMETERS, check_region, fields, mask, placed, region};
