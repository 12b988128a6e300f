//! A device: which adapter it is, what it holds, what is compiled for it, and what its passes take.

pub(crate) mod adapter;
pub(crate) mod buffers;
pub(crate) mod open;
pub(crate) mod pipelines;
pub(crate) mod timing;
