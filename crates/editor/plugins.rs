//! Plug-ins that are dropped on the window.

use crate::jobs::Job;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use voltet_core::Result;
use voltet_graph::Registry;

/// Loads a plug-in; gives all node types and filters then, and words for the plug-in. Errors: those of `--plugin`.
pub type LoadPlugin = Arc<dyn Fn(&Path) -> Result<(Registry, String)> + Send + Sync>;

/// Plug-ins that are dropped on the window.
#[derive(Default)]
pub(crate) struct Plugins {
    /// Function that loads them, where the program has one.
    pub load: Option<LoadPlugin>,
    /// Files that are asked about, one after the other: no code of them has run.
    pub offered: Vec<PathBuf>,
    /// The load that is going on. There is one at a time: each begins with what those before it brought.
    pub loading: Option<Job<(Registry, String)>>,
}
