//! The plug-ins that a command loads: those of its options, and those of the user's own file.

use crate::cli::arguments::Plugins;
use crate::cli::present::{Level, say, shown};
use crate::cli::process::own_program;
use crate::core::field::Plugin;
use crate::core::{Error, Result};
use crate::graph::{Node, Registry};
use crate::nodes::{external_formats, files};
use std::path::{Path, PathBuf};
use voltet_plugins::{Configured, Contents, PluginFile};

/// The file in the user's configuration folder.
const FILE: &str = "plugins.toml";

/// The registry with what the plug-ins offer. Those of the user's own file come where the command asks for more than is known
/// without them (`serves`); one of these that cannot be loaded is warned of: the pipeline may
/// have no use for it.
///
/// Errors: one that an option names cannot be loaded; the user's file is wrong; two filters of one name.
pub fn with(
    mut registry: Registry,
    wanted: &Plugins,
    serves: impl FnOnce(&Registry) -> bool,
) -> Result<Registry> {
    let (mut told, mut loaded) = (Vec::new(), Vec::new());
    let new = wanted.plugin_files.iter().filter(|path| is_new(&mut loaded, path));
    let named = new.map(|path| PluginFile::read(path)).collect::<Result<Vec<PluginFile>>>()?;
    let file = files::configuration_folder().map(|folder| folder.join(FILE));
    // A sandbox has threads, and a program with threads can no more be supervised: what may follow it counts.
    let may_follow = || {
        let read =
            |file| voltet_plugins::configured(file, files::home_folder().as_deref()).unwrap_or_default();
        let configured: Vec<Configured> = file.as_deref().map(read).unwrap_or_default();
        configured.iter().any(|own| PluginFile::read(&own.path).is_ok_and(|file| is_library(&file)))
    };
    let admits =
        !wanted.plugin_process && (named.iter().any(is_library) || !named.is_empty() && may_follow());
    if admits {
        admit_foreign_code()?;
    }
    for file in &named {
        warn_of(file);
        let (more, plugin) = add(&registry, file, None, wanted.plugin_process)?;
        registry = more;
        told.push(plugin);
    }
    let configured = match &file {
        Some(file) if !serves(&registry) => {
            voltet_plugins::configured(file, files::home_folder().as_deref())?
        }
        _ => Vec::new(),
    };
    let new = configured.iter().filter(|own| is_new(&mut loaded, &own.path));
    let own: Vec<(&Configured, Result<PluginFile>)> =
        new.map(|own| (own, PluginFile::read(&own.path))).collect();
    let may_admit = !admits && !wanted.plugin_process;
    if may_admit && own.iter().any(|(_, read)| read.as_ref().is_ok_and(is_library)) {
        admit_foreign_code()?;
    }
    for (own, read) in own {
        let added = read.and_then(|file| {
            warn_of(&file);
            add(&registry, &file, own.fingerprint.as_deref(), wanted.plugin_process)
        });
        match added {
            Ok((more, plugin)) => {
                registry = more;
                told.push(plugin);
            }
            Err(error) => {
                say(&shown(&error, None, Level::WARNING));
                let (path, file) = (own.path.display(), file.as_deref().unwrap_or(Path::new(FILE)).display());
                told.push(format!("'{path}', named by {file}, cannot be loaded"));
            }
        }
    }
    registry.tell_plugins(match (told.is_empty(), file) {
        (true, Some(file)) => format!("no plug-in is loaded: --plugin PATH does, and {}", file.display()),
        (true, None) => "no plug-in is loaded: --plugin PATH does".into(),
        (false, _) => format!("{TOLD}{}", told.join("; ")),
    });
    Ok(registry)
}

/// Beginning of the clause that names the plug-ins.
const TOLD: &str = "of the plug-ins: ";

/// The registry with a plug-in that was dropped on a window, and words for it, with a reason to distrust its file where there is one.
/// It runs in processes of its own, as by `--plugin-process`: the window has threads, which no supervisor can follow, and work that is
/// not saved.
///
/// Errors: it is loaded already, or cannot be loaded; two filters of one name.
#[cfg(feature = "editor")]
pub fn with_dropped(registry: &Registry, path: &Path) -> Result<(Registry, String)> {
    let file = PluginFile::read(path)?;
    refuse_loaded(registry, &file)?;
    let (mut more, words) = add(registry, &file, None, true)?;
    let others = registry.told_plugins().filter(|told| told.starts_with(TOLD));
    more.tell_plugins(others.map_or_else(|| format!("{TOLD}{words}"), |others| format!("{others}; {words}")));
    Ok((more, [Some(words), file.warning()].into_iter().flatten().collect::<Vec<_>>().join("; ")))
}

/// Errors: the file is loaded already, as it is now or as it was.
#[cfg(feature = "editor")]
fn refuse_loaded(registry: &Registry, file: &PluginFile) -> Result<()> {
    let own = whole(file.path());
    let of_filters = registry.filters().filter_map(|filter| filter.plugin());
    let mut loaded = registry.iter().filter_map(|node| node.plugin).chain(of_filters);
    let Some(known) = loaded.find(|known| whole(&known.path) == own) else { return Ok(()) };
    let error = Error::usage("the plug-in is loaded already").in_file(file.path());
    Err(match known.fingerprint_text() == file.fingerprint() {
        true => error,
        false => {
            error.got("a file that has changed since").expected("another window, which loads it as it is")
        }
    })
}

/// The absolute path of a file, which links lead to as well.
fn whole(path: &Path) -> PathBuf {
    std::fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf())
}

/// True if a library was not loaded yet; it counts as loaded from then on.
fn is_new(loaded: &mut Vec<PathBuf>, path: &Path) -> bool {
    let whole = whole(path);
    let is_new = !loaded.contains(&whole);
    loaded.push(whole);
    is_new
}

/// Errors: the library is not the one that the user's file says.
fn refuse_another(file: &PluginFile, wanted: Option<&str>) -> Result<()> {
    let found = file.fingerprint();
    match wanted.is_none_or(|wanted| wanted == found) {
        true => Ok(()),
        false => {
            let error = Error::usage("the plug-in is not the one that is wanted: its file has changed");
            Err(error.got(found).expected(wanted.unwrap_or_default()).in_file(file.path()))
        }
    }
}

/// True if it is code that runs without a sandbox.
fn is_library(file: &PluginFile) -> bool {
    !file.is_module()
}

/// Prepares this process for code of others: prints of it go to the standard error, and an end of it is not taken for the program's.
/// Where it cannot be told from that, it is warned of.
fn admit_foreign_code() -> Result<()> {
    files::take_standard_output().map_err(|error| files::unwritable_output(&error))?;
    if let Err(found) = voltet_plugins::supervise() {
        let warning =
            Error::usage("nothing supervises the plug-ins: one that ends the program may go unnoticed");
        let warning =
            warning.got(found).expected("--plugin-process, which runs them in processes of their own");
        say(&shown(&warning, None, Level::WARNING));
    }
    Ok(())
}

/// Warns of a file that every user may change.
fn warn_of(file: &PluginFile) {
    if let Some(warning) = file.warning() {
        say(&shown(&Error::usage(warning), None, Level::WARNING));
    }
}

/// The registry with what one more plug-in offers, and what is said of it.
fn add(
    registry: &Registry,
    file: &PluginFile,
    fingerprint: Option<&str>,
    apart: bool,
) -> Result<(Registry, String)> {
    refuse_another(file, fingerprint)?;
    let contents = match apart {
        true => voltet_plugins::load_apart(file, own_program()?)?,
        false => voltet_plugins::load_file(file)?,
    };
    let mut registry = registry.clone();
    let in_file = |error: Error| error.in_file(file.path());
    for filter in &contents.filters {
        registry.add_filter(filter.clone()).map_err(in_file)?;
    }
    let readers = contents.readers.iter().map(|reader| external_formats::reader(*reader));
    let nodes: Vec<&'static Node> = readers.chain(contents.nodes.iter().copied()).collect();
    nodes.iter().try_for_each(|node| registry.add(node)).map_err(in_file)?;
    Ok((registry, describe(&contents, &nodes)))
}

/// "plug-in 'name' (path) with a, b".
fn describe(contents: &Contents, nodes: &[&Node]) -> String {
    let plugin = contents.plugin.as_ref().map(Plugin::to_string).unwrap_or_default();
    let filters = contents.filters.iter().map(|filter| filter.declaration().name);
    let names: Vec<&str> = filters.chain(nodes.iter().map(|node| node.name)).collect();
    format!("{plugin} with {}", names.join(", "))
}

#[cfg(all(test, feature = "editor"))]
mod tests {
    use super::*;
    use crate::core::field::fingerprint;
    use std::time::SystemTime;

    #[test]
    fn a_plug_in_that_is_loaded_is_said_to_be_however_its_path_is_written() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("filter.so");
        let (name, version, modified) = ("own".to_string(), "1".to_string(), None::<SystemTime>);
        let loaded = Plugin {
            name,
            version,
            path: path.clone(),
            bytes: 3,
            fingerprint: fingerprint(b"old"),
            modified,
        };
        let of_plugin = Node {
            name: "of-plug-in",
            summary: "A node.",
            plugin: Some(Box::leak(Box::new(loaded))),
            ..Node::BLANK
        };
        let mut registry = Registry::new();
        registry.add(Box::leak(Box::new(of_plugin))).unwrap();
        let found = |content: &str, path: &Path| {
            std::fs::write(path, content).unwrap();
            with_dropped(&registry, path).map(drop).unwrap_err().to_string()
        };
        let other_way = folder.path().join(".").join("filter.so");
        assert!(
            found("old", &other_way).starts_with("the plug-in is loaded already ("),
            "{}",
            found("old", &other_way)
        );
        let changed = found("new", &path);
        assert!(
            changed.starts_with("the plug-in is loaded already: found a file that has changed"),
            "{changed}"
        );
        let other = found("old", &folder.path().join("other.so"));
        assert!(!other.contains("already"), "{other}");
    }
}
