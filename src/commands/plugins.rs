//! The plug-ins that a command loads: those of its options, and those of the user's own file.

use crate::arguments::Plugins;
use crate::core::field::{GradientFilter, Plugin};
use crate::core::graph::Registry;
use crate::core::{Error, Result};
use crate::nodes::files;
use crate::present::{say, warning};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The file in the user's configuration folder.
const FILE: &str = "plugins.toml";

/// The registry with the filters of the plug-ins. One of the user's file that cannot be loaded is warned of: the pipeline may
/// have no use for it.
///
/// Errors: one that an option names cannot be loaded; the user's file is wrong; two filters of one name.
pub fn with(mut registry: Registry, wanted: &Plugins) -> Result<Registry> {
    let file = files::configuration_folder().join(FILE);
    let configured = voltet_plugins::configured(&file)?;
    let mut told = Vec::new();
    let mut loaded: Vec<PathBuf> = Vec::new();
    let options = wanted.plugin_files.iter().map(|path| (path, None, true));
    let own = configured.iter().map(|own| (&own.path, own.fingerprint.as_deref(), false));
    for (path, fingerprint, is_option) in options.chain(own) {
        let whole = std::fs::canonicalize(path).unwrap_or_else(|_| path.clone());
        if loaded.contains(&whole) {
            continue;
        }
        loaded.push(whole);
        let added = kept_to(path, fingerprint).and_then(|()| add(&registry, path, wanted.plugin_process));
        match added {
            Ok((more, plugin)) => {
                registry = more;
                told.push(plugin);
            }
            Err(error) if is_option => return Err(error),
            Err(error) => {
                say(&warning(&error, None));
                told.push(format!("'{}', named by {}, cannot be loaded", path.display(), file.display()));
            }
        }
    }
    registry.tell_plugins(match told.is_empty() {
        true => format!("no plug-in is loaded: --plugin PATH does, and {}", file.display()),
        false => format!("of the plug-ins: {}", told.join("; ")),
    });
    Ok(registry)
}

/// Errors: the library is not the one that the user's file says.
fn kept_to(path: &Path, fingerprint: Option<&str>) -> Result<()> {
    let Some(wanted) = fingerprint else { return Ok(()) };
    let found = voltet_plugins::fingerprint(path)?;
    match found == wanted {
        true => Ok(()),
        false => {
            let error = Error::usage("the plug-in is not the one that is wanted: its file has changed");
            Err(error.found(found).accepted(wanted).in_file(path))
        }
    }
}

/// The registry with the filters of one more plug-in, and what is said of it.
fn add(registry: &Registry, path: &Path, apart: bool) -> Result<(Registry, String)> {
    let filters = match apart {
        true => voltet_plugins::load_apart(path, own_program()?)?,
        false => voltet_plugins::load(path)?,
    };
    let mut registry = registry.clone();
    for filter in &filters {
        registry.add_filter(filter.clone()).map_err(|error| error.in_file(path))?;
    }
    Ok((registry, told(&filters)))
}

/// The file of this program.
fn own_program() -> Result<PathBuf> {
    std::env::current_exe().map_err(|error| {
        Error::run("the program does not find its own file, which --plugin-process starts").found(error)
    })
}

/// "plug-in 'name' (path) with a, b".
fn told(filters: &[Arc<dyn GradientFilter>]) -> String {
    let plugin: Option<&Plugin> = filters.first().and_then(|filter| filter.plugin());
    let names: Vec<&str> = filters.iter().map(|filter| filter.declaration().name).collect();
    format!("{} with {}", plugin.map(Plugin::to_string).unwrap_or_default(), names.join(", "))
}
