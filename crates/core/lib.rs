//! voltet-core: grids, fields, transfer functions, cameras and pictures, without files, windows or devices.
//!
//! No GPU, no windows, no files. Each module's head says what it is, its symbols and units, and its source.

pub mod arithmetic;
pub mod camera;
pub mod camera_path;
pub mod clip;
pub mod color;
pub mod colormap;
mod counted;
pub mod diagnostics;
pub mod error;
pub mod expression;
pub mod field;
pub mod flat_picture;
pub mod grid;
mod nearest;
pub mod parallel;
pub mod parameters;
pub mod picture;
pub mod picture_parts;
pub mod probing;
pub mod progress;
pub mod reading;
mod shared;
pub mod surface;
pub mod transfer;
pub mod tubes;
pub mod visibility;
pub mod volume;

pub use counted::{agreeing, counted, noun_of, with_commas};
pub use error::{Error, Result};
/// Vectors and matrices, in the version that the types here are made of.
pub use glam;
pub use shared::{SharedSlice, hash_of_bytes};
