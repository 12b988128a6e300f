//! Reading files of every format.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod blocks;
mod cgns;
mod encodings;
mod exodus;
mod legacy;
mod packed;
mod pieces;
mod plot3d;
mod real_files;
mod surfaces;
mod vtkhdf;
mod writers;
mod xdmf;
