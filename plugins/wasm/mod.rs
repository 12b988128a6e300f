//! The interface of `include/voltet_plugin.h` in a sandbox: WebAssembly modules of 32-bit addresses. They see the memory that
//! they are given and the functions of the host, and nothing else: no files, no network, no clock. Each call is a module anew.
//!
//! | file | what |
//! | --- | --- |
//! | `layout` | structs of the header as a module lays them out |
//! | `guest` | the memory of a module, read and written within its bounds |
//! | `sandbox` | a module compiled, started, stopped |
//! | `declared` | what it declares, read for `describe` |
//! | `filter` | a filter of it |

mod declared;
mod filter;
mod guest;
mod layout;
mod sandbox;

use crate::library::{failed, file_name, state_of};
use filter::Sandboxed;
use sandbox::Sandbox;
use std::path::Path;
use std::sync::Arc;
use voltet_core::Result;
use voltet_core::field::{GradientFilter, Plugin};

/// The gradient filters of a module.
///
/// Errors: no module, not of the interface, or what it declares is wrong.
pub(crate) fn load(path: &Path) -> Result<Vec<Arc<dyn GradientFilter>>> {
    let (stated, bytes) = state_of(path)?;
    let nameless = Plugin { name: file_name(path), ..stated };
    let sandbox = Arc::new(Sandbox::new(&bytes).map_err(|wrong| failed(path, wrong))?);
    let (names, filters) = declared::read(&sandbox).map_err(|wrong| failed(path, wrong))?;
    let [name, version] = names;
    let plugin = Arc::new(Plugin { name, version, ..nameless });
    let filters = filters.into_iter().enumerate();
    let filter = |(place, declared)| {
        Arc::new(Sandboxed::new(sandbox.clone(), plugin.clone(), place as u32, declared))
            as Arc<dyn GradientFilter>
    };
    Ok(filters.map(filter).collect())
}
