//! The VTK XML formats: .vtu .vts .vtr .vti, their parallel forms, and .pvd.

mod arrays;
mod header;
mod parallel;
mod serial;
mod series;

use super::piece::Dataset;
use super::source::Source;
use super::{Format, Request};
use std::sync::Arc;
use voltet_core::{Error, Result};

/// The declaration.
pub(super) const FORMAT: Format = Format {
    files: "a VTK XML file (.vtu, .vts, .vtr, .vti, their parallel forms, .pvd)",
    is_meant: |head, _, _| head.starts_with(b"<"),
    open,
    has_solution: false,
};

/// Reads the table of contents of a file of any of these formats.
fn open(source: Arc<Source>, request: &Request) -> Result<Dataset> {
    let (root, appended) = header::read(&source)?;
    match root.required("type")? {
        "Collection" => series::open(&source, &root, request),
        kind if kind.starts_with('P') && kind != "PolyData" => parallel::open(&source, &root),
        _ => serial::open(source, &root, appended),
    }
}

/// Reads a file that a parallel file or a series names, and adds its pieces.
fn open_inner(path: &std::path::Path, may_be_parallel: bool, to: &mut Dataset) -> Result<()> {
    let source = Source::open(path)?;
    let inner = || {
        let (root, appended) = header::read(&source)?;
        let kind = root.required("type")?;
        let is_parallel = kind.starts_with('P') && kind != "PolyData";
        if kind == "Collection" || is_parallel && !may_be_parallel {
            return Err(Error::run("a file names another of a kind that cannot stand there").found(kind));
        }
        if is_parallel {
            parallel::open(&source, &root)
        } else {
            serial::open(source.clone(), &root, appended)
        }
    };
    let part = inner().map_err(|error| error.in_file(path))?;
    to.pieces.extend(part.pieces);
    to.warnings.extend(part.warnings);
    to.active_scalars = to.active_scalars.take().or(part.active_scalars);
    if to.format.is_empty() {
        to.format = part.format;
    }
    Ok(())
}

/// The path of a file that another one names, relative to it.
fn beside(source: &Source, name: &str) -> std::path::PathBuf {
    source.path().parent().unwrap_or(std::path::Path::new("")).join(name)
}
