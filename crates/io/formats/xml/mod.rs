//! The VTK XML formats: .vtu .vts .vtr .vti, and the files that name others: their parallel forms, and .pvd, a series
//! of time steps.

mod header;

use super::codec::Codec;
use super::contents::{
    DEGREES, Dataset, Encoding, Geometry, Piece, PieceArray, Stored, StoredCells, StoredFaces, TIME,
    extent_dimensions, structured_counts,
};
use super::numbers::{ByteOrder, NumberType};
use super::request::{Format, Request};
use super::source::Source;
use glam::{DMat3, DVec3};
use header::{Appended, Element};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use voltet_core::grid::Association;
use voltet_core::{Error, Result, counted};

/// The declaration.
pub(super) const FORMAT: Format = Format {
    files: "a VTK XML file (.vtu, .vts, .vtr, .vti, their parallel forms, .pvd)",
    matches: |head, _, _| head.starts_with(b"<"),
    open,
    has_solution: false,
};

/// Type of the files that name the files of time steps.
const SERIES: &str = "Collection";

/// True if a file of this type names the files of its pieces.
fn names_pieces(kind: &str) -> bool {
    kind.starts_with('P') && kind != "PolyData"
}

/// Reads the table of contents of a file of any of these formats.
fn open(source: Arc<Source>, request: &Request) -> Result<Dataset> {
    let (root, appended) = header::read(&source)?;
    match root.required("type")? {
        SERIES => open_series(&source, &root, request),
        _ => open_step(source, &root, appended, request, true),
    }
}

/// Reads the tables of contents of the files of one step.
fn open_series(source: &Source, root: &Element, request: &Request) -> Result<Dataset> {
    let (time_steps, files) = step(root, request)?;
    let mut dataset = Dataset::default();
    let inner = Request { time_step: None, ..request.clone() };
    for file in files {
        add(source, file, &inner, true, &mut dataset)?;
    }
    dataset.format = format!("VTK time series of {}; {}", counted(time_steps.len(), "step"), dataset.format);
    dataset.time_steps = time_steps;
    Ok(dataset)
}

/// One file of a step, or of a piece of it, which may not be in pieces again.
fn open_step(
    source: Arc<Source>,
    root: &Element,
    appended: Option<Appended>,
    request: &Request,
    may_have_pieces: bool,
) -> Result<Dataset> {
    match root.required("type")? {
        kind if kind == SERIES || !may_have_pieces && names_pieces(kind) => {
            let error = Error::run("a file names another of a kind that cannot stand there").got(kind);
            let expected = if may_have_pieces { "files of data" } else { "files of data in one part" };
            Err(error.expected(expected))
        }
        kind if names_pieces(kind) => open_parallel(&source, root, request),
        _ => open_serial(source, root, appended, request),
    }
}

/// Reads the tables of contents of all pieces.
fn open_parallel(source: &Source, root: &Element, request: &Request) -> Result<Dataset> {
    let kind = root.required("type")?;
    if !["PUnstructuredGrid", "PStructuredGrid", "PRectilinearGrid", "PImageData"].contains(&kind) {
        return Err(refusal(kind, root));
    }
    let grid = grid(root, kind)?;
    let mut dataset = Dataset {
        active_scalars: marked(grid, &["PPointData", "PCellData"], "Scalars"),
        ..Dataset::default()
    };
    let mut count = 0;
    for piece in grid.children_of("Piece") {
        add(source, piece.required("Source")?, request, false, &mut dataset)?;
        count += 1;
    }
    if count == 0 {
        let error = Error::run(format!("<{kind}> names no pieces"));
        return Err(error.expected("at least one <Piece Source=\"…\">"));
    }
    dataset.format = format!("VTK XML {kind} of {}; {}", counted(count, "piece"), dataset.format);
    Ok(dataset)
}

/// The element that bears the name of the file's type.
fn grid<'a>(root: &'a Element, kind: &str) -> Result<&'a Element> {
    let missing = || Error::run(format!("the file holds no <{kind}>")).expected("what its type says");
    root.child(kind).ok_or_else(missing)
}

/// Name of the array that one of these sections marks by an attribute: as `Scalars` or `GlobalIds`.
fn marked(element: &Element, sections: &[&str], attribute: &str) -> Option<String> {
    sections.iter().find_map(|tag| element.child(tag)?.attribute(attribute).map(str::to_owned))
}

/// The path of a file that another names. Programs under Windows write backslashes, which are parts of names elsewhere.
pub(super) fn beside(by: &Path, name: &str) -> PathBuf {
    let folder = by.parent().unwrap_or(Path::new(""));
    let path = folder.join(name);
    if !path.exists() && name.contains('\\') { folder.join(name.replace('\\', "/")) } else { path }
}

/// Opens a file that another names. Errors say which does.
pub(super) fn open_named(by: &Path, path: &Path) -> Result<Arc<Source>> {
    let names = |error: Error| {
        let what = format!("'{}' names a file that cannot be read: {}", by.display(), error.what);
        Error { what, ..error }
    };
    Source::open(path).map_err(names)
}

/// Reads the file `name`, a path relative to the file that names it, and adds its pieces.
fn add(by: &Source, name: &str, request: &Request, may_have_pieces: bool, to: &mut Dataset) -> Result<()> {
    let path = beside(by.path(), name);
    let source = open_named(by.path(), &path)?;
    let read = header::read(&source);
    let part = read.and_then(|(root, appended)| open_step(source, &root, appended, request, may_have_pieces));
    let part = part.map_err(|error| error.in_file(&path))?;
    to.pieces.extend(part.pieces);
    to.warnings.extend(part.warnings);
    to.time_steps = part.time_steps;
    to.time = to.time.or(part.time);
    to.file_bytes += part.file_bytes;
    to.active_scalars = to.active_scalars.take().or(part.active_scalars);
    to.global_ids = to.global_ids.take().or(part.global_ids);
    if to.format.is_empty() {
        to.format = part.format;
    }
    Ok(())
}

/// The times of all steps, and the files of that asked for.
fn step<'a>(root: &'a Element, request: &Request) -> Result<(Vec<f64>, Vec<&'a str>)> {
    let collection = root.child(SERIES).ok_or_else(|| {
        Error::run("the file holds no <Collection>").expected("<Collection> of <DataSet file=\"…\">")
    })?;
    let mut entries = Vec::new();
    for element in collection.children_of("DataSet") {
        let time = element.number::<f64>("timestep")?.unwrap_or(0.0);
        if !time.is_finite() {
            return Err(element.wrong("timestep", "a finite number"));
        }
        entries.push((time, element.required("file")?));
    }
    let mut time_steps: Vec<f64> = entries.iter().map(|entry| entry.0).collect();
    time_steps.sort_by(f64::total_cmp);
    time_steps.dedup();
    if time_steps.is_empty() {
        return Err(Error::run("the time series is empty").expected("at least one <DataSet file=\"…\">"));
    }
    let time = time_steps[request.step_index(&time_steps)?];
    let files = entries.into_iter().filter(|entry| entry.0 == time).map(|entry| entry.1).collect();
    Ok((time_steps, files))
}

/// Bytes of a file within which its type stands.
const HEAD: u64 = 1024;

/// The types that name others, as every writer spells them.
const MARKS: [&str; 2] = ["type=\"Collection\"", "type=\"P"];

/// The files that a series (of every step, or of that asked for) or a parallel file names, and those that these name; none for
/// files of other kinds, of which no more than the head is read.
pub(super) fn files_named(path: &Path, request: Option<&Request>) -> Vec<PathBuf> {
    files_marked(path, &MARKS, request)
}

/// Files that a file of one of these types names.
fn files_marked(path: &Path, marks: &[&str], request: Option<&Request>) -> Vec<PathBuf> {
    let Ok(source) = Source::open(path) else { return Vec::new() };
    let head = source.head(HEAD).unwrap_or_default();
    let names_others = |mark: &[u8]| head.windows(mark.len()).any(|window| window == mark);
    let text = head.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(&head).trim_ascii_start();
    if !text.starts_with(b"<") || !marks.iter().any(|mark| names_others(mark.as_bytes())) {
        return Vec::new();
    }
    let Ok((root, _)) = header::read(&source) else { return Vec::new() };
    // A series may name parallel files; these name no further ones.
    let is_series = root.attribute("type") == Some(SERIES);
    let names = match request.filter(|_| is_series) {
        Some(request) => step(&root, request).map(|(_, files)| files).unwrap_or_default(),
        None => root.attributes_below(&["file", "Source"]),
    };
    let mut paths: Vec<PathBuf> = names.into_iter().map(|name| beside(path, name)).collect();
    if is_series {
        let further: Vec<PathBuf> =
            paths.iter().flat_map(|path| files_marked(path, &MARKS[1..], None)).collect();
        paths.extend(further);
    }
    paths
}

/// Reads the table of contents of a serial file.
fn open_serial(
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
            Ok(Piece { point_count, cell_count, geometry, arrays, is_old_order })
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
pub(super) fn is_before(version: &str, other: [u32; 2]) -> bool {
    let mut numbers = version.trim().splitn(2, '.').map(|number| number.parse::<u32>().ok());
    let (major, minor) = (numbers.next().flatten(), numbers.next().flatten());
    major.is_some_and(|major| [major, minor.unwrap_or(0)] < other)
}

/// Finds `<Points>` and its array.
fn points(context: &Context, piece: &Element, count: u64) -> Result<Stored> {
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
struct Context {
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
    fn new(source: Arc<Source>, root: &Element, appended: Option<Appended>) -> Result<Context> {
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
    fn describe(&self) -> String {
        format!(
            "{}{}, {} headers",
            self.codec.map_or(String::new(), |codec| format!("{}, ", codec.name())),
            if self.order == ByteOrder::Little { "little-endian" } else { "big-endian" },
            if self.wide { "UInt64" } else { "UInt32" },
        )
    }

    /// An array of `tuple_count` tuples (`None`: only its data tells).
    fn stored(&self, element: &Element, tuple_count: Option<u64>) -> Result<Stored> {
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
    fn arrays<'a>(&self, section: &'a Element) -> impl Iterator<Item = &'a Element> + use<'a> {
        let step = self.step;
        section.children_of("DataArray").filter(move |array| {
            let own = array.attribute("TimeStep").and_then(|own| own.trim().parse::<usize>().ok());
            own.is_none() || step.is_none() || own == step
        })
    }

    /// The array of a section (`Cells`, `Coordinates`) that bears a name.
    fn named(&self, section: &Element, name: &str, tuple_count: Option<u64>) -> Result<Option<Stored>> {
        self.arrays(section)
            .find(|array| array.attribute("Name") == Some(name))
            .map(|array| self.stored(array, tuple_count))
            .transpose()
    }

    /// Finds an array that must be there.
    fn required(&self, section: &Element, name: &str, tuple_count: Option<u64>) -> Result<Stored> {
        self.named(section, name, tuple_count)?.ok_or_else(|| {
            let error = Error::run(format!("<{}> lacks its array '{name}'", section.tag));
            error.expected(format_args!("<DataArray Name=\"{name}\">"))
        })
    }

    /// The arrays of `<PointData>` or `<CellData>`; arrays of text are not among them.
    fn section(
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
                Ok(PieceArray { component_names: names.collect(), ..own })
            })
            .collect()
    }
}

/// The error for a file of this kind, with what to read in its place.
fn refusal(kind: &str, root: &Element) -> Error {
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
