//! The program as its users meet it: the built binary, run on small grids that the tests write.
#![allow(clippy::unwrap_used)] // A test that cannot go on has failed.

mod bad_data;
mod bad_pipelines;
mod calculator;
mod collisions;
mod colormap;
mod commands;
mod convert;
mod diff;
#[cfg(feature = "gpu")]
mod engines;
mod exhaustive;
mod finders;
mod foreign;
mod gradient_test;
mod info;
mod many;
mod memory;
mod multi_gradient;
mod outputs;
#[cfg(feature = "papers")]
mod papers;
mod parts;
mod pictures;
mod pixel;
mod plugin_ends;
mod plugin_faults;
mod plugin_fuzz;
mod plugin_node_faults;
mod plugin_node_fuzz;
mod plugin_node_scene;
mod plugin_nodes;
mod plugins;
#[cfg(feature = "mpi")]
mod ranks;
mod reports;
mod resume;
mod series;
mod series_functions;
mod stability;
mod start;
mod study;
#[cfg(feature = "gpu")]
mod study_devices;
mod support;
mod time;
mod traceability;
mod visible;
