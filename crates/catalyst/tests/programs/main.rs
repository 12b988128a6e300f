//! Simulations as Catalyst sees them: trees of Conduit that are drawn, refused, and drawn by several processes; the examples.
//!
//! Conduit is that of `VOLTET_CATALYST=FOLDER/lib/libcatalyst.so` where that is set, else a stand-in (`tests/c`).
#![allow(clippy::unwrap_used)] // A test that cannot go on has failed.

mod drawn;
mod examples;
mod library;
mod ranks;
mod refused;
mod steps;
mod tree;
