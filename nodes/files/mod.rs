//! Files: what nodes that write one share, and the crate `voltet-files`.

pub mod output;

pub use voltet_files::*;
