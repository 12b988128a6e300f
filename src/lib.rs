//! The facade library.
pub use voltet_core as core;
pub use voltet_nodes as nodes;
