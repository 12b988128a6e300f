//! Files that another file names.

use crate::formats::source::Source;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use voltet_core::{Error, Result};

/// The path of a file that another names. Programs under Windows write backslashes, which are parts of names elsewhere.
pub(in crate::formats) fn beside(by: &Path, name: &str) -> PathBuf {
    let folder = by.parent().unwrap_or(Path::new(""));
    let path = folder.join(name);
    if name.contains('\\') && !path.exists() { folder.join(name.replace('\\', "/")) } else { path }
}

/// Files that one file keeps open of those that it names: half of what systems allow a program at least.
const MAX_OPEN: usize = 128;

/// Opens a file that another names, with its number among them. Errors say which does.
pub(in crate::formats) fn open_named(by: &Path, path: &Path, number: usize) -> Result<Arc<Source>> {
    let names = |error: Error| {
        let what = format!("'{}' names a file that cannot be read: {}", by.display(), error.what);
        Error { what, ..error }
    };
    let source = Source::open(path).map_err(names)?;
    Ok(if number < MAX_OPEN { source } else { source.closed() })
}

/// Bytes of a file within which its type stands.
pub(super) const HEAD: u64 = 1024;
