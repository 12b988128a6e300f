//! .vtu, .vts, .vtr and .vti: one file, one or several pieces, each with its arrays.

use super::header::{Appended, Element};
use crate::formats::codec::Codec;
use crate::formats::contents::{
    Dataset, Encoding, Geometry, Piece, PieceArray, Stored, StoredCells, StoredFaces, extent_dimensions,
    structured_counts,
};
use crate::formats::numbers::{ByteOrder, NumberType};
use crate::formats::source::Source;
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
        _ => return Err(refusal(kind, root)),
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

/// Encoding of all arrays of a file, from its root element.
#[derive(Debug, Clone)]
pub(super) struct Context {
    pub source: Arc<Source>,
    pub order: ByteOrder,
    /// 64-bit header words.
    pub wide: bool,
    pub codec: Option<Codec>,
    pub appended: Option<Appended>,
}

impl Context {
    /// Reads the attributes of `<VTKFile>`.
    pub fn new(source: Arc<Source>, root: &Element, appended: Option<Appended>) -> Result<Context> {
        let order = match root.attribute("byte_order") {
            None | Some("LittleEndian") => ByteOrder::Little,
            Some("BigEndian") => ByteOrder::Big,
            Some(_) => return Err(root.wrong("byte_order", "LittleEndian or BigEndian")),
        };
        let wide = match root.attribute("header_type") {
            None | Some("UInt32") => false,
            Some("UInt64") => true,
            Some(_) => return Err(root.wrong("header_type", "UInt32 or UInt64")),
        };
        let codec = Codec::from_name(root.attribute("compressor").unwrap_or(""))?;
        Ok(Context { source, order, wide, codec, appended })
    }

    /// Format and encoding of the file, for people.
    pub fn describe(&self) -> String {
        format!(
            "{}{}, {} headers",
            self.codec.map_or(String::new(), |codec| format!("{}, ", codec.name())),
            if self.order == ByteOrder::Little { "little-endian" } else { "big-endian" },
            if self.wide { "UInt64" } else { "UInt32" },
        )
    }

    /// An array of `tuple_count` tuples (`None`: only its data tells).
    pub fn stored(&self, element: &Element, tuple_count: Option<u64>) -> Result<Stored> {
        let name = element.attribute("Name").unwrap_or("").to_owned();
        self.stored_inner(element, tuple_count, &name).map_err(|error| error.at_item(&name))
    }

    fn stored_inner(&self, element: &Element, tuple_count: Option<u64>, name: &str) -> Result<Stored> {
        let number_type = NumberType::from_xml(element.required("type")?)
            .ok_or_else(|| element.wrong("type", "Int8 … UInt64, Float32, Float64 or Bit"))?;
        let component_count: usize = element.number("NumberOfComponents")?.unwrap_or(1).max(1);
        let encoding = match element.attribute("format").unwrap_or("ascii") {
            "ascii" => Encoding::Text(element.text.clone()),
            "binary" => {
                let mut parts = element.text.iter();
                let part = match (parts.next(), parts.next()) {
                    (Some(part), None) => part.clone(),
                    (None, _) if tuple_count == Some(0) => 0..0,
                    (None, _) => return Err(Error::run("the array holds no base64 text")),
                    _ => return Err(Error::run("the base64 text is not in one part")),
                };
                Encoding::Xml {
                    at: part.start,
                    end: part.end,
                    base64: true,
                    wide: self.wide,
                    codec: self.codec,
                }
            }
            "appended" => {
                let Some(appended) = self.appended else {
                    return Err(Error::run("the file holds no appended data")
                        .expected("<AppendedData> after the header"));
                };
                let offset: u64 = element.number("offset")?.ok_or_else(|| {
                    Error::run("an appended array does not say where it lies")
                        .expected("the attribute offset")
                })?;
                let at = appended.offset.checked_add(offset).filter(|&at| at <= self.source.len());
                let Some(at) = at else {
                    return Err(Error::run("the array lies beyond the end of the file")
                        .got(format_args!("offset {offset}"))
                        .expected(format_args!("at most {}", self.source.len() - appended.offset)));
                };
                let end = self.source.len();
                Encoding::Xml { at, end, base64: appended.base64, wide: self.wide, codec: self.codec }
            }
            _ => return Err(element.wrong("format", "ascii, binary or appended")),
        };
        let order = self.order;
        Ok(Stored {
            source: self.source.clone(),
            name: name.to_owned(),
            number_type,
            order,
            component_count,
            tuple_count,
            encoding,
        })
    }

    /// The array of a section (`Cells`, `Coordinates`) that bears a name.
    pub fn named(&self, section: &Element, name: &str, tuple_count: Option<u64>) -> Result<Option<Stored>> {
        section
            .children_of("DataArray")
            .find(|array| array.attribute("Name") == Some(name))
            .map(|array| self.stored(array, tuple_count))
            .transpose()
    }

    /// Finds an array that must be there.
    pub fn required(&self, section: &Element, name: &str, tuple_count: Option<u64>) -> Result<Stored> {
        self.named(section, name, tuple_count)?
            .ok_or_else(|| Error::run(format!("<{}> lacks its array '{name}'", section.tag)))
    }

    /// The arrays of `<PointData>` or `<CellData>`; arrays of text are not among them.
    pub fn section(&self, piece: &Element, per_cell: bool, count: u64) -> Result<Vec<PieceArray>> {
        let tag = if per_cell { "CellData" } else { "PointData" };
        let Some(section) = piece.child(tag) else { return Ok(Vec::new()) };
        section
            .children_of("DataArray")
            .filter(|array| array.attribute("type") != Some("String"))
            .map(|array| Ok(PieceArray { per_cell, stored: self.stored(array, Some(count))? }))
            .collect()
    }
}

/// The error for a file of this kind, with what to read in its place.
pub(super) fn refusal(kind: &str, root: &Element) -> Error {
    let error = Error::run("this kind of VTK file holds no volume grid").got(format_args!("type '{kind}'"));
    let readable = |file: &&str| {
        let ending = file.rsplit_once('.').map_or("", |(_, ending)| ending);
        ["vtu", "vts", "vtr", "vti", "pvtu", "pvts", "pvtr", "pvti"].contains(&ending)
    };
    let readable: Vec<&str> = root.attributes_below(&["file"]).into_iter().filter(readable).collect();
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
