//! voltet-nodes: one file a node.

pub mod formats;
