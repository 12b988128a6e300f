//! .vtu, .vts, .vtr and .vti: one file, one or several pieces.

use super::arrays::Context;
use super::foreign;
use super::header::{Appended, Element};
use crate::formats::piece::{
    Dataset, Geometry, Piece, StoredCells, StoredFaces, extent_dimensions, structured_counts,
};
use crate::formats::source::Source;
use crate::formats::stored::Stored;
use glam::{DMat3, DVec3};
use std::sync::Arc;
use voltet_core::{Error, Result};

/// Reads the table of contents of a serial file.
pub(super) fn open(source: Arc<Source>, root: &Element, appended: Option<Appended>) -> Result<Dataset> {
    let context = Context::new(source, root, appended)?;
    let kind = root.required("type")?;
    let piece_of = match kind {
        "UnstructuredGrid" => unstructured,
        "StructuredGrid" => structured,
        "RectilinearGrid" => rectilinear,
        "ImageData" => uniform,
        _ => return Err(foreign::refusal(kind, root)),
    };
    let grid = root
        .child(kind)
        .ok_or_else(|| Error::run(format!("the file holds no <{kind}>")).expected("what its type says"))?;
    let mut dataset =
        Dataset { format: format!("VTK XML {kind}, {}", context.describe()), ..Dataset::default() };
    for (index, element) in grid.children_of("Piece").enumerate() {
        let piece =
            piece_of(&context, grid, element).map_err(|error| error.at_item(format!("piece {index}")))?;
        dataset.pieces.push(piece);
        let scalars = |tag| element.child(tag).and_then(|section| section.attribute("Scalars"));
        let active = scalars("PointData").or_else(|| scalars("CellData")).map(str::to_owned);
        dataset.active_scalars = dataset.active_scalars.or(active);
    }
    if dataset.pieces.is_empty() {
        return Err(Error::run(format!("<{kind}> holds no pieces")).expected("at least one <Piece>"));
    }
    Ok(dataset)
}

/// Finds `<Points>` and its array.
fn points(context: &Context, piece: &Element, count: u64) -> Result<Stored> {
    let section = piece.child("Points").ok_or_else(|| Error::run("the piece holds no <Points>"))?;
    let array = section.child("DataArray").ok_or_else(|| Error::run("<Points> holds no array"))?;
    let mut stored = context.stored(array, Some(count))?;
    if stored.component_count != 3 {
        // Points always have three coordinates; some writers leave the attribute out.
        if array.attribute("NumberOfComponents").is_some() {
            return Err(array.wrong("NumberOfComponents", "3"));
        }
        stored.component_count = 3;
    }
    if stored.name.is_empty() {
        stored.name = "Points".to_owned();
    }
    Ok(stored)
}

fn piece(context: &Context, element: &Element, counts: (u64, u64), geometry: Geometry) -> Result<Piece> {
    let (point_count, cell_count) = counts;
    let mut arrays = context.section(element, false, point_count)?;
    arrays.extend(context.section(element, true, cell_count)?);
    Ok(Piece { point_count, cell_count, geometry, arrays })
}

fn unstructured(context: &Context, _grid: &Element, element: &Element) -> Result<Piece> {
    let count = |name: &str| -> Result<u64> {
        element.required(name)?;
        Ok(element.number(name)?.unwrap_or(0))
    };
    let (point_count, cell_count) = (count("NumberOfPoints")?, count("NumberOfCells")?);
    let section = element.child("Cells").ok_or_else(|| Error::run("the piece holds no <Cells>"))?;
    let faces = faces(context, section, cell_count)?;
    let cells = StoredCells::Offsets {
        connectivity: context.required(section, "connectivity", None)?,
        offsets: context.required(section, "offsets", None)?,
        types: context.required(section, "types", Some(cell_count))?,
        faces,
    };
    let geometry =
        Geometry::Unstructured { points: points(context, element, point_count)?, cells: Box::new(cells) };
    piece(context, element, (point_count, cell_count), geometry)
}

/// The faces of polyhedra, in either of the forms that VTK has written.
fn faces(context: &Context, section: &Element, cell_count: u64) -> Result<StoredFaces> {
    let array = |name, count| context.named(section, name, count).map(|stored| stored.map(Box::new));
    if let (Some(faces), Some(offsets)) = (array("faces", None)?, array("faceoffsets", Some(cell_count))?) {
        return Ok(StoredFaces::Stream { faces, offsets });
    }
    let points = array("face_connectivity", None)?;
    let point_offsets = array("face_offsets", None)?;
    let faces = array("polyhedron_to_faces", None)?;
    let face_offsets = array("polyhedron_offsets", None)?;
    Ok(match (points, point_offsets, faces, face_offsets) {
        (Some(points), Some(point_offsets), Some(faces), Some(face_offsets)) => {
            StoredFaces::Indexed { points, point_offsets, faces, face_offsets }
        }
        _ => StoredFaces::None,
    })
}

/// The extent of a piece, or of the whole grid where the piece does not say.
fn extent(grid: &Element, element: &Element) -> Result<[i64; 6]> {
    if let Some(extent) = element.numbers("Extent")? {
        return Ok(extent);
    }
    grid.numbers("WholeExtent")?.ok_or_else(|| {
        Error::run("the grid does not say how large it is").expected("the attribute WholeExtent")
    })
}

fn counts(dimensions: [u64; 3]) -> Result<(u64, u64)> {
    structured_counts(dimensions).ok_or_else(|| {
        Error::run("the extent cannot be that large").got(format_args!("{dimensions:?} points"))
    })
}

fn structured(context: &Context, grid: &Element, element: &Element) -> Result<Piece> {
    let dimensions = extent_dimensions(extent(grid, element)?);
    let counts = counts(dimensions)?;
    let geometry = Geometry::Curvilinear { dimensions, points: points(context, element, counts.0)? };
    piece(context, element, counts, geometry)
}

fn rectilinear(context: &Context, grid: &Element, element: &Element) -> Result<Piece> {
    let dimensions = extent_dimensions(extent(grid, element)?);
    let section =
        element.child("Coordinates").ok_or_else(|| Error::run("the piece holds no <Coordinates>"))?;
    let arrays: Vec<&Element> = section.children_of("DataArray").collect();
    let [x, y, z] = arrays[..] else {
        return Err(Error::run("<Coordinates> holds the wrong number of arrays")
            .got(arrays.len())
            .expected(3));
    };
    let axes = Box::new([
        context.stored(x, Some(dimensions[0]))?,
        context.stored(y, Some(dimensions[1]))?,
        context.stored(z, Some(dimensions[2]))?,
    ]);
    piece(context, element, counts(dimensions)?, Geometry::Rectilinear { dimensions, axes })
}

fn uniform(context: &Context, grid: &Element, element: &Element) -> Result<Piece> {
    let extent = extent(grid, element)?;
    let dimensions = extent_dimensions(extent);
    let vector = |name: &str, otherwise: DVec3| -> Result<DVec3> {
        Ok(grid.numbers::<f64, 3>(name)?.map_or(otherwise, DVec3::from_array))
    };
    // The rows of the direction matrix are written one after the other.
    let direction = match grid.numbers::<f64, 9>("Direction")? {
        Some(rows) => DMat3::from_cols_array(&rows).transpose(),
        None => DMat3::IDENTITY,
    };
    let geometry = Geometry::Uniform {
        dimensions,
        first: DVec3::new(extent[0] as f64, extent[2] as f64, extent[4] as f64),
        origin: vector("Origin", DVec3::ZERO)?,
        spacing: vector("Spacing", DVec3::ONE)?,
        direction,
    };
    piece(context, element, counts(dimensions)?, geometry)
}
