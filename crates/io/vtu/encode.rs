//! The bytes of a file, by the crate vtkio: arrays as base64 text within the XML, little-endian, with sizes of 64 bits.
//!
//! vtkio's list of cell types lacks some that VTK has (15, 16, 37), and it knows no faces of polyhedra. So the section of the
//! cells is put together here, from arrays that vtkio encodes. Its compression cuts arrays into blocks of 32,768 bytes and
//! counts one too many where an array ends with a block, which no reader takes; a file with such an array stays uncompressed.

use super::contents::{Column, Contents, Precision, Role, Topology, Values};
use voltet_core::grid::code;
use voltet_core::{Error, Result};
use vtkio::model::{self, Attribute, ByteOrder, DataArray, DataSet, IOBuffer, Version, VertexNumbers, Vtk};
use vtkio::xml::{self, Compressor, Data, EncodingInfo, ScalarType};

/// The degrees of Lagrange and Bezier cells along their axes, as a cell array.
pub(super) const DEGREES: &str = "HigherOrderDegrees";

/// Bytes of a block that vtkio compresses.
const BLOCK: usize = 32768;
/// zlib's own choice between speed and size.
const LEVEL: u32 = 6;

/// A file.
pub struct Encoded {
    /// All of it.
    pub bytes: Vec<u8>,
    /// True if it is compressed.
    pub compressed: bool,
}

/// The file that holds the contents.
pub fn encode(contents: Contents, precision: Precision, compress: bool) -> Result<Encoded> {
    let Contents { points, cells, point_arrays, cell_arrays } = contents;
    let coordinates: Vec<f64> = points.iter().flat_map(|p| p.to_array()).collect();
    let points_written = buffer(Values::Floats(coordinates), precision);
    let has_degrees = cell_arrays.iter().any(|array| array.name == DEGREES);
    let lagrange =
        cells.types.iter().any(|&t| [code::LAGRANGE_HEXAHEDRON, code::BEZIER_HEXAHEDRON].contains(&t));
    let cell_count = cells.types.len();
    let sections = sections(cells, points.len());
    drop(points);
    let of =
        |arrays: Vec<Column>| arrays.into_iter().map(|array| attribute(array, precision)).collect::<Vec<_>>();
    let data = model::Attributes { point: of(point_arrays), cell: of(cell_arrays) };
    let whole_blocks = |buffer: &IOBuffer| buffer.num_bytes().is_multiple_of(BLOCK);
    let attributes = data.point.iter().chain(&data.cell);
    let compressed = compress
        && !whole_blocks(&points_written)
        && !sections.iter().any(|(_, buffer)| whole_blocks(buffer))
        && !attributes.into_iter().any(|a| matches!(a, Attribute::DataArray(a) if whole_blocks(&a.data)));
    let (compressor, compression_level) =
        if compressed { (Compressor::ZLib, LEVEL) } else { (Compressor::None, 0) };
    // Without cells, which are put in below.
    let none = VertexNumbers::XML { connectivity: Vec::new(), offsets: Vec::new() };
    let none = model::Cells { cell_verts: none, types: Vec::new() };
    let piece = model::UnstructuredGridPiece { points: points_written, cells: none, data };
    let file = Vtk {
        // From 2.1 on the nodes of a Lagrange hexahedron's edges are in the order of today; 1.0 is the first with sizes of 64 bits.
        version: if lagrange { Version::new_xml(2, 1) } else { Version::new_xml(1, 0) },
        title: String::new(),
        byte_order: ByteOrder::LittleEndian,
        data: DataSet::inline(piece),
        file_path: None,
    };
    let failed =
        |error: &dyn std::fmt::Display| Error::run("the grid cannot be put into VTK's form").got(error);
    let file = file.try_into_xml_format(compressor, compression_level).map_err(|error| failed(&error))?;
    let mut bytes = Vec::new();
    file.write(&mut bytes).map_err(|error| failed(&error))?;
    drop(file);
    let header_type = ScalarType::UInt64;
    let encoding =
        EncodingInfo { byte_order: ByteOrder::LittleEndian, header_type, compressor, compression_level };
    let mut section = String::from("<Cells>");
    for (name, buffer) in sections {
        let array = xml::DataArray::from_io_buffer(buffer, encoding).map_err(|error| failed(&error))?;
        let Some(Data::Data(text)) = array.data.first() else { return Err(failed(&"an array without data")) };
        let number_type = number_type(array.scalar_type);
        section += &format!(
            "<DataArray type=\"{number_type}\" Name=\"{name}\" format=\"binary\">{text}</DataArray>"
        );
    }
    section += "</Cells>";
    // Names and texts are escaped, so these marks are the elements.
    let cells = last(&bytes, b"<Cells>").zip(last(&bytes, b"</Cells>"));
    let (begin, end) = cells.ok_or_else(|| failed(&"no element of the cells"))?;
    bytes.splice(begin..end + b"</Cells>".len(), section.into_bytes());
    let piece = first(&bytes, b"<Piece ").ok_or_else(|| failed(&"no piece"))? + b"<Piece ".len();
    bytes.splice(piece..piece, format!("NumberOfCells=\"{cell_count}\" ").into_bytes());
    if has_degrees && let Some(at) = first(&bytes, b"<CellData") {
        let at = at + b"<CellData".len();
        bytes.splice(at..at, format!(" {DEGREES}=\"{DEGREES}\"").into_bytes());
    }
    Ok(Encoded { bytes, compressed })
}

/// Bytes that encoding takes beside the contents, which it uses up, at most: each array as text, and as text of the file. Of
/// three million tetrahedra it took 260 MiB where this says 280.
pub fn encoding_bytes(contents: &Contents) -> u64 {
    let width = |values: &Values| match values {
        Values::Floats(_) => 8,
        Values::Numbers(_) => 4,
        Values::Bytes(_) => 1,
    };
    let of = |array: &Column| width(&array.values) * array.values.len() as u64;
    let arrays: u64 = contents.point_arrays.iter().chain(&contents.cell_arrays).map(of).sum();
    let Topology { connectivity, offsets: ends, types, .. } = &contents.cells;
    let cells = if is_narrow(connectivity, contents.points.len()) { 4 } else { 8 };
    let cells = cells * (connectivity.len() + ends.len()) as u64 + types.len() as u64;
    // base64 takes four characters for three bytes.
    (24 * contents.points.len() as u64 + arrays + cells).saturating_mul(8) / 3
}

/// True if 32 bits hold all numbers of points and offsets: half of most files.
fn is_narrow(connectivity: &[u32], point_count: usize) -> bool {
    point_count.max(connectivity.len()) <= i32::MAX as usize
}

/// The arrays of the section of the cells, by name.
fn sections(cells: Topology, point_count: usize) -> Vec<(&'static str, IOBuffer)> {
    let Topology { connectivity, offsets: ends, types, polyhedra } = cells;
    let narrow = is_narrow(&connectivity, point_count);
    let whole = |numbers: Box<dyn Iterator<Item = i64>>| match narrow {
        true => IOBuffer::I32(numbers.map(|number| number as i32).collect()),
        false => IOBuffer::I64(numbers.collect()),
    };
    let cell_count = types.len();
    let mut sections = vec![
        ("connectivity", whole(Box::new(connectivity.into_iter().map(i64::from)))),
        ("offsets", whole(Box::new(ends.into_iter().map(|end| end as i64)))),
        ("types", IOBuffer::U8(types)),
    ];
    if !polyhedra.is_empty() {
        // For each polyhedron the number of its faces, and each face's points after their number; where that ends, a cell.
        let (mut faces, mut ends) = (Vec::new(), vec![-1; cell_count]);
        for polyhedron in polyhedra {
            faces.push(polyhedron.faces.len() as i64);
            for face in polyhedron.faces {
                faces.push(face.len() as i64);
                faces.extend(face.into_iter().map(i64::from));
            }
            ends[polyhedron.cell as usize] = faces.len() as i64;
        }
        sections.extend([("faces", IOBuffer::I64(faces)), ("faceoffsets", IOBuffer::I64(ends))]);
    }
    sections
}

fn attribute(array: Column, precision: Precision) -> Attribute {
    let count = array.component_count as u32;
    let elem = match (array.role, count) {
        (Role::Scalar, _) => model::ElementType::Scalars { num_comp: count, lookup_table: None },
        (Role::Vectors, 3) => model::ElementType::Vectors,
        _ => model::ElementType::Generic(count),
    };
    Attribute::DataArray(DataArray { name: array.name, elem, data: buffer(array.values, precision) })
}

fn buffer(values: Values, precision: Precision) -> IOBuffer {
    match values {
        Values::Bytes(bytes) => IOBuffer::U8(bytes),
        Values::Numbers(numbers) => match numbers.iter().all(|&number| number <= i32::MAX as u32) {
            true => IOBuffer::I32(numbers.into_iter().map(|number| number as i32).collect()),
            false => IOBuffer::I64(numbers.into_iter().map(i64::from).collect()),
        },
        Values::Floats(floats) => {
            let single = match precision {
                Precision::Single => true,
                Precision::Double => false,
                Precision::Lossless => floats.iter().all(|&x| x.is_nan() || f64::from(x as f32) == x),
            };
            match single {
                true => IOBuffer::F32(floats.into_iter().map(|x| x as f32).collect()),
                false => IOBuffer::F64(floats),
            }
        }
    }
}

/// As VTK calls it.
fn number_type(scalar_type: ScalarType) -> &'static str {
    match scalar_type {
        ScalarType::Int8 => "Int8",
        ScalarType::UInt8 => "UInt8",
        ScalarType::Int16 => "Int16",
        ScalarType::UInt16 => "UInt16",
        ScalarType::Int32 => "Int32",
        ScalarType::UInt32 => "UInt32",
        ScalarType::Int64 => "Int64",
        ScalarType::UInt64 => "UInt64",
        ScalarType::Float32 => "Float32",
        ScalarType::Float64 => "Float64",
    }
}

fn first(bytes: &[u8], mark: &[u8]) -> Option<usize> {
    bytes.windows(mark.len()).position(|part| part == mark)
}

fn last(bytes: &[u8], mark: &[u8]) -> Option<usize> {
    bytes.windows(mark.len()).rposition(|part| part == mark)
}
