//! Files that a parallel file or a series names.

use super::header::{self, Appended, Element};
use crate::formats::piece::Dataset;
use crate::formats::source::Source;
use std::path::Path;
use std::sync::Arc;
use voltet_core::{Error, Result};

/// Reads the file `name`, a path relative to the file that names it, by `open`, and adds its pieces.
pub(super) fn add(
    by: &Source,
    name: &str,
    open: impl FnOnce(Arc<Source>, &Element, Option<Appended>) -> Result<Dataset>,
    to: &mut Dataset,
) -> Result<()> {
    let path = by.path().parent().unwrap_or(Path::new("")).join(name);
    let source = Source::open(&path)?;
    let inner = || {
        let (root, appended) = header::read(&source)?;
        open(source.clone(), &root, appended)
    };
    let part = inner().map_err(|error| error.in_file(&path))?;
    to.pieces.extend(part.pieces);
    to.warnings.extend(part.warnings);
    to.active_scalars = to.active_scalars.take().or(part.active_scalars);
    if to.format.is_empty() {
        to.format = part.format;
    }
    Ok(())
}

/// The error about a named file of a kind that cannot be named there.
pub(super) fn misplaced(kind: &str) -> Error {
    Error::run("a file names another of a kind that cannot stand there").got(kind)
}
