//! .pvtu, .pvts, .pvtr and .pvti: files that name the files of their pieces.

use super::header::Element;
use super::{beside, open_inner};
use crate::formats::piece::Dataset;
use crate::formats::source::Source;
use voltet_core::{Error, Result};

/// Reads the tables of contents of all pieces.
pub(super) fn open(source: &Source, root: &Element) -> Result<Dataset> {
    let kind = root.required("type")?;
    if !["PUnstructuredGrid", "PStructuredGrid", "PRectilinearGrid", "PImageData"].contains(&kind) {
        return Err(Error::run("this kind of VTK file holds no volume grid")
            .found(format_args!("type '{kind}'"))
            .accepted("PUnstructuredGrid, PStructuredGrid, PRectilinearGrid or PImageData"));
    }
    let grid = root
        .child(kind)
        .ok_or_else(|| Error::run(format!("the file holds no <{kind}>")).accepted("what its type says"))?;
    let mut dataset = Dataset::default();
    let scalars = |tag| grid.child(tag).and_then(|section| section.attribute("Scalars"));
    dataset.active_scalars = scalars("PPointData").or_else(|| scalars("PCellData")).map(str::to_owned);
    let mut count = 0;
    for piece in grid.children_of("Piece") {
        open_inner(&beside(source, piece.required("Source")?), false, &mut dataset)?;
        count += 1;
    }
    if count == 0 {
        return Err(
            Error::run(format!("<{kind}> names no pieces")).accepted("at least one <Piece Source=\"…\">")
        );
    }
    dataset.format = format!("VTK XML {kind} of {count} pieces; {}", dataset.format);
    Ok(dataset)
}
