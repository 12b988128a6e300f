//! voltet-plugins: gradient filters from shared libraries, by the interface of `include/voltet_plugin.h`.
//!
//! A library is loaded by the user's word alone: [`load`] is called for what the command line or the user's own configuration
//! file names ([`Configured`]), never for what a pipeline file says. Its filters are then as any other. What it declares and what it gives is
//! checked, and every message names the plug-in, its file and the filter.
//!
//! | file | what |
//! | --- | --- |
//! | `interface` | the structs of the header |
//! | `foreign` | reading what a plug-in points to |
//! | `image` | whether a file can be a library at all |
//! | `library` | loading, and the entry |
//! | `describe` | declarations, read and checked |
//! | `values` | what the parameters are set to |
//! | `host` | what the host does for a plug-in |
//! | `apart` | work on a thread of its own, which can be given up |
//! | `work` | a call of a filter |
//! | `outcome` | what comes back, judged |
//! | `native` | a filter, run in this process |
//! | `module`, `wasm` | WebAssembly modules, run in a sandbox |
//! | `configured` | the user's own file of plug-ins |
//! | `process` | filters in a process of their own |
//! | `crash` | whose crash it was |

mod apart;
mod configured;
mod crash;
mod describe;
mod foreign;
mod host;
mod image;
mod interface;
#[cfg(test)]
mod interface_tests;
mod library;
mod module;
mod native;
mod outcome;
mod process;
mod values;
#[cfg(feature = "wasm")]
mod wasm;
mod work;

pub use configured::{Configured, configured};
pub use process::serve;

use std::path::{Path, PathBuf};
use std::sync::Arc;
use voltet_core::Result;
use voltet_core::field::GradientFilter;

/// The gradient filters of the library at `path`, which runs in this process, or of a WebAssembly module, which runs in a
/// sandbox (feature `wasm`). Load a file once.
///
/// Errors: the file is no library that can be loaded, or not of this interface, or what it declares is wrong.
pub fn load(path: &Path) -> Result<Vec<Arc<dyn GradientFilter>>> {
    if module::is_module(path) {
        return module::load(path);
    }
    let (library, filters) = library::load(path)?;
    let library = Arc::new(library);
    Ok(filters
        .into_iter()
        .map(|filter| Arc::new(native::Native::new(library.clone(), filter)) as _)
        .collect())
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
pub fn load_apart(path: &Path, program: PathBuf) -> Result<Vec<Arc<dyn GradientFilter>>> {
    // A sandbox needs no process.
    if module::is_module(path) {
        return module::load(path);
    }
    process::load(path, program)
}
