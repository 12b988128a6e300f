//! voltet-plugins: gradient filters, readers, grid filters and image filters from shared libraries, by the interface of `include/voltet_plugin.h`.
//!
//! A library is loaded only where the user names it: [`load`] is called for paths of the command line and of the user's configuration
//! file ([`Configured`]), never for those of a pipeline file. Its items then work like built-in ones. Declarations and outputs are
//! checked, and every message names the plug-in, its file and the item.

mod call;
mod declaration;
mod ffi;
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
mod values;
#[cfg(feature = "wasm")]
mod wasm;
mod wire;

pub use process::run_child;

use crate::declaration::Family;
use crate::item::PluginItem;
use std::fs::File;
use std::io::{ErrorKind, Read};
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
    if is_module(path) {
        return load_module(path).map(contents);
    }
    let native = library::load(path)?;
    let declarations = native.declarations();
    Ok(contents(PluginItem::list(Arc::new(native), declarations)))
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
            Family::Reader { .. } => contents.readers.push(item::leak(item)),
            Family::GridFilter { .. } => contents.nodes.push(grid_filter::grid_node(item)),
            Family::ImageFilter => contents.nodes.push(item::image_node(item)),
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
    let error = Error::usage(
        "the plug-in is a WebAssembly module, and this program was built without the sandbox for them",
    );
    Err(error.expected("a build with the feature \"wasm\", or a shared library").in_file(path))
}

/// A library that the file names.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Configured {
    /// Path; a relative one in the file is relative to the file's folder.
    pub path: PathBuf,
    /// Fingerprint that the library must have, as pictures record it; `None` for any.
    pub fingerprint: Option<String>,
}

/// The libraries that the file names. None where there is no such file.
///
/// Errors: the file is malformed; with the position.
pub fn configured(file: &Path) -> Result<Vec<Configured>> {
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
    let entries =
        list.as_array().and_then(|list| list.iter().map(|entry| read_entry(entry, folder)).collect());
    entries.ok_or_else(|| wrong("'plugins' is no list of paths".into()))
}

fn read_entry(entry: &Value, folder: &Path) -> Option<Configured> {
    match entry {
        Value::String(path) => Some(Configured { path: folder.join(path), fingerprint: None }),
        Value::Table(table) if table.keys().all(|key| key == "path" || key == "fingerprint") => {
            let text = |key: &str| Some(table.get(key)?.as_str()?.to_string());
            // A fingerprint that is no text is none that could be kept to.
            let fingerprint = match table.contains_key("fingerprint") {
                true => Some(text("fingerprint")?),
                false => None,
            };
            Some(Configured { path: folder.join(text("path")?), fingerprint })
        }
        _ => None,
    }
}
