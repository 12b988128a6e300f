//! VTK files of unstructured grids (.vtu): XML with the arrays in base64, each where it is declared.
//!
//! Source: VTK File Formats, section "XML File Formats" (docs.vtk.org), and vtkXMLWriter of VTK 9: an array is its number of bytes and
//! its bytes; a compressed one the number of blocks, their size, that of the last (0 where it is whole), the size of each compressed
//! block, and the blocks.

use super::contents::{Column, Contents, WrittenCells};
use super::numbers::{Numbers, WrittenType};
use base64_simd::STANDARD;
use flate2::Compression;
use flate2::write::ZlibEncoder;
use rayon::prelude::*;
use std::io::{self, Write};
use voltet_core::grid::{Polyhedron, code};

/// Bytes of a block that is compressed, as in VTK's own writer.
const BLOCK: usize = 32768;
/// zlib's own choice between speed and size.
const LEVEL: Compression = Compression::new(6);
/// Numbers that are put into base64 at a time.
const PART: usize = 1 << 15;

pub(super) fn write(contents: &Contents, is_compressed: bool, out: &mut dyn Write) -> io::Result<()> {
    // From 2.1 on the nodes of a Lagrange hexahedron's edges are in the order of today; 1.0 is the first with sizes of 64 bits.
    let has_new_order = contents
        .cells
        .types
        .iter()
        .any(|&cell| [code::LAGRANGE_HEXAHEDRON, code::BEZIER_HEXAHEDRON].contains(&cell));
    let version = if has_new_order { "2.1" } else { "1.0" };
    let compressor = if is_compressed { " compressor=\"vtkZLibDataCompressor\"" } else { "" };
    write!(
        out,
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"{version}\" byte_order=\"LittleEndian\" \
         header_type=\"UInt64\"{compressor}>\n<UnstructuredGrid>\n"
    )?;
    if let Some(time) = contents.time() {
        write!(
            out,
            "<FieldData>\n<DataArray type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" format=\"ascii\">{time:?}\
             </DataArray>\n</FieldData>\n"
        )?;
    }
    let (points, cells) = (contents.point_count(), contents.cell_count());
    writeln!(out, "<Piece NumberOfPoints=\"{points}\" NumberOfCells=\"{cells}\">")?;
    let mut writer = ArrayWriter { out, is_compressed };
    writer.section("PointData", &contents.point_arrays)?;
    writer.section("CellData", &contents.cell_arrays)?;
    writer.out.write_all(b"<Points>\n")?;
    writer.array("Points", 3, &contents.points)?;
    writer.out.write_all(b"</Points>\n<Cells>\n")?;
    for (name, numbers) in cell_arrays(&contents.cells, points) {
        writer.array(name, 1, &numbers)?;
    }
    writer.out.write_all(b"</Cells>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n")
}

/// The arrays of the section of the cells, by name.
fn cell_arrays<'a>(cells: &'a WrittenCells, point_count: usize) -> Vec<(&'static str, Numbers<'a>)> {
    let WrittenCells { types, offsets, connectivity, polyhedra } = cells;
    // Half of most files.
    let narrow = point_count.max(connectivity.len()) <= i32::MAX as usize;
    let mut arrays = vec![
        ("connectivity", Numbers::indices(&connectivity[..], narrow)),
        ("offsets", Numbers::offsets(&offsets[1..], narrow)),
        ("types", Numbers::flags(&types[..])),
    ];
    if !polyhedra.is_empty() {
        let (faces, ends) = faces(polyhedra, types.len());
        arrays.extend([("faces", Numbers::signed(faces)), ("faceoffsets", Numbers::signed(ends))]);
    }
    arrays
}

/// For each polyhedron the number of its faces, and each face's points after their number; and where that ends, for each cell.
fn faces(polyhedra: &[Polyhedron], cell_count: usize) -> (Vec<i64>, Vec<i64>) {
    let (mut faces, mut ends) = (Vec::new(), vec![-1; cell_count]);
    for polyhedron in polyhedra {
        faces.push(polyhedron.faces.len() as i64);
        for face in &polyhedron.faces {
            faces.push(face.len() as i64);
            faces.extend(face.iter().copied().map(i64::from));
        }
        ends[polyhedron.cell as usize] = faces.len() as i64;
    }
    (faces, ends)
}

struct ArrayWriter<'a> {
    out: &'a mut dyn Write,
    is_compressed: bool,
}

impl ArrayWriter<'_> {
    fn section(&mut self, name: &str, arrays: &[Column]) -> io::Result<()> {
        write!(self.out, "<{name}")?;
        for array in arrays {
            if let Some(role) = array.role.name() {
                write!(self.out, " {role}=\"{}\"", escaped(&array.name))?;
            }
        }
        self.out.write_all(b">\n")?;
        for array in arrays {
            self.array(&array.name, array.component_count, &array.numbers)?;
        }
        writeln!(self.out, "</{name}>")
    }

    fn array(&mut self, name: &str, component_count: usize, numbers: &Numbers) -> io::Result<()> {
        let (name, number_type) = (escaped(name), type_name(numbers.number_type));
        write!(
            self.out,
            "<DataArray type=\"{number_type}\" Name=\"{name}\" NumberOfComponents=\"{component_count}\" format=\"binary\">"
        )?;
        match self.is_compressed {
            true => self.compressed(numbers)?,
            false => self.plain(numbers)?,
        }
        self.out.write_all(b"</DataArray>\n")
    }

    fn plain(&mut self, numbers: &Numbers) -> io::Result<()> {
        let mut base64 = Base64::new(self.out);
        base64.bytes.extend(numbers.byte_count().to_le_bytes());
        let count = numbers.count();
        for start in (0..count).step_by(PART) {
            numbers.append(start..count.min(start + PART), &mut base64.bytes);
            base64.write()?;
        }
        base64.end()
    }

    fn compressed(&mut self, numbers: &Numbers) -> io::Result<()> {
        let (count, in_block) = (numbers.count(), BLOCK / numbers.number_type.size());
        let compress = |block: usize| {
            let (mut bytes, start) = (Vec::with_capacity(BLOCK), block * in_block);
            numbers.append(start..count.min(start + in_block), &mut bytes);
            let mut encoder = ZlibEncoder::new(Vec::new(), LEVEL);
            encoder.write_all(&bytes)?;
            encoder.finish()
        };
        let block_count = count.div_ceil(in_block);
        let blocks: Vec<Vec<u8>> =
            (0..block_count).into_par_iter().map(compress).collect::<io::Result<_>>()?;
        let last = numbers.byte_count() % BLOCK as u64;
        let sizes = blocks.iter().map(|block| block.len() as u64);
        let header = [block_count as u64, BLOCK as u64, last].into_iter().chain(sizes);
        let mut base64 = Base64::new(self.out);
        base64.bytes.extend(header.flat_map(u64::to_le_bytes));
        base64.end()?;
        for block in blocks {
            base64.bytes.extend(block);
            base64.write()?;
        }
        base64.end()
    }
}

/// Writer of bytes in base64.
struct Base64<'a> {
    out: &'a mut dyn Write,
    bytes: Vec<u8>,
    text: Vec<u8>,
}

impl<'a> Base64<'a> {
    fn new(out: &'a mut dyn Write) -> Base64<'a> {
        Base64 { out, bytes: Vec::new(), text: Vec::new() }
    }

    /// Writes the bytes but for one or two, which begin the next group of three.
    fn write(&mut self) -> io::Result<()> {
        self.encode(self.bytes.len() / 3 * 3)
    }

    /// Writes all bytes; the next ones begin anew.
    fn end(&mut self) -> io::Result<()> {
        self.encode(self.bytes.len())
    }

    fn encode(&mut self, count: usize) -> io::Result<()> {
        self.text.clear();
        STANDARD.encode_append(&self.bytes[..count], &mut self.text);
        self.bytes.drain(..count);
        self.out.write_all(&self.text)
    }
}

/// VTK's name of a number type.
fn type_name(number_type: WrittenType) -> &'static str {
    match number_type {
        WrittenType::U8 => "UInt8",
        WrittenType::I32 => "Int32",
        WrittenType::I64 => "Int64",
        WrittenType::F32 => "Float32",
        WrittenType::F64 => "Float64",
    }
}

/// A name within an attribute. White space would be read as blanks.
fn escaped(name: &str) -> String {
    let name = quick_xml::escape::escape(name);
    name.replace('\n', "&#10;").replace('\r', "&#13;").replace('\t', "&#9;")
}
