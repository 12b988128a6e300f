//! Measurements of a device: its peak, its compositors, the operations of a shader, and segments alone for judging.

pub(crate) mod compositors;
pub(crate) mod operations;
pub(crate) mod peak;
pub(crate) mod segments;
