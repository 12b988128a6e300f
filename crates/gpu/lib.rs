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
pub use device::open::{Device, Work};
pub use engine::{ENGINE, OnDevice};
pub use frame::checked::Checked;
pub use frame::draw::draw;
pub use frame::drawn::{AlongFaces, Counts, Drawn};
pub use frame::flight::{Begun, InFlight, begin};
pub use frame::limits::can_serve;
pub use frame::renderer::Renderer;
