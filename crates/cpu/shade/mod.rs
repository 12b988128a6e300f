//! Shade: from a segment's length and the values at its ends to its colour and opacity.
//!
//! | file | responsibility |
//! | --- | --- |
//! | `shader` | kernels of a scene |
//! | `dispatch` | kernels of a batch, one after the other |
//! | `integrator` | integrators from outside |
//! | `closed_form` | closed-form kernels |
//! | `fixed_quadrature` | ordered widgets, in equal steps |
//! | `panels` | ordered widgets, in panels |
//! | `kinds` | widgets in lanes |
//! | `support` | support bounds of widgets |
//! | `region` | segments inside a region |
//! | `light` | silhouettes and light |
//! | `kernel` | kernels over batches |
//! | `segment_lanes`, `segment_gather` | segments in lanes |
//! | `shaded_batch` | results of a batch |
//! | `context` | scene of a shader and its widgets |

mod closed_form;
mod context;
pub(crate) mod dispatch;
mod fixed_quadrature;
pub mod integrator;
mod kernel;
mod kinds;
pub(crate) mod light;
mod panels;
mod region;
mod segment_gather;
mod segment_lanes;
pub(crate) mod shaded_batch;
pub(crate) mod shader;
mod support;
#[cfg(test)]
mod support_tests;

pub(crate) use context::ShaderContext;
