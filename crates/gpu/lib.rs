//! voltet-gpu: the device engine. Cull, project, sort and composite as passes on a graphics device, through wgpu.
//!
//! The grid is uploaded once ([`Renderer`]); a frame changes uniforms and reads back the picture and a few counts.
//! The shaders come from `voltet-shaders`; this crate knows devices, buffers and the order of the passes.

mod bound_pass;
mod device;
mod engine;
mod flat_cells;
mod frame;
mod grid;
#[doc(hidden)]
pub mod introspect;
mod raster;
mod tables;

pub use device::adapter::{Adapters, KINDS};
pub use device::{Device, WorkCounts};
pub use engine::{ENGINE, GpuEngine};
pub use frame::draw::{PendingFrame, SubmittedFrame, begin, draw};
pub use frame::inputs::can_serve;
pub use frame::output::FrameOutput;
pub use frame::renderer::Renderer;
