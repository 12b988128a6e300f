//! Checks entries against the registry and wires them to a graph.

pub(crate) mod entry;
pub(crate) mod graph;
mod method;
pub(crate) mod registry;
