//! A frame: what a scene asks of the device, its windows, and the passes over each.

pub(crate) mod draw;
pub(crate) mod limits;
pub(crate) mod passes;
pub(crate) mod support;
pub(crate) mod view;
pub(crate) mod windows;
