//! The user's own file of plug-ins: `plugins = ["/path/of/filter.so"]`.

use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use voltet_core::{Error, Result};

/// The libraries that the file names; relative paths are relative to it. None where there is no such file.
///
/// Errors: what is wrong with it, at its place.
pub fn configured(file: &Path) -> Result<Vec<PathBuf>> {
    let text = match std::fs::read_to_string(file) {
        Ok(text) => text,
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Vec::new()),
        Err(error) => {
            return Err(Error::usage("the file of plug-ins cannot be read").found(error).in_file(file));
        }
    };
    let accepted = "plugins = [\"PATH\", …], the paths of shared libraries";
    let wrong = |what: String| Error::usage(what).accepted(accepted).in_file(file);
    let table: toml::Table = text.parse().map_err(|error: toml::de::Error| {
        let wrong = wrong(error.message().to_string());
        error.span().map_or_else(|| wrong.clone(), |span| wrong.clone().at_span(&text, span))
    })?;
    if let Some(key) = table.keys().find(|key| *key != "plugins") {
        return Err(wrong(format!("unknown key '{key}'")));
    }
    let Some(list) = table.get("plugins") else { return Ok(Vec::new()) };
    let list =
        list.as_array().and_then(|list| list.iter().map(|path| path.as_str()).collect::<Option<Vec<_>>>());
    let list = list.ok_or_else(|| wrong("'plugins' is no list of paths".into()))?;
    let folder = file.parent().unwrap_or(Path::new(""));
    Ok(list.into_iter().map(|path| folder.join(path)).collect())
}
