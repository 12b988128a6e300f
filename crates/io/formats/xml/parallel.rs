//! .pvtu, .pvts, .pvtr and .pvti: files that name the files of their pieces.

use super::header::{Appended, Element};
use super::{foreign, named, serial};
use crate::formats::piece::Dataset;
use crate::formats::source::Source;
use std::sync::Arc;
use voltet_core::{Error, Result};

/// True if a file of this kind names others.
pub(super) fn matches(kind: &str) -> bool {
    kind.starts_with('P') && kind != "PolyData"
}

/// Reads the tables of contents of all pieces.
pub(super) fn open(source: &Source, root: &Element) -> Result<Dataset> {
    let kind = root.required("type")?;
    if !["PUnstructuredGrid", "PStructuredGrid", "PRectilinearGrid", "PImageData"].contains(&kind) {
        return Err(foreign::refusal(kind, root));
    }
    let grid = root
        .child(kind)
        .ok_or_else(|| Error::run(format!("the file holds no <{kind}>")).expected("what its type says"))?;
    let mut dataset = Dataset::default();
    let scalars = |tag| grid.child(tag).and_then(|section| section.attribute("Scalars"));
    dataset.active_scalars = scalars("PPointData").or_else(|| scalars("PCellData")).map(str::to_owned);
    let mut count = 0;
    for piece in grid.children_of("Piece") {
        named::add(source, piece.required("Source")?, open_piece, &mut dataset)?;
        count += 1;
    }
    if count == 0 {
        return Err(
            Error::run(format!("<{kind}> names no pieces")).expected("at least one <Piece Source=\"…\">")
        );
    }
    dataset.format = format!("VTK XML {kind} of {count} pieces; {}", dataset.format);
    Ok(dataset)
}

/// One piece's file.
fn open_piece(source: Arc<Source>, root: &Element, appended: Option<Appended>) -> Result<Dataset> {
    match root.required("type")? {
        kind if kind == "Collection" || matches(kind) => Err(named::misplaced(kind)),
        _ => serial::open(source, root, appended),
    }
}
