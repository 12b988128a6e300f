//! Fragments: the pixels that each cell of a tile covers, and the segments of their rays in it.
//!
//! | file | responsibility |
//! | --- | --- |
//! | `batch` | columns of a batch of segments |
//! | `spans` | pixels that cells cover |
//! | `slots` | slots of the tile's fragment lists |
//! | `crossing` | intersection of rays with cells |
//! | `depth_limit` | segments clipped at opaque surfaces |

pub(crate) mod batch;
pub(crate) mod crossing;
pub(crate) mod depth_limit;
pub(crate) mod slots;
pub(crate) mod spans;
#[cfg(test)]
mod spans_tests;
