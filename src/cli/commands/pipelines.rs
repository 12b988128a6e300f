//! The pipeline files that a command names, opened.

use super::exit_status::{DONE, show};
use crate::core::Error;
use crate::graph::Registry;
use crate::{Document, Source};
use std::path::PathBuf;

/// Opens every file, showing each error; `None` with the exit code where any is wrong.
pub fn open_all(files: &[PathBuf], options: &[String], registry: &Registry) -> (Vec<Document>, u8) {
    let mut documents = Vec::new();
    let mut worst = DONE;
    for path in files {
        match open(path, options, registry) {
            Ok(document) => documents.push(document),
            Err((error, text)) => worst = worst.max(show(&error, text.as_deref())),
        }
    }
    (documents, worst)
}

/// Opens one file; an error comes with the text that it may point into.
pub fn open(
    path: &std::path::Path,
    options: &[String],
    registry: &Registry,
) -> Result<Document, (Error, Option<String>)> {
    let source = Source::read(path).map_err(|error| (error, None))?;
    let text = source.text.clone();
    Document::from_source(path, source, options, registry).map_err(|error| (error, Some(text)))
}
