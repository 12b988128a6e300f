//! Composite: a tile's segments in their order, or their sum, to its pixels.
//!
//! | file | what |
//! | --- | --- |
//! | `worker` | takes tiles and sends each one's cells through the kernels |
//! | `kernels` | what runs on vector lanes, once a lane set |
//! | `sinks` | where segments go: lists, or sums of optical depth |
//! | `lists` | up to 1,024 segments a pixel, sorted and composited in lanes |
//! | `growing_lists` | any number of segments a pixel |
//! | `hides` | whether much is hidden, told by the first tiles |
//! | `slabs` | cells from front to back, where much is hidden |
//! | `pool` | segments that wait in their list until there are enough of their kind |

pub(crate) mod growing_lists;
pub(crate) mod hides;
pub(crate) mod kernels;
pub(crate) mod lists;
#[cfg(test)]
mod lists_tests;
pub(crate) mod pool;
pub(crate) mod sinks;
pub(crate) mod slabs;
pub(crate) mod worker;
