//! The VTK XML formats: .vtu .vts .vtr .vti, their parallel forms, and .pvd.

mod arrays;
mod beside;
mod foreign;
mod header;
mod named;
mod parallel;
mod serial;
mod series;

pub(super) use beside::all as files_named;

use super::format::Format;
use super::piece::Dataset;
use super::request::Request;
use super::source::Source;
use std::sync::Arc;
use voltet_core::Result;

/// The declaration.
pub(super) const FORMAT: Format = Format {
    files: "a VTK XML file (.vtu, .vts, .vtr, .vti, their parallel forms, .pvd)",
    matches: |head, _, _| head.starts_with(b"<"),
    open,
    has_solution: false,
};

/// Reads the table of contents of a file of any of these formats.
fn open(source: Arc<Source>, request: &Request) -> Result<Dataset> {
    let (root, appended) = header::read(&source)?;
    match root.required("type")? {
        "Collection" => series::open(&source, &root, request),
        kind if parallel::matches(kind) => parallel::open(&source, &root),
        _ => serial::open(source, &root, appended),
    }
}
