//! A frame: a scene's inputs on the device, its windows, and the passes over each.

pub(crate) mod draw;
pub(crate) mod inputs;
pub(crate) mod output;
pub(crate) mod passes;
pub(crate) mod renderer;
