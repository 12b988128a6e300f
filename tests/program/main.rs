//! The program as its users meet it: the built binary, run on small grids that the tests write.
#![allow(clippy::unwrap_used)] // A test that cannot go on has failed.

mod bad_data;
mod bad_pipelines;
mod commands;
#[cfg(feature = "gpu")]
mod engines;
mod finders;
mod left_out;
mod pictures;
mod reports;
mod stability;
mod study;
#[cfg(feature = "gpu")]
mod study_devices;
mod support;
mod time;
