//! voltet-plugins: gradient filters, readers, grid filters and image filters from shared libraries, by the interface of `include/voltet_plugin.h`.
//!
//! A library is loaded by the user's word alone: [`load`] is called for what the command line or the user's own configuration
//! file names ([`Configured`]), never for what a pipeline file says. What it offers is then as what ships. What it declares and what it gives is
//! checked, and every message names the plug-in, its file and the filter.
//!
//! | file | what |
//! | --- | --- |
//! | `interface` | the structs of the header |
//! | `foreign` | reading what a plug-in points to |
//! | `image` | whether a file can be a library at all |
//! | `library` | loading, and the entry |
//! | `describe`, `parameters` | declarations, read and checked |
//! | `values` | what the parameters are set to |
//! | `host` | what the host does for a plug-in |
//! | `apart` | work on a thread of its own, which can be given up |
//! | `runner` | a filter of a plug-in, whoever runs it |
//! | `task` | what is asked of it, and what comes of that |
//! | `work` | a call of a gradient filter |
//! | `grids` | grids that plug-ins give: sizes, memory, what is wrong with them |
//! | `reader`, `grid_filter`, `image_filter` | a call of each, and what it is to the program |
//! | `resulting` | the grid that a grid filter makes |
//! | `node` | what the nodes of filters share |
//! | `outcome` | what comes back, judged |
//! | `native` | its functions, run in this process |
//! | `module`, `wasm` | WebAssembly modules, run in a sandbox |
//! | `configured` | the user's own file of plug-ins |
//! | `process` | functions run in a process of their own |
//! | `crash` | whose crash it was |

mod apart;
mod configured;
mod crash;
mod describe;
mod foreign;
mod grid_filter;
mod grids;
mod host;
mod image;
mod image_filter;
mod interface;
#[cfg(test)]
mod interface_tests;
mod library;
mod module;
mod native;
mod node;
mod outcome;
mod parameters;
mod process;
mod reader;
mod resulting;
mod runner;
mod task;
mod values;
#[cfg(feature = "wasm")]
mod wasm;
mod work;

pub use configured::{Configured, configured};
pub use process::serve;

use describe::{Declared, Family};
use native::Native;
use runner::{Offered, Runner};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use voltet_core::Result;
use voltet_core::field::{GradientFilter, Plugin};
use voltet_core::reading::GridReader;
use voltet_graph::Node;

/// What a plug-in offers.
#[derive(Default)]
pub struct Contents {
    /// The plug-in.
    pub plugin: Option<Plugin>,
    /// Gradient filters.
    pub filters: Vec<Arc<dyn GradientFilter>>,
    /// Readers: `voltet_nodes::added::reader` makes nodes of them.
    pub readers: Vec<&'static dyn GridReader>,
    /// Grid filters and image filters.
    pub nodes: Vec<&'static Node>,
}

/// What the library at `path` offers, which runs in this process, or a WebAssembly module, which runs in a sandbox (feature
/// `wasm`). Load a file once: what is loaded stays.
///
/// Errors: the file is no library that can be loaded, or not of this interface, or what it declares is wrong.
pub fn load(path: &Path) -> Result<Contents> {
    if module::is_module(path) {
        return module::load(path).map(contents);
    }
    let (library, pieces) = library::load(path)?;
    let declared: Vec<Declared> = pieces.iter().map(|piece| piece.declared.clone()).collect();
    let runner: Arc<dyn Runner> = Arc::new(Native::new(library, pieces));
    let offered = |declared| Offered { runner: runner.clone(), declared };
    Ok(contents(declared.into_iter().map(offered).collect()))
}

/// A number made of all bytes of the file at `path`, as pictures say it.
///
/// Errors: it cannot be read.
pub fn fingerprint(path: &Path) -> Result<String> {
    library::state_of(path).map(|(plugin, _)| plugin.fingerprint_in_words())
}

/// The same as [`load`], but loaded and run in processes of `program`, which must call [`serve`] where its arguments are
/// `plugin-process PATH`: a crash of the plug-in ends those alone.
///
/// Errors: those of [`load`]; a process that crashes or cannot be started.
pub fn load_apart(path: &Path, program: PathBuf) -> Result<Contents> {
    // A sandbox needs no process.
    if module::is_module(path) {
        return module::load(path).map(contents);
    }
    process::load(path, program).map(contents)
}

fn contents(offered: Vec<Offered>) -> Contents {
    let mut contents = Contents::default();
    for offered in offered {
        contents.plugin.get_or_insert_with(|| offered.runner.plugin().clone());
        match offered.declared.family {
            Family::GradientFilter { .. } => contents.filters.push(Arc::new(offered)),
            Family::Reader { .. } => contents.readers.push(node::leak(offered)),
            Family::GridFilter { .. } => contents.nodes.push(grid_filter::node(offered)),
            Family::ImageFilter => contents.nodes.push(image_filter::node(offered)),
        }
    }
    contents
}
