//! The bytes of a file: arrays as base64 text within the XML, with sizes of 64 bits.

use super::contents::{Column, Contents, Precision, Role, Topology, Values};
use flate2::{Compression, write::ZlibEncoder};
use quick_xml::escape::escape;
use rayon::prelude::*;
use std::io::Write;
use voltet_core::grid::code;

/// The degrees of Lagrange and Bezier cells along their axes, as a cell array.
pub(super) const DEGREES: &str = "HigherOrderDegrees";

/// Bytes of a block that is compressed.
const BLOCK: usize = 32768;

/// The file that holds the contents.
pub fn encode(contents: Contents, precision: Precision, compress: bool) -> Vec<u8> {
    let Contents { points, cells, point_arrays, cell_arrays } = contents;
    // From 2.1 on the nodes of a Lagrange hexahedron's edges are in the order of today; 1.0 is the first with sizes of 64 bits.
    let of_today = [code::LAGRANGE_HEXAHEDRON, code::BEZIER_HEXAHEDRON];
    let version = if cells.types.iter().any(|t| of_today.contains(t)) { "2.1" } else { "1.0" };
    let byte_order = if cfg!(target_endian = "big") { "BigEndian" } else { "LittleEndian" };
    let compressor = if compress { " compressor=\"vtkZLibDataCompressor\"" } else { "" };
    let mut file = File { text: String::new(), compress };
    file.text += &format!(
        "<VTKFile type=\"UnstructuredGrid\" version=\"{version}\" byte_order=\"{byte_order}\" header_type=\"UInt64\"{compressor}>\
         <UnstructuredGrid><Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">",
        points.len(),
        cells.types.len(),
    );
    file.section("PointData", point_arrays, precision);
    file.section("CellData", cell_arrays, precision);
    file.text += "<Points>";
    let coordinates = points.iter().flat_map(|p| p.to_array()).collect();
    let point_count = points.len();
    drop(points);
    file.array("Points", 3, &Numbers::of(Values::Floats(coordinates), precision));
    file.text += "</Points><Cells>";
    for (name, numbers) in cell_arrays_of(cells, point_count) {
        file.array(name, 1, &numbers);
    }
    file.text += "</Cells></Piece></UnstructuredGrid></VTKFile>";
    file.text.into_bytes()
}

/// Bytes that encoding takes beside the contents, which it uses up, at most: the file, and what it was copied from when it grew.
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

/// A file in the making.
struct File {
    text: String,
    compress: bool,
}

impl File {
    /// Adds a section of arrays that have a value a point or a cell.
    fn section(&mut self, section: &str, arrays: Vec<Column>, precision: Precision) {
        self.text += &format!("<{section}");
        let mut attribute = |attribute: &str, array: Option<&Column>| {
            if let Some(array) = array {
                self.text += &format!(" {attribute}=\"{}\"", escape(&array.name));
            }
        };
        let is_vectors = |array: &&Column| array.role == Role::Vectors && array.component_count == 3;
        attribute("Scalars", arrays.iter().find(|array| array.role == Role::Scalar));
        attribute("Vectors", arrays.iter().find(is_vectors));
        attribute(DEGREES, arrays.iter().find(|array| array.name == DEGREES));
        self.text += ">";
        for Column { name, component_count, values, .. } in arrays {
            self.array(&name, component_count, &Numbers::of(values, precision));
        }
        self.text += &format!("</{section}>");
    }

    /// Adds an array.
    fn array(&mut self, name: &str, component_count: usize, numbers: &Numbers) {
        let (number_type, bytes) = numbers.bytes();
        let components = match component_count {
            1 => String::new(),
            count => format!(" NumberOfComponents=\"{count}\""),
        };
        self.text += &format!(
            "<DataArray type=\"{number_type}\" Name=\"{}\"{components} format=\"binary\">",
            escape(name)
        );
        if self.compress {
            // Sizes first, in a text of their own: of the blocks, of each but the last, of the last if it is shorter, and of
            // each when compressed.
            let blocks: Vec<Vec<u8>> = bytes.par_chunks(BLOCK).map(compressed).collect();
            let mut sizes = vec![blocks.len() as u64, BLOCK as u64, (bytes.len() % BLOCK) as u64];
            sizes.extend(blocks.iter().map(|block| block.len() as u64));
            self.base64(bytemuck::cast_slice(&sizes));
            self.base64(&blocks.concat());
        } else {
            self.base64(&[&(bytes.len() as u64).to_ne_bytes(), bytes].concat());
        }
        self.text += "</DataArray>";
    }

    /// Adds bytes as text.
    fn base64(&mut self, bytes: &[u8]) {
        base64_simd::STANDARD.encode_append(bytes, &mut self.text);
    }
}

/// A block by zlib, at its own choice between speed and size.
fn compressed(block: &[u8]) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(block).and_then(|()| encoder.finish()).expect("memory takes all that is written")
}

/// The arrays of the section of the cells, by name.
fn cell_arrays_of(cells: Topology, point_count: usize) -> Vec<(&'static str, Numbers)> {
    let Topology { connectivity, offsets: ends, types, polyhedra } = cells;
    let narrow = is_narrow(&connectivity, point_count);
    let whole = |numbers: Box<dyn Iterator<Item = i64>>| match narrow {
        true => Numbers::I32(numbers.map(|number| number as i32).collect()),
        false => Numbers::I64(numbers.collect()),
    };
    let cell_count = types.len();
    let mut arrays = vec![
        ("connectivity", whole(Box::new(connectivity.into_iter().map(i64::from)))),
        ("offsets", whole(Box::new(ends.into_iter().map(|end| end as i64)))),
        ("types", Numbers::U8(types)),
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
        arrays.extend([("faces", Numbers::I64(faces)), ("faceoffsets", Numbers::I64(ends))]);
    }
    arrays
}

/// Numbers as the file has them.
enum Numbers {
    U8(Vec<u8>),
    I32(Vec<i32>),
    I64(Vec<i64>),
    F32(Vec<f32>),
    F64(Vec<f64>),
}

impl Numbers {
    fn of(values: Values, precision: Precision) -> Self {
        match values {
            Values::Bytes(bytes) => Numbers::U8(bytes),
            Values::Numbers(numbers) => match numbers.iter().all(|&number| number <= i32::MAX as u32) {
                true => Numbers::I32(numbers.into_iter().map(|number| number as i32).collect()),
                false => Numbers::I64(numbers.into_iter().map(i64::from).collect()),
            },
            Values::Floats(floats) => {
                let single = match precision {
                    Precision::Single => true,
                    Precision::Double => false,
                    Precision::Lossless => floats.iter().all(|&x| x.is_nan() || f64::from(x as f32) == x),
                };
                match single {
                    true => Numbers::F32(floats.into_iter().map(|x| x as f32).collect()),
                    false => Numbers::F64(floats),
                }
            }
        }
    }

    /// Their type as VTK calls it, and their bytes.
    fn bytes(&self) -> (&'static str, &[u8]) {
        match self {
            Numbers::U8(numbers) => ("UInt8", numbers),
            Numbers::I32(numbers) => ("Int32", bytemuck::cast_slice(numbers)),
            Numbers::I64(numbers) => ("Int64", bytemuck::cast_slice(numbers)),
            Numbers::F32(numbers) => ("Float32", bytemuck::cast_slice(numbers)),
            Numbers::F64(numbers) => ("Float64", bytemuck::cast_slice(numbers)),
        }
    }
}
