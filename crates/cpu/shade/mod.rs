//! Shade: from a segment's length and the values at its ends to its colour and opacity.

mod context;
mod fixed_quadrature;
pub mod integrator;
mod kernel;
mod kinds;
pub(crate) mod light;
mod panels;
mod region;
mod segment_lanes;
pub(crate) mod shaded_batch;
pub(crate) mod shader;
#[cfg(test)]
mod support_tests;

pub(crate) use context::ShaderContext;
