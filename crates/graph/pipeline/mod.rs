//! The pipeline file: TOML in, a checked graph out, and back to text.
//!
//! [`Pipeline`] is the document: what a file states, unchecked, with the place of every word, so that each mistake
//! is shown where it stands. [`Pipeline::graph`] checks it against a registry of node types. The table `[editor]` is the
//! node editor's own: it is handed on by [`Pipeline::survey`] and looked at by nothing that runs.

mod document;
mod option;
mod parse;
mod write;

pub use document::{FORMAT, Pipeline};
pub use option::field;
pub use parse::{EDITOR, ParsedPipeline, parameters, value};

use voltet_core::Error;

/// Completes an error about a pipeline file: its path, and line and column for the byte range it points at.
/// Errors about other files are left as they are.
pub fn locate(mut error: Error, text: &str, path: &std::path::Path) -> Error {
    if error.location.file.is_some() {
        return error;
    }
    if error.location.line_column.is_none()
        && let Some(span) = error.location.span.take()
    {
        error = error.at_span(text, span);
    }
    error.in_file(path)
}

#[cfg(test)]
mod tests;
