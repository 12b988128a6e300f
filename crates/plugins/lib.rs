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
//! | `wire` | messages between processes |
//! | `ffi` | memory shared with a plug-in: bounded reads, buffers that show unwritten numbers |
//! | `host` | functions that a plug-in calls |
//! | `declaration` | declarations, read and checked |
//! | `status` | return code and messages |
//! | `values` | parameters and arrays of a call |
//! | `grids` | grids that plug-ins give |
//! | `task` | one call: inputs, outputs |
//! | `runner` | runner of calls; an item and its node |
//! | `gradient_filter`, `reader`, `grid_filter`, `image_filter` | the families: task, adapter |
//! | `crash`, `watchdog` | guards of loading and calling |
//! | `library` | libraries in this process |
//! | `process` | libraries in a process of their own |
//! | `wasm` | modules in a sandbox |
//! | `configured` | the user's file of plug-ins |

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
mod process;
mod reader;
mod runner;
mod status;
mod task;
mod values;
#[cfg(feature = "wasm")]
mod wasm;
mod watchdog;
mod wire;

pub use configured::{Configured, configured};
pub use process::run_child;

use crate::declaration::{Declaration, Family};
use crate::library::Native;
use crate::runner::PluginItem;
use std::fs::File;
use std::io::Read;
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
    /// Readers; `voltet_nodes::external_formats::reader` makes nodes of them.
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
    if is_module(path) {
        return load_module(path).map(contents);
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
    if is_module(path) {
        return load_module(path).map(contents);
    }
    process::load(path, program).map(contents)
}

fn contents(items: Vec<PluginItem>) -> Contents {
    let mut contents = Contents::default();
    for item in items {
        contents.plugin.get_or_insert_with(|| item.runner.plugin().clone());
        match item.declaration.family {
            Family::GradientFilter { .. } => contents.filters.push(Arc::new(item)),
            Family::Reader { .. } => contents.readers.push(runner::leak(item)),
            Family::GridFilter { .. } => contents.nodes.push(grid_filter::grid_node(item)),
            Family::ImageFilter => contents.nodes.push(image_filter::image_node(item)),
        }
    }
    contents
}

/// First bytes of a WebAssembly module.
const MODULE_MAGIC: [u8; 4] = *b"\0asm";

/// True if the file begins as a WebAssembly module.
fn is_module(path: &Path) -> bool {
    let mut begin = [0; 4];
    let read = File::open(path).and_then(|mut file| file.read_exact(&mut begin));
    read.is_ok() && begin == MODULE_MAGIC
}

#[cfg(feature = "wasm")]
use wasm::load as load_module;

/// Errors: always; this build has no sandbox.
#[cfg(not(feature = "wasm"))]
fn load_module(path: &Path) -> Result<Vec<PluginItem>> {
    let error = voltet_core::Error::usage(
        "the plug-in is a WebAssembly module, and this program was built without the sandbox for them",
    );
    Err(error.expected("a build with the feature \"wasm\", or a shared library").in_file(path))
}
