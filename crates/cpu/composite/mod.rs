//! Compositor: a tile's segments in visibility order, or their sum, to its pixels.

pub(crate) mod accumulators;
mod deferred_shading;
pub(crate) mod fragment_lists;
#[cfg(test)]
mod fragment_lists_tests;
pub(crate) mod frame;
mod illumination;
pub(crate) mod lane_axes;
pub(crate) mod projected_cells;
pub(crate) mod row_shader;
pub(crate) mod segment_parts;
mod straight_pieces;
pub(crate) mod stretches;
#[cfg(test)]
mod stretches_tests;
mod tile;
pub(crate) mod worker;
