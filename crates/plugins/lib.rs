//! voltet-plugins: gradient filters, readers, grid filters and image filters from shared libraries, by the interface of `include/voltet_plugin.h`.
//!
//! A library is loaded only where the user names it: [`load`] is called for paths of the command line and of the user's configuration
//! file ([`Configured`]), never for those of a pipeline file. Its items then work like built-in ones. Declarations and outputs are
//! checked, and every message names the plug-in, its file and the item.
//!
//! A file uses those above it in this table only.
//!
//! | file | responsibility |
//! | --- | --- |
//! | `interface` | the structs of the header |
//! | `wire` | encoding of messages |
//! | `ffi`, `text` | bounded reads of a plug-in's memory |
//! | `sentinel` | buffers that show unwritten numbers |
//! | `host` | functions that a plug-in calls |
//! | `parameters`, `declaration` | declarations, read and checked |
//! | `status` | return code and messages |
//! | `values` | parameters and arrays of a call |
//! | `grids` | grids that plug-ins give |
//! | `task` | one call: inputs, outputs |
//! | `runner` | runner of calls; an item |
//! | `node` | shared parts of nodes |
//! | `gradient_filter`, `reader`, `grid_filter`, `image_filter` | the families: task, adapter |
//! | `binary`, `crash`, `watchdog` | guards of loading and calling |
//! | `library`, `native` | libraries in this process |
//! | `process` | libraries in a process of their own |
//! | `wasm_file`, `wasm` | modules in a sandbox |
//! | `configured` | the user's file of plug-ins |

mod binary;
mod configured;
mod crash;
mod declaration;
mod ffi;
mod gradient_filter;
mod grid_filter;
mod grids;
mod host;
mod image_filter;
mod interface;
#[cfg(test)]
mod interface_tests;
mod library;
mod native;
mod node;
mod parameters;
mod process;
mod reader;
mod runner;
mod sentinel;
mod status;
mod task;
mod text;
mod values;
#[cfg(feature = "wasm")]
mod wasm;
mod wasm_file;
mod watchdog;
mod wire;

pub use configured::{Configured, configured};
pub use process::run_child;

use declaration::{Declaration, Family};
use native::Native;
use runner::PluginItem;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use voltet_core::Result;
use voltet_core::field::{GradientFilter, Plugin};
use voltet_core::reading::GridReader;
use voltet_graph::Node;

/// Contents of a plug-in.
#[derive(Default)]
pub struct Contents {
    /// The plug-in.
    pub plugin: Option<Plugin>,
    /// Gradient filters.
    pub filters: Vec<Arc<dyn GradientFilter>>,
    /// Readers; `voltet_nodes::added::reader` makes nodes of them.
    pub readers: Vec<&'static dyn GridReader>,
    /// Grid filters and image filters.
    pub nodes: Vec<&'static Node>,
}

/// Contents of the library at `path`, which runs in this process, or of a WebAssembly module, which runs in a sandbox (feature
/// `wasm`). Load a file once: it stays in memory.
///
/// # Errors
///
/// - The file cannot be loaded, or is not of this interface.
/// - A declaration is invalid.
pub fn load(path: &Path) -> Result<Contents> {
    if wasm_file::is_module(path) {
        return wasm_file::load(path).map(contents);
    }
    let (library, items) = library::load(path)?;
    let declarations: Vec<Declaration> = items.iter().map(|item| item.declaration.clone()).collect();
    Ok(contents(PluginItem::list(Arc::new(Native::new(library, items)), declarations)))
}

/// Hash of the file at `path`, as pictures record it.
///
/// # Errors
///
/// - The file cannot be read.
pub fn fingerprint(path: &Path) -> Result<String> {
    library::read_file(path).map(|(plugin, _)| plugin.fingerprint_text())
}

/// Like [`load`], in processes of `program`, which must call [`run_child`] where its arguments are `plugin-process PATH`: a crash of
/// the plug-in ends such a process alone.
///
/// # Errors
///
/// - Those of [`load`].
/// - A process crashes or cannot be started.
pub fn load_apart(path: &Path, program: PathBuf) -> Result<Contents> {
    // A sandbox needs no process.
    if wasm_file::is_module(path) {
        return wasm_file::load(path).map(contents);
    }
    process::load(path, program).map(contents)
}

fn contents(items: Vec<PluginItem>) -> Contents {
    let mut contents = Contents::default();
    for item in items {
        contents.plugin.get_or_insert_with(|| item.runner.plugin().clone());
        match item.declaration.family {
            Family::GradientFilter { .. } => contents.filters.push(Arc::new(item)),
            Family::Reader { .. } => contents.readers.push(node::leak(item)),
            Family::GridFilter { .. } => contents.nodes.push(grid_filter::grid_node(item)),
            Family::ImageFilter => contents.nodes.push(image_filter::image_node(item)),
        }
    }
    contents
}
