//! Reading files of every format.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod encodings;
mod legacy;
mod legacy_writer;
mod pieces;
mod plot3d;
mod plot3d_writer;
mod real_files;
mod samples;
mod writer;
