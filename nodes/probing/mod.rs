//! The parts of the node `probe`: its parameters, and what it says.

mod parameters;
mod result;

pub use parameters::{PARAMETERS, check_region, fields, mask, placed, region};
pub use result::{figures, sentence};
