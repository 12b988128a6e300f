//! The plug-ins that a command loads: those of its options, and those of the user's own file.

use crate::arguments::Plugins;
use crate::core::field::Plugin;
use crate::core::graph::{Node, Registry};
use crate::core::{Error, Result};
use crate::nodes::{added, files};
use crate::present::{say, warning};
use std::path::{Path, PathBuf};
use voltet_plugins::Contents;

/// The file in the user's configuration folder.
const FILE: &str = "plugins.toml";

/// The registry with what the plug-ins offer; `own_file`: those of the user's own file as well. One of the user's file that cannot be loaded is warned of: the pipeline may
/// have no use for it.
///
/// Errors: one that an option names cannot be loaded; the user's file is wrong; two filters of one name.
pub fn with(mut registry: Registry, wanted: &Plugins, own_file: bool) -> Result<Registry> {
    let file = files::configuration_folder().join(FILE);
    let configured = if own_file { voltet_plugins::configured(&file)? } else { Vec::new() };
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

/// The registry with what one more plug-in offers, and what is said of it.
fn add(registry: &Registry, path: &Path, apart: bool) -> Result<(Registry, String)> {
    let contents = match apart {
        true => voltet_plugins::load_apart(path, own_program()?)?,
        false => voltet_plugins::load(path)?,
    };
    let mut registry = registry.clone();
    let in_file = |error: Error| error.in_file(path);
    for filter in &contents.filters {
        registry.add_filter(filter.clone()).map_err(in_file)?;
    }
    let readers = contents.readers.iter().map(|reader| added::reader(*reader));
    let nodes: Vec<&'static Node> = readers.chain(contents.nodes.iter().copied()).collect();
    nodes.iter().try_for_each(|node| registry.add(node)).map_err(in_file)?;
    Ok((registry, told(&contents, &nodes)))
}

/// The file of this program.
fn own_program() -> Result<PathBuf> {
    std::env::current_exe().map_err(|error| {
        Error::run("the program does not find its own file, which --plugin-process starts").found(error)
    })
}

/// "plug-in 'name' (path) with a, b".
fn told(contents: &Contents, nodes: &[&Node]) -> String {
    let plugin = contents.plugin.as_ref().map(Plugin::to_string).unwrap_or_default();
    let filters = contents.filters.iter().map(|filter| filter.declaration().name);
    let names: Vec<&str> = filters.chain(nodes.iter().map(|node| node.name)).collect();
    format!("{plugin} with {}", names.join(", "))
}
