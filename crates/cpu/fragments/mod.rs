//! Fragments: the pixels that each cell of a tile covers, and the segments of their rays in it.

pub(crate) mod batch;
pub(crate) mod crossing;
pub(crate) mod spans;
#[cfg(test)]
mod spans_tests;
