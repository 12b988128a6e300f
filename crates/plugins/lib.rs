//! voltet-plugins: gradient filters, readers, grid filters and image filters from shared libraries, by the interface of `include/voltet_plugin.h`.
//!
//! A library is loaded only where the user names it: [`load`] is called for paths of the command line and of the user's configuration
//! file ([`Configured`]), never for those of a pipeline file. Its items then work like built-in ones. Declarations and outputs are
//! checked, and every message names the plug-in, its file and the item.

mod call;
mod declaration;
mod ffi;
mod file;
mod grid_filter;
mod grids;
mod guard;
mod host;
mod inputs;
mod interface;
#[cfg(test)]
mod interface_tests;
mod item;
mod library;
mod process;
#[cfg_attr(not(unix), allow(dead_code, reason = "nothing is announced there"))]
mod supervisor;
mod thread_state;
mod values;
#[cfg(feature = "wasm")]
mod wasm;
mod wire;

pub use file::PluginFile;
pub use process::run_child;
pub use supervisor::{EndRequest, last_work, state_exit, supervise, take_end_request};

use crate::declaration::Family;
use crate::item::PluginItem;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use toml::Value;
use voltet_core::field::{GradientFilter, Plugin};
use voltet_core::reading::GridReader;
use voltet_core::{Error, Result};
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
    load_file(&PluginFile::read(path)?)
}

/// Like [`load`], of a file that was read.
///
/// # Errors
///
/// - Those of [`load`].
pub fn load_file(file: &PluginFile) -> Result<Contents> {
    if file.is_module() {
        return load_module(file).map(contents);
    }
    let native = library::load(file)?;
    let declarations = native.declarations();
    Ok(contents(PluginItem::list(Arc::new(native), declarations)))
}

/// Like [`load_file`], in processes of `program`, which must call [`run_child`] where its arguments are `plugin-process PATH`: a crash of
/// the plug-in ends such a process alone.
///
/// # Errors
///
/// - Those of [`load`].
/// - A process crashes or cannot be started.
pub fn load_apart(file: &PluginFile, program: PathBuf) -> Result<Contents> {
    // A sandbox needs no process.
    if file.is_module() {
        return load_module(file).map(contents);
    }
    process::load(file, program).map(contents)
}

fn contents(items: Vec<PluginItem>) -> Contents {
    let mut contents = Contents::default();
    for item in items {
        contents.plugin.get_or_insert_with(|| item.runner.plugin().clone());
        match item.declaration.family {
            Family::GradientFilter { .. } => contents.filters.push(Arc::new(item)),
            Family::Reader { .. } => contents.readers.push(item::leak(item)),
            Family::GridFilter { .. } => contents.nodes.push(grid_filter::grid_node(item)),
            Family::ImageFilter => contents.nodes.push(item::image_node(item)),
        }
    }
    contents
}

#[cfg(feature = "wasm")]
use wasm::load as load_module;

/// Errors: always; this build has no sandbox.
#[cfg(not(feature = "wasm"))]
fn load_module(file: &PluginFile) -> Result<Vec<PluginItem>> {
    let error = Error::usage(
        "the plug-in is a WebAssembly module, and this program was built without the sandbox for them",
    );
    Err(error.expected("a build with the feature \"wasm\", or a shared library").in_file(file.path()))
}

/// A library that the file names.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Configured {
    /// Path; a relative one in the file is relative to the file's folder.
    pub path: PathBuf,
    /// Fingerprint that the library must have, as pictures record it; `None` for any.
    pub fingerprint: Option<String>,
}

/// The libraries that the file names. None where there is no such file. `home`: the folder that `~/` at the beginning of a path means.
///
/// # Errors
///
/// - The file is malformed; with the position.
/// - A path begins with `~`, and no home folder is known, or it is another user's.
pub fn configured(file: &Path, home: Option<&Path>) -> Result<Vec<Configured>> {
    let text = match std::fs::read_to_string(file) {
        Ok(text) => text,
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Vec::new()),
        Err(error) => {
            return Err(Error::usage("the file of plug-ins cannot be read").got(error).in_file(file));
        }
    };
    let wrong = |what: String| {
        let expected =
            "plugins = [\"PATH\", …], or { path = \"PATH\", fingerprint = \"…\" } in place of a path";
        Error::usage(what).expected(expected).in_file(file)
    };
    let table: toml::Table = text.parse().map_err(|error: toml::de::Error| {
        let wrong = wrong(error.message().to_string());
        match error.span() {
            Some(span) => wrong.at_span(&text, span),
            None => wrong,
        }
    })?;
    if let Some(key) = table.keys().find(|key| *key != "plugins") {
        return Err(wrong(format!("unknown key '{key}'")));
    }
    let Some(list) = table.get("plugins") else { return Ok(Vec::new()) };
    let folder = file.parent().unwrap_or(Path::new(""));
    let entries: Option<Vec<_>> = list.as_array().and_then(|list| list.iter().map(read_entry).collect());
    let entries = entries.ok_or_else(|| wrong("'plugins' is no list of paths".into()))?;
    let configured = |(path, fingerprint): (String, Option<String>)| {
        let path = match (path.strip_prefix("~/"), home) {
            (Some(rest), Some(home)) => home.join(rest),
            (Some(_), None) => return Err(wrong("no home folder is known for '~'".into())),
            (None, _) if path.starts_with('~') => {
                return Err(wrong("home folders of other users are not looked up".into()).got(path));
            }
            (None, _) => folder.join(path),
        };
        Ok(Configured { path, fingerprint })
    };
    entries.into_iter().map(configured).collect()
}

/// Path and fingerprint of an entry.
fn read_entry(entry: &Value) -> Option<(String, Option<String>)> {
    match entry {
        Value::String(path) => Some((path.clone(), None)),
        Value::Table(table) if table.keys().all(|key| key == "path" || key == "fingerprint") => {
            let text = |key: &str| Some(table.get(key)?.as_str()?.to_string());
            // A fingerprint that is no text is none that could be kept to.
            let fingerprint = match table.contains_key("fingerprint") {
                true => Some(text("fingerprint")?),
                false => None,
            };
            Some((text("path")?, fingerprint))
        }
        _ => None,
    }
}
