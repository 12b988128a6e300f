//! Damaged and lying files: one clear error each, no panic, no memory beyond a small multiple of the file's size.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod companions;
mod corruption;
mod damage;
mod lies;
mod memory;
mod surfaces;
