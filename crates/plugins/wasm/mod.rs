//! The interface of `include/voltet_plugin.h` in a sandbox: WebAssembly modules of 32-bit addresses. They see the memory that
//! they are given and the functions of the host, and nothing else: no files, no network, no clock. Each call is a module anew.
//!
//! | file | what |
//! | --- | --- |
//! | `layout` | structs of the header as a module lays them out |
//! | `guest` | the memory of a module, read and written within its bounds |
//! | `sandbox` | a module compiled, started, stopped |
//! | `declared` | what it declares, read for `describe` |
//! | `filter` | its filters |

mod declared;
mod filter;
mod guest;
mod layout;
mod sandbox;

use crate::library::{failed, file_name, state_of};
use crate::runner::{Offered, Runner};
use filter::Sandboxed;
use sandbox::Sandbox;
use std::path::Path;
use std::sync::Arc;
use voltet_core::Result;
use voltet_core::field::Plugin;

/// The gradient filters of a module.
///
/// Errors: no module, not of the interface, or what it declares is wrong.
pub(crate) fn load(path: &Path) -> Result<Vec<Offered>> {
    let (stated, bytes) = state_of(path)?;
    let nameless = Plugin { name: file_name(path), ..stated };
    let sandbox = Sandbox::new(&bytes).map_err(|wrong| failed(path, wrong))?;
    let ([name, version], filters) = declared::read(&sandbox).map_err(|wrong| failed(path, wrong))?;
    let plugin = Plugin { name, version, ..nameless };
    let runner: Arc<dyn Runner> = Arc::new(Sandboxed::new(sandbox, plugin, &filters));
    Ok(filters.into_iter().map(|declared| Offered { runner: runner.clone(), declared }).collect())
}
