//! Checks entries against the registry and wires them to a graph.

pub(crate) mod diagnostic;
pub(crate) mod entry;
pub(crate) mod graph;
mod method;
pub(crate) mod node_override;
pub(crate) mod registry;
mod wiring;
