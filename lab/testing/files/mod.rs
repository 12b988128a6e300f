//! Small data files in every format and encoding, written independently of the readers.

pub mod legacy;
pub mod pieces;
pub mod plot3d;
pub mod samples;
pub mod surfaces;
pub mod xml;
