//! Projection: cells to planes in screen space, binned by tiles.

pub(crate) mod cells;
pub(crate) mod edge_on;
pub(crate) mod precise_cell;
pub(crate) mod regions;
#[cfg(test)]
mod regions_tests;
pub(crate) mod tile_bins;
