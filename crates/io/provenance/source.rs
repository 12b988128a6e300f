//! The text of a pipeline, from its file or from the picture that carries it.

use super::{Provenance, is_picture, read};
use std::fs::File;
use std::io::{BufReader, Read, Seek};
use std::path::Path;
use voltet_core::{Error, Result};
use voltet_graph::suggest;

/// The text of a pipeline, and where it comes from.
#[derive(Debug, Clone)]
pub struct Source {
    /// The text.
    pub text: String,
    /// Provenance of the picture that the pipeline comes from.
    pub embedded: Option<Provenance>,
}

impl Source {
    /// Reads a pipeline file, or what a picture carries.
    pub fn read(path: &Path) -> Result<Source> {
        let unreadable = |error| unreadable(path, error);
        let mut file = File::open(path).map_err(unreadable)?;
        let mut bytes = Vec::new();
        // A pipe can be read once.
        file.by_ref().take(8).read_to_end(&mut bytes).map_err(unreadable)?;
        if is_picture(&bytes) {
            file.rewind().map_err(unreadable)?;
            let carried = read(&bytes, BufReader::new(file)).map_err(|error| error.in_file(path))?;
            return Ok(Source { text: carried.pipeline.clone(), embedded: Some(carried) });
        }
        file.read_to_end(&mut bytes).map_err(unreadable)?;
        let text = String::from_utf8(bytes).map_err(|error| {
            let found = format!("byte {} is no UTF-8", error.utf8_error().valid_up_to());
            let error = Error::usage("the file is no pipeline file").got(found);
            error.expected("TOML text, or a picture (.png, .exr) that carries it").in_file(path)
        })?;
        Ok(Source { text, embedded: None })
    }
}

/// The error where a pipeline file cannot be read.
fn unreadable(path: &Path, error: std::io::Error) -> Error {
    let folder = path.parent().filter(|f| !f.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let names: Vec<String> = entries.map(|e| e.file_name().to_string_lossy().into_owned()).collect();
    let pipelines = names.iter().map(String::as_str).filter(|name| name.ends_with(".toml"));
    let wanted = path.file_name().unwrap_or_default().to_string_lossy();
    let error = Error::usage("the pipeline file cannot be read").got(error).in_file(path);
    match pipelines.clone().next() {
        Some(_) => error.expected(suggest(&wanted, pipelines)),
        None => error.expected("the path of a pipeline file (.toml)"),
    }
}
