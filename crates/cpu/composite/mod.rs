//! Composite: a tile's segments in their order, or their sum, to its pixels.
//!
//! | file | what |
//! | --- | --- |
//! | `worker` | takes tiles, or windows of a large grid, until none is left |
//! | `tile`, `scratch` | one tile to pixels, and what it is drawn with |
//! | `cells` | a tile's cells to segments |
//! | `kernels` | what runs on vector lanes, once a lane set |
//! | `lists` | up to 1,024 segments a pixel, put in order in lanes |
//! | `front_to_back` | a row's segments in order, shaded and blended as far as they are seen |
//! | `rows` | pixels that take their segments front to back |
//! | `layers`, `pool` | segments of a row that wait until there are enough of their kind |
//! | `sinks` | where segments go that are shaded as they come: sums of optical depth, or |
//! | `growing_lists` | any number of segments a pixel |

mod cells;
pub(crate) mod front_to_back;
pub(crate) mod growing_lists;
pub(crate) mod kernels;
pub(crate) mod layers;
pub(crate) mod lists;
#[cfg(test)]
mod lists_tests;
pub(crate) mod pool;
pub(crate) mod rows;
pub(crate) mod scratch;
pub(crate) mod sinks;
mod tile;
pub(crate) mod worker;
