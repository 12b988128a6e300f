//! Kinds of VTK XML files that hold no volume grid themselves.

use super::header::Element;
use voltet_core::Error;

/// The error for a file of this kind, with what to read in its place.
pub(super) fn refusal(kind: &str, root: &Element) -> Error {
    let error = Error::run("this kind of VTK file holds no volume grid").got(format_args!("type '{kind}'"));
    let mut files = Vec::new();
    named(root, &mut files);
    let readable = |file: &&str| {
        let ending = file.rsplit_once('.').map_or("", |(_, ending)| ending);
        ["vtu", "vts", "vtr", "vti", "pvtu", "pvts", "pvtr", "pvti"].contains(&ending)
    };
    let readable: Vec<&str> = files.iter().copied().filter(readable).collect();
    match (kind, readable.as_slice()) {
        (_, [first, ..]) => error.expected(format!(
            "one of the {} grids that it names, such as '{first}' beside it; ParaView's Merge Blocks joins them into one \
             .vtu file",
            readable.len()
        )),
        ("PolyData" | "PPolyData", _) => error.expected(
            "cells with a volume: a surface has to be filled with them by a mesher (Gmsh, TetGen) first",
        ),
        ("HyperTreeGrid" | "vtkOverlappingAMR" | "vtkHierarchicalBoxDataSet" | "vtkNonOverlappingAMR", _) => error
            .expected("a .vtu file: ParaView makes one of it (Resample or Clip with everything kept) and saves it"),
        _ => error.expected(
            "UnstructuredGrid, StructuredGrid, RectilinearGrid, ImageData, their parallel forms or Collection",
        ),
    }
}

/// The files that the elements below this one name.
fn named<'a>(element: &'a Element, files: &mut Vec<&'a str>) {
    files.extend(element.attribute("file"));
    element.children.iter().for_each(|child| named(child, files));
}
