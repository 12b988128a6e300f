//! Damaged and lying files: one clear error each, no panic, no memory beyond a small multiple of the file's size.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod corruption;
#[path = "../formats/legacy_writer.rs"]
mod legacy_writer;
mod lies;
mod memory;
#[path = "../formats/plot3d_writer.rs"]
mod plot3d_writer;
#[path = "../formats/samples.rs"]
mod samples;
#[path = "../formats/writer.rs"]
mod writer;
