//! Projection: cells to planes in screen space, binned by tiles.
//!
//! | file | responsibility |
//! | --- | --- |
//! | `projected_cell` | planes of a cell |
//! | `pixel_bounds` | pixels that cells may cover |
//! | `edge`, `edge_on` | edges, and faces seen edge-on |
//! | `cells` | kernel of the projection |
//! | `precise_cell` | cells crossed in 64 bits |
//! | `tile_bins` | projected cells by tiles |
//! | `regions` | cells by screen regions |

pub(crate) mod cells;
pub(crate) mod edge;
pub(crate) mod edge_on;
pub(crate) mod pixel_bounds;
pub(crate) mod precise_cell;
pub(crate) mod projected_cell;
pub(crate) mod regions;
#[cfg(test)]
mod regions_tests;
pub(crate) mod tile_bins;
