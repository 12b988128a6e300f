//! Visibility: orders of cells.
//!
//! An order of whole cells need not exist: cells may hide each other in a cycle. Where there is none, the exact order is carried
//! out by a compositor, pixel by pixel.

mod centroid;
mod disorder;
mod faces;
mod order;
mod rays;

pub use centroid::centroid_order;
pub use disorder::{Disorder, disorder};
pub use faces::Faces;
pub use order::{FaceOrder, OrderError};
