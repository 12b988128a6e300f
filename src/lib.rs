//! voltet: volume pictures of results on unstructured grids, straight from the cells, with transfer functions over
//! a scalar and its gradient magnitude.
//!
//! This crate is the program and a facade over libraries: [`core`] (what a scene is), [`engine`] (what draws it
//! natively), `gpu` (what draws it on a device; the feature of that name) and [`nodes`] (what reads, draws and writes it). [`Document`] opens a pipeline file, [`nodes::session`] runs it.
//!
//! ```no_run
//! # fn main() -> voltet::core::Result<()> {
//! let registry = voltet::nodes::registry()?;
//! let document = voltet::Document::open("scene.toml".as_ref(), &[], &registry)?;
//! let report = voltet::nodes::session().run(&document.graph, &voltet::graph::Unobserved)?;
//! println!("{} s", report.seconds);
//! # Ok(())
//! # }
//! ```
//!
//! [`run`] is the program itself, so that one with nodes and filters of its own is a `main` of a few lines.

mod arguments;
mod collisions;
mod commands;
mod document;
mod mistake;
mod options;
mod present;
mod program;

pub use document::{Document, Source};
pub use mistake::OrEnd;
pub use program::{registry, run};
pub use voltet_core as core;
pub use voltet_cpu as engine;
#[cfg(feature = "gpu")]
pub use voltet_gpu as gpu;
pub use voltet_graph as graph;
pub use voltet_io as io;
pub use voltet_judge as judge;
pub use voltet_nodes as nodes;
pub use voltet_optics as optics;
pub use voltet_simd as lanes;
pub use voltet_study as study;
pub use voltet_study::stability;
