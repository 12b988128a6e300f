//! The interface of `include/voltet_plugin.h` in a sandbox: WebAssembly modules of 32-bit addresses. They see
//! their inputs and the functions of the host, and nothing else: no files, no network, no clock. Each call starts a fresh module.
//!
//! | file | responsibility |
//! | --- | --- |
//! | `layout` | structs of the header in a module |
//! | `guest` | bounded access to a module's memory |
//! | `sandbox` | compiling, starting, stopping a module |
//! | `declared` | its declarations |
//! | `filter` | the runner of its filters |

mod declared;
mod filter;
mod guest;
mod layout;
mod sandbox;

use crate::library::{file_name, load_error, read_file};
use crate::runner::PluginItem;
use filter::SandboxRunner;
use sandbox::Sandbox;
use std::path::Path;
use std::sync::Arc;
use voltet_core::Result;
use voltet_core::field::Plugin;

/// The gradient filters of a module.
///
/// Errors: no module, not of the interface, or what it declares is wrong.
pub(crate) fn load(path: &Path) -> Result<Vec<PluginItem>> {
    let (plugin, bytes) = read_file(path)?;
    let nameless = Plugin { name: file_name(path), ..plugin };
    let sandbox = Sandbox::new(&bytes).map_err(|wrong| load_error(path, wrong))?;
    let ([name, version], declarations) =
        declared::read(&sandbox).map_err(|wrong| load_error(path, wrong))?;
    let plugin = Plugin { name, version, ..nameless };
    let runner = Arc::new(SandboxRunner::new(sandbox, plugin, &declarations));
    Ok(PluginItem::list(runner, declarations))
}
