//! voltet-gpu: the device engine. Cull, project, sort and composite as passes on a graphics device, through wgpu.
//!
//! The grid is uploaded once ([`Renderer`]); a frame changes uniforms and reads back the picture and a few counts.
//! The shaders come from `voltet-shaders`; this crate knows devices, buffers and the order of the passes.

mod compositors;
mod device;
mod engine;
mod frame;
mod grid;
#[doc(hidden)]
pub mod introspect;
mod pass;
mod raster;

pub use device::adapter::{Adapters, KINDS};
pub use device::device_handle::{Device, WorkCounts};
pub use engine::{ENGINE, GpuEngine};
pub use frame::draw::draw;
pub use frame::in_flight::{PendingFrame, SubmittedFrame, begin};
pub use frame::limits::can_serve;
pub use frame::output::{FaceOrderReport, FrameCounts, FrameOutput, OrderCheckReport};
pub use frame::renderer::Renderer;
