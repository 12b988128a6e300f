//! Compositor: a tile's segments in visibility order, or their sum, to its pixels.
//!
//! | file | responsibility |
//! | --- | --- |
//! | `frame` | read-only inputs of workers |
//! | `worker` | queue of tiles or regions |
//! | `tile`, `scratch` | one tile to pixels |
//! | `projected_cells` | a tile's cells to segments |
//! | `kernels` | kernels compiled once a lane set |
//! | `fragment_lists` | A-buffer: sorted segments of pixels |
//! | `unbounded_lists` | lists of any length |
//! | `row_shader` | a row shaded front to back |
//! | `deferred_fragments`, `deferred_shading` | segments that need slower kernels |
//! | `accumulators` | colour and opacity of pixels |
//! | `sinks` | segments shaded without lists |
//! | `buffers` | buffers used again |

pub(crate) mod accumulators;
pub(crate) mod buffers;
pub(crate) mod deferred_fragments;
pub(crate) mod deferred_shading;
pub(crate) mod fragment_lists;
#[cfg(test)]
mod fragment_lists_tests;
pub(crate) mod frame;
pub(crate) mod kernels;
pub(crate) mod projected_cells;
pub(crate) mod row_shader;
pub(crate) mod scratch;
pub(crate) mod sinks;
mod tile;
pub(crate) mod unbounded_lists;
pub(crate) mod worker;
