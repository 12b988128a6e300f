//! The user's file of plug-ins: `plugins = ["/path/of/filter.so"]`.

use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use toml::Value;
use voltet_core::{Error, Result};

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
