//! Grids with results to files: VTK (.vtu) and VTKHDF (.vtkhdf).
//!
//! [`Contents`] borrows the arrays of a grid; a format writes them one after the other, a part at a time, and copies none as a whole.

mod contents;
mod format;
mod hdf5;
mod numbers;
mod vtkhdf;
mod vtu;

pub use contents::{Contents, Role};
pub use format::GridFormat;
pub use numbers::Precision;
