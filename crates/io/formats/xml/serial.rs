//! Grids of one file: .vtu .vts .vtr .vti.

use super::header::{Appended, Element};
use crate::formats::codec::Codec;
use crate::formats::contents::{
    CellBlocks, DEGREES, Dataset, Encoding, Geometry, Piece, PieceArray, Stored, StoredCells, StoredFaces,
    TIME, extent_dimensions, structured_counts,
};
use crate::formats::numbers::{ByteOrder, NumberType};
use crate::formats::request::Request;
use crate::formats::source::Source;
use crate::formats::units;
use glam::{DMat3, DVec3};
use std::ops::Range;
use std::sync::Arc;
use voltet_core::grid::Association;
use voltet_core::{Error, Result};

/// Bytes of a text that are looked at for a unit.
const LONGEST_UNIT: u64 = 1024;

/// The element that bears the name of the file's type.
pub(super) fn grid<'a>(root: &'a Element, kind: &str) -> Result<&'a Element> {
    let missing = || Error::run(format!("the file holds no <{kind}>")).expected("what its type says");
    root.child(kind).ok_or_else(missing)
}

/// Name of the array that one of these sections marks by an attribute: as `Scalars` or `GlobalIds`.
pub(super) fn marked(element: &Element, sections: &[&str], attribute: &str) -> Option<String> {
    sections.iter().find_map(|tag| element.child(tag)?.attribute(attribute).map(str::to_owned))
}

/// Reads the table of contents of a serial file.
pub(super) fn open_serial(
    source: Arc<Source>,
    root: &Element,
    appended: Option<Appended>,
    request: &Request,
) -> Result<Dataset> {
    let file_bytes = source.len();
    let mut context = Context::new(source, root, appended)?;
    let kind = root.required("type")?;
    let geometry_of = match kind {
        "UnstructuredGrid" => unstructured,
        "StructuredGrid" => structured,
        "RectilinearGrid" => rectilinear,
        "ImageData" => uniform,
        _ => return Err(refusal(kind, root)),
    };
    let grid = grid(root, kind)?;
    let format = format!("VTK XML {kind}, {}", context.describe());
    let is_old_order = root.attribute("version").is_some_and(|version| is_before(version, [2, 1]));
    let mut dataset = Dataset { format, file_bytes, ..Dataset::default() };
    // Arrays of several times in one file.
    if let Some(times) = grid.attribute("TimeValues") {
        let times: Option<Vec<f64>> = times.split_ascii_whitespace().map(|time| time.parse().ok()).collect();
        dataset.time_steps = times.ok_or_else(|| grid.wrong("TimeValues", "numbers"))?;
        if !dataset.time_steps.is_empty() {
            context.step = Some(request.step_index(&dataset.time_steps)?);
        }
    }
    for name in TIME {
        if let Some(section) = grid.child("FieldData")
            && let Some(field) = context.named(section, name, None)?
        {
            dataset.time = dataset.time.or(field.first());
        }
    }
    for (index, element) in grid.children_of("Piece").enumerate() {
        // A process without cells may leave out their sections and arrays.
        let is_none = |count: &str| element.attribute(count).is_some_and(|count| count.trim() == "0");
        if is_none("NumberOfPoints") && is_none("NumberOfCells") {
            continue;
        }
        let piece = || {
            let ((point_count, cell_count), geometry) = geometry_of(&context, grid, element)?;
            let mut arrays = context.section(element, "PointData", Association::Point, point_count)?;
            arrays.extend(context.section(element, "CellData", Association::Cell, cell_count)?);
            let blocks = CellBlocks::default();
            Ok(Piece { point_count, cell_count, geometry, arrays, blocks, is_old_order })
        };
        dataset.pieces.push(piece().map_err(|error: Error| error.at_item(format!("piece {index}")))?);
        let active = marked(element, &["PointData", "CellData"], "Scalars");
        dataset.active_scalars = dataset.active_scalars.or(active);
        dataset.global_ids = dataset.global_ids.or(marked(element, &["PointData"], "GlobalIds"));
    }
    if grid.child("Piece").is_none() {
        return Err(Error::run(format!("<{kind}> holds no pieces")).expected("at least one <Piece>"));
    }
    Ok(dataset)
}

/// True if a version, "major.minor", comes before another; what is no version does not.
pub(in crate::formats) fn is_before(version: &str, other: [u32; 2]) -> bool {
    let mut numbers = version.trim().splitn(2, '.').map(|number| number.parse::<u32>().ok());
    let (major, minor) = (numbers.next().flatten(), numbers.next().flatten());
    major.is_some_and(|major| [major, minor.unwrap_or(0)] < other)
}

/// Finds `<Points>` and its array.
pub(super) fn points(context: &Context, piece: &Element, count: u64) -> Result<Stored> {
    let lacks = |what: &str| Error::run(what).expected("<Points> of one <DataArray> of three components");
    let section = piece.child("Points").ok_or_else(|| lacks("the piece holds no <Points>"))?;
    let array = context.arrays(section).next().ok_or_else(|| lacks("<Points> holds no array"))?;
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

/// Numbers of points and cells, and where they are stored.
type CountedGeometry = ((u64, u64), Geometry);

fn unstructured(context: &Context, _grid: &Element, element: &Element) -> Result<CountedGeometry> {
    let count = |name: &str| -> Result<u64> {
        element.required(name)?;
        Ok(element.number(name)?.unwrap_or(0))
    };
    let (point_count, cell_count) = (count("NumberOfPoints")?, count("NumberOfCells")?);
    let section = element.child("Cells").ok_or_else(|| {
        Error::run("the piece holds no <Cells>").expected("<Cells> of connectivity, offsets and types")
    })?;
    let faces = faces(context, section, cell_count)?;
    let cells = StoredCells::Offsets {
        connectivity: context.required(section, "connectivity", None)?,
        offsets: context.required(section, "offsets", None)?,
        types: context.required(section, "types", Some(cell_count))?,
        faces,
    };
    let geometry =
        Geometry::Unstructured { points: points(context, element, point_count)?, cells: Box::new(cells) };
    Ok(((point_count, cell_count), geometry))
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

fn structured(context: &Context, grid: &Element, element: &Element) -> Result<CountedGeometry> {
    let dimensions = extent_dimensions(extent(grid, element)?);
    let counts = structured_counts(dimensions)?;
    let geometry = Geometry::Curvilinear { dimensions, points: points(context, element, counts.0)? };
    Ok((counts, geometry))
}

fn rectilinear(context: &Context, grid: &Element, element: &Element) -> Result<CountedGeometry> {
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
    Ok((structured_counts(dimensions)?, Geometry::Rectilinear { dimensions, axes }))
}

fn uniform(_context: &Context, grid: &Element, element: &Element) -> Result<CountedGeometry> {
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
    Ok((structured_counts(dimensions)?, geometry))
}

/// Encoding of all arrays of a file, from its root element.
#[derive(Debug, Clone)]
pub(super) struct Context {
    source: Arc<Source>,
    order: ByteOrder,
    /// 64-bit header words.
    wide: bool,
    codec: Option<Codec>,
    appended: Option<Appended>,
    /// The step of a file that holds arrays of several times.
    step: Option<usize>,
}

impl Context {
    /// Reads the attributes of `<VTKFile>`.
    pub(super) fn new(source: Arc<Source>, root: &Element, appended: Option<Appended>) -> Result<Context> {
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
        Ok(Context { source, order, wide, codec, appended, step: None })
    }

    /// Format and encoding of the file, for people.
    pub(super) fn describe(&self) -> String {
        format!(
            "{}{}, {} headers",
            self.codec.map_or(String::new(), |codec| format!("{}, ", codec.name())),
            if self.order == ByteOrder::Little { "little-endian" } else { "big-endian" },
            if self.wide { "UInt64" } else { "UInt32" },
        )
    }

    /// An array of `tuple_count` tuples (`None`: only its data tells).
    pub(super) fn stored(&self, element: &Element, tuple_count: Option<u64>) -> Result<Stored> {
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
                let part = match &element.text[..] {
                    [part] => part.clone(),
                    [] if tuple_count == Some(0) => 0..0,
                    [] => return Err(Error::run("the array holds no base64 text")),
                    _ => return Err(Error::run("the base64 text is not in one part")),
                };
                self.binary(part, true)
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
                self.binary(at..self.source.len(), appended.base64)
            }
            _ => return Err(element.wrong("format", "ascii, binary or appended")),
        };
        Ok(Stored {
            source: self.source.clone(),
            name: name.to_owned(),
            number_type,
            order: self.order,
            component_count,
            tuple_count,
            encoding,
        })
    }

    fn binary(&self, Range { start, end }: Range<u64>, base64: bool) -> Encoding {
        Encoding::Xml { at: start, end, base64, wide: self.wide, codec: self.codec }
    }

    /// The arrays of a section: of all times, and of the step that is read.
    pub(super) fn arrays<'a>(&self, section: &'a Element) -> impl Iterator<Item = &'a Element> + use<'a> {
        let step = self.step;
        section.children_of("DataArray").filter(move |array| {
            let own = array.attribute("TimeStep").and_then(|own| own.trim().parse::<usize>().ok());
            own.is_none() || step.is_none() || own == step
        })
    }

    /// The array of a section (`Cells`, `Coordinates`) that bears a name.
    pub(super) fn named(
        &self,
        section: &Element,
        name: &str,
        tuple_count: Option<u64>,
    ) -> Result<Option<Stored>> {
        self.arrays(section)
            .find(|array| array.attribute("Name") == Some(name))
            .map(|array| self.stored(array, tuple_count))
            .transpose()
    }

    /// Finds an array that must be there.
    pub(super) fn required(&self, section: &Element, name: &str, tuple_count: Option<u64>) -> Result<Stored> {
        self.named(section, name, tuple_count)?.ok_or_else(|| {
            let error = Error::run(format!("<{}> lacks its array '{name}'", section.tag));
            error.expected(format_args!("<DataArray Name=\"{name}\">"))
        })
    }

    /// The unit of an array: VTK's information key `UNITS_LABEL`.
    fn unit(&self, array: &Element) -> Option<String> {
        let mut keys = array.children_of("InformationKey");
        let key = keys.find(|key| key.attribute("name") == Some("UNITS_LABEL"))?;
        // A longer text is no unit.
        let Range { start, end } = key.text.first()?.clone();
        let bytes = self.source.read(start, (end - start).min(LONGEST_UNIT)).ok()?;
        units::stated(&String::from_utf8_lossy(&bytes))
    }

    /// The arrays of `<PointData>` or `<CellData>`; arrays of text are not among them.
    pub(super) fn section(
        &self,
        piece: &Element,
        tag: &str,
        association: Association,
        count: u64,
    ) -> Result<Vec<PieceArray>> {
        let Some(section) = piece.child(tag) else { return Ok(Vec::new()) };
        self.arrays(section)
            .filter(|array| array.attribute("type") != Some("String"))
            .map(|array| {
                let mut own = PieceArray::new(association, self.stored(array, Some(count))?);
                if section.attribute(DEGREES) == Some(&own.stored.name) {
                    own.stored.name = DEGREES.to_owned();
                }
                let name = |component: usize| array.attribute(&format!("ComponentName{component}"));
                let names = (0..own.stored.component_count).map_while(name).map(str::to_owned);
                Ok(PieceArray { component_names: names.collect(), unit: self.unit(array), ..own })
            })
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
            "cells with a volume: a surface has to be filled with them by a mesher (Gmsh, TetGen) first; a node of type \
             surface-reader draws it as it is",
        ),
        ("PHyperTreeGrid", _) => error.expected("HyperTreeGrid, a file of which it names"),
        _ => error.expected(
            "UnstructuredGrid, StructuredGrid, RectilinearGrid, ImageData, their parallel forms or Collection",
        ),
    }
}
