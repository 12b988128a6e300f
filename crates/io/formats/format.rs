//! The declaration of a format.

use super::piece::Dataset;
use super::request::Request;
use super::source::Source;
use std::path::Path;
use std::sync::Arc;
use voltet_core::Result;

/// A format of files.
pub(super) struct Format {
    /// Name of the format's files in messages.
    pub files: &'static str,
    /// True if a file is one, by its name and how it begins (a byte order mark and white space left out).
    pub matches: fn(head: &[u8], path: &Path, request: &Request) -> bool,
    /// Reads the table of contents.
    pub open: fn(Arc<Source>, &Request) -> Result<Dataset>,
    /// True if a file may come with a second one, [`Request::solution`].
    pub has_solution: bool,
}
