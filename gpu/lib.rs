//! voltet-gpu: the device engine. Cull, project, sort and composite as passes on a graphics device, through wgpu.
//!
//! The grid is uploaded once ([`DeviceGrid`]); a frame changes uniforms and reads back the picture and a few counts.
//! [`Segments`] runs the same shaders over segments alone, for judging them.
//! The shaders come from `voltet-shaders`; this crate knows devices, buffers and the order of the passes.

mod adapter;
mod axes;
mod buffers;
mod device;
mod draw;
mod drawing;
mod frame;
mod grid;
mod limits;
mod measure;
mod operations;
mod parts;
mod passes;
mod peak;
mod pipelines;
mod raster;
mod segments;
mod sort;
mod steps;
mod support;
mod tables;
mod timing;
mod view;

pub use adapter::{Adapters, KINDS};
pub use device::{Device, Work};
pub use draw::{Compositing, Counts, Drawn, How, draw, no_exact_order};
pub use grid::DeviceGrid;
pub use limits::can_serve;
pub use measure::{Times, measure};
pub use segments::Segments;
