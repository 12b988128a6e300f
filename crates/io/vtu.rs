//! Grids with results to VTK files (.vtu): values of a volume at the file's own points and cells, or at those of its tetrahedra, and the
//! file's bytes.
//!
//! Source: "VTK File Formats" (docs.vtk.org), section "XML File Formats". Arrays are base64 text within the XML, little-endian, with
//! sizes of 64 bits.

use crate::formats::into_set;
use flate2::Compression;
use flate2::write::ZlibEncoder;
use glam::DVec3;
use quick_xml::escape::escape;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::io::Write;
use std::sync::Arc;
use voltet_core::SharedSlice;
use voltet_core::grid::{Array, CellSet, Cells, FileCells, Grid, code};

/// The degrees of Lagrange and Bezier cells along their axes, as a cell array.
const DEGREES: &str = "HigherOrderDegrees";

/// Bytes of a compressed block.
const BLOCK: usize = 32768;

/// Contents of a file to write: points, cells and arrays.
pub struct Contents<'a> {
    grid: &'a Grid,
    source: CellSource<'a>,
    /// Positions, world units.
    pub points: SharedSlice<DVec3>,
    /// The cells.
    pub cells: CellSet,
    /// One tuple a point.
    pub point_arrays: Vec<Column>,
    /// One tuple a cell.
    pub cell_arrays: Vec<Column>,
}

/// An array by name.
#[derive(Debug, Clone)]
pub struct Column {
    /// Its name.
    pub name: String,
    /// Role of the array for other programs.
    pub role: Role,
    /// Components of a tuple.
    pub component_count: usize,
    /// Tuples side by side.
    pub values: Values,
}

/// Numbers of one type.
#[derive(Debug, Clone)]
pub enum Values {
    /// Quantities.
    Floats(Vec<f64>),
    /// Flags and small numbers.
    Bytes(Vec<u8>),
    /// Numbers of cells.
    Numbers(Vec<u32>),
}

/// Role of an array for other programs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// The scalar to show first.
    Scalar,
    /// The vectors to show first.
    Vectors,
    /// One of many.
    Plain,
}

/// Bits of a written quantity.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Precision {
    /// 32 where that keeps every value of the array, else 64.
    Lossless,
    /// 32, rounded.
    Single,
    /// 64.
    Double,
}

/// Cells to write.
#[derive(Debug, Clone, Copy)]
pub enum CellSource<'a> {
    /// The file's own.
    File(&'a FileCells),
    /// The tetrahedra that they were split into.
    Tetrahedra,
}

/// Numbers of tetrahedra that become arrays over cells.
pub enum TetrahedraSource<'a> {
    /// A cell has the largest of its tetrahedra's.
    Largest(&'a [f32]),
    /// True for tetrahedra that are left; a cell is culled (1) where none of its own is.
    Kept(&'a [bool]),
}

impl<'a> Contents<'a> {
    /// The contents without arrays, to which the others are added.
    pub fn new(grid: &'a Grid, source: CellSource<'a>) -> Contents<'a> {
        let count = grid.tetrahedra.len();
        let (points, cells) = match source {
            CellSource::File(file) => (file.points.clone(), written_cells(&file.cells)),
            CellSource::Tetrahedra => {
                let oriented = (0..count).map(|i| oriented(grid, i)).collect();
                (grid.points.clone(), into_set(Cells::Tetrahedra(oriented)))
            }
        };
        let (point_arrays, cell_arrays) = (Vec::new(), Vec::new());
        let mut contents = Contents { grid, source, points, cells, point_arrays, cell_arrays };
        match source {
            CellSource::File(file) => {
                if let Some(ghost) = &file.ghost {
                    let flags = ghost.iter().map(|&ghost| u8::from(ghost)).collect();
                    contents.add_cell_array("vtkGhostType", 1, Values::Bytes(flags));
                }
                if let Some(degrees) = &file.degrees {
                    contents.add_cell_array(DEGREES, 3, Values::Bytes(degrees.as_flattened().to_vec()));
                }
            }
            CellSource::Tetrahedra => {
                let cells = (0..count).map(|i| grid.source_cell(i) as u32).collect();
                contents.add_cell_array("file_cell", 1, Values::Numbers(cells));
            }
        }
        contents
    }

    fn add_cell_array(&mut self, name: &str, component_count: usize, values: Values) {
        self.cell_arrays.push(Column { name: name.into(), role: Role::Plain, component_count, values });
    }

    /// Adds values of the grid's points. Points of the file that no tetrahedron uses get NaN.
    pub fn add_point_values(&mut self, name: &str, role: Role, values: &[f64], component_count: usize) {
        let values = match self.source {
            CellSource::Tetrahedra => values.to_vec(),
            CellSource::File(file) => {
                let unset = vec![f64::NAN; component_count];
                let tuple = |point| match file.grid_point(point) {
                    Some(at) => &values[at * component_count..(at + 1) * component_count],
                    None => &unset,
                };
                (0..file.points.len()).flat_map(tuple).copied().collect()
            }
        };
        let (name, values) = (name.to_string(), Values::Floats(values));
        self.point_arrays.push(Column { name, role, component_count, values });
    }

    /// Adds arrays of the file's cells.
    pub fn add_cell_arrays(&mut self, arrays: &BTreeMap<String, Arc<Array>>) {
        let grid = self.grid;
        for (name, array) in arrays {
            let n = array.component_count;
            let values = match self.source {
                CellSource::File(_) => array.values.to_vec(),
                CellSource::Tetrahedra => (0..grid.tetrahedra.len())
                    .map(|i| grid.source_cell(i))
                    .flat_map(|cell| &array.values[cell * n..(cell + 1) * n])
                    .copied()
                    .collect(),
            };
            self.add_cell_array(name, n, Values::Floats(values));
        }
    }

    /// Adds numbers of tetrahedra.
    pub fn add_of_tetrahedra(&mut self, name: &str, numbers: TetrahedraSource) {
        let values = match numbers {
            TetrahedraSource::Largest(numbers) => Values::Floats(self.largest(|i| f64::from(numbers[i]))),
            TetrahedraSource::Kept(kept) => {
                let kept = self.largest(|i| f64::from(u8::from(kept[i])));
                Values::Bytes(kept.iter().map(|&kept| u8::from(kept == 0.0)).collect())
            }
        };
        self.add_cell_array(name, 1, values);
    }

    /// Largest number of each cell's tetrahedra, at least 0.
    fn largest(&self, number: impl Fn(usize) -> f64) -> Vec<f64> {
        let count = self.grid.tetrahedra.len();
        let CellSource::File(file) = self.source else { return (0..count).map(number).collect() };
        let mut cells = vec![0.0_f64; file.cells.count()];
        for i in 0..count {
            let cell = &mut cells[self.grid.source_cell(i)];
            *cell = cell.max(number(i));
        }
        cells
    }

    /// Points of the file that have no values, since no tetrahedron uses them.
    pub fn points_without_values(&self) -> usize {
        match self.source {
            CellSource::Tetrahedra => 0,
            CellSource::File(file) => {
                (0..file.points.len()).filter(|&point| file.grid_point(point).is_none()).count()
            }
        }
    }

    /// Bytes that encoding takes beside the contents, which it uses up, at most: each array as bytes, and as text of the file.
    pub fn encoding_bytes(&self) -> u64 {
        let bytes = |array: &Column| match &array.values {
            Values::Floats(floats) => 8 * floats.len() as u64,
            Values::Numbers(numbers) => 4 * numbers.len() as u64,
            Values::Bytes(bytes) => bytes.len() as u64,
        };
        let arrays: u64 = self.point_arrays.iter().chain(&self.cell_arrays).map(bytes).sum();
        let CellSet { connectivity, offsets, types, .. } = &self.cells;
        let width = if self.is_narrow() { 4 } else { 8 };
        let cells = width * (connectivity.len() + offsets.len()) as u64 + types.len() as u64;
        // base64 takes four characters for three bytes.
        (24 * self.points.len() as u64 + arrays + cells).saturating_mul(8) / 3
    }

    /// True if 32 bits hold all numbers of points and offsets: half of most files.
    fn is_narrow(&self) -> bool {
        self.points.len().max(self.cells.connectivity.len()) <= i32::MAX as usize
    }

    /// The file that holds the contents; `compress`: by zlib.
    pub fn encode(self, precision: Precision, compress: bool) -> Vec<u8> {
        let narrow = self.is_narrow();
        let Contents { points, cells, point_arrays, cell_arrays, .. } = self;
        let CellSet { connectivity, offsets, types, polyhedra } = cells;
        // From 2.1 on the nodes of a Lagrange hexahedron's edges are in the order of today; 1.0 is the first with sizes of 64 bits.
        let is_curved = |t: &u8| [code::LAGRANGE_HEXAHEDRON, code::BEZIER_HEXAHEDRON].contains(t);
        let version = if types.iter().any(is_curved) { "2.1" } else { "1.0" };
        let compressor = if compress { " compressor=\"vtkZLibDataCompressor\"" } else { "" };
        let head = format!(
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"{version}\" byte_order=\"LittleEndian\" \
             header_type=\"UInt64\"{compressor}>\n<UnstructuredGrid>\n<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n",
            points.len(),
            types.len()
        );
        let mut file = FileText { text: head, precision, compress };
        file.attributes("PointData", point_arrays);
        file.attributes("CellData", cell_arrays);
        file.text += "<Points>\n";
        let coordinates = points.iter().flat_map(|point| point.to_array()).collect();
        drop(points);
        file.array("Points", 3, Values::Floats(coordinates));
        file.text += "</Points>\n<Cells>\n";
        file.whole("connectivity", connectivity.into_iter().map(i64::from), narrow);
        file.whole("offsets", offsets.into_iter().skip(1).map(|end| end as i64), narrow);
        if !polyhedra.is_empty() {
            // For each polyhedron the number of its faces, and each face's points after their number; where that ends, a cell.
            let (mut faces, mut ends) = (Vec::new(), vec![-1; types.len()]);
            for polyhedron in polyhedra {
                faces.push(polyhedron.faces.len() as i64);
                for face in polyhedron.faces {
                    faces.push(face.len() as i64);
                    faces.extend(face.into_iter().map(i64::from));
                }
                ends[polyhedron.cell as usize] = faces.len() as i64;
            }
            file.whole("faces", faces.into_iter(), false);
            file.whole("faceoffsets", ends.into_iter(), false);
        }
        file.array("types", 1, Values::Bytes(types));
        file.text += "</Cells>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";
        file.text.into_bytes()
    }
}

/// The cells of a file; those of structured grids become hexahedra.
fn written_cells(cells: &Cells) -> CellSet {
    let mut set = into_set(cells.clone());
    if let Cells::Structured(_) = cells {
        set.types.fill(code::HEXAHEDRON);
        for corners in set.connectivity.as_chunks_mut::<8>().0 {
            corners.swap(2, 3);
            corners.swap(6, 7);
        }
    }
    // Numbers before the first cell and behind the last belong to none.
    let (begin, end) = (set.offsets[0], set.offsets[set.types.len()]);
    set.connectivity.truncate(end as usize);
    set.connectivity.drain(..begin as usize);
    set.offsets.iter_mut().for_each(|offset| *offset -= begin);
    set
}

/// A tetrahedron whose fourth corner lies on the side of the others' normal, as VTK has it.
fn oriented(grid: &Grid, i: usize) -> [u32; 4] {
    let [a, b, c, d] = grid.tetrahedra[i];
    let [p, q, r, s] = grid.corners(i);
    if (q - p).cross(r - p).dot(s - p) < 0.0 { [a, c, b, d] } else { [a, b, c, d] }
}

/// Text of a file under construction.
struct FileText {
    text: String,
    precision: Precision,
    compress: bool,
}

impl FileText {
    /// A section with arrays, and the names of those with a role.
    fn attributes(&mut self, section: &str, arrays: Vec<Column>) {
        self.text += &format!("<{section}");
        for Column { name, role, component_count, .. } in &arrays {
            let attribute = match role {
                Role::Scalar => "Scalars",
                Role::Vectors if *component_count == 3 => "Vectors",
                _ if name == DEGREES => DEGREES,
                _ => continue,
            };
            self.text += &format!(" {attribute}=\"{}\"", escape(name));
        }
        self.text += ">\n";
        for Column { name, component_count, values, .. } in arrays {
            self.array(&name, component_count, values);
        }
        self.text += &format!("</{section}>\n");
    }

    fn array(&mut self, name: &str, component_count: usize, values: Values) {
        match values {
            Values::Bytes(bytes) => self.bytes(name, component_count, "UInt8", bytes),
            Values::Numbers(numbers) => {
                let narrow = numbers.iter().all(|&number| number <= i32::MAX as u32);
                self.whole(name, numbers.into_iter().map(i64::from), narrow);
            }
            Values::Floats(floats) => {
                let single = match self.precision {
                    Precision::Single => true,
                    Precision::Double => false,
                    Precision::Lossless => floats.iter().all(|&x| x.is_nan() || f64::from(x as f32) == x),
                };
                let (number_type, bytes) = match single {
                    true => ("Float32", floats.iter().flat_map(|&x| (x as f32).to_le_bytes()).collect()),
                    false => ("Float64", floats.iter().flat_map(|x| x.to_le_bytes()).collect()),
                };
                drop(floats);
                self.bytes(name, component_count, number_type, bytes);
            }
        }
    }

    /// An array of whole numbers, one a tuple, which 32 bits hold if it is narrow.
    fn whole(&mut self, name: &str, numbers: impl Iterator<Item = i64>, narrow: bool) {
        match narrow {
            true => self.bytes(name, 1, "Int32", numbers.flat_map(|n| (n as i32).to_le_bytes()).collect()),
            false => self.bytes(name, 1, "Int64", numbers.flat_map(i64::to_le_bytes).collect()),
        }
    }

    /// An array by its bytes: their count and all of them, or the table of compressed blocks and these.
    fn bytes(&mut self, name: &str, component_count: usize, number_type: &str, bytes: Vec<u8>) {
        self.text += &format!(
            "<DataArray type=\"{number_type}\" Name=\"{}\" NumberOfComponents=\"{component_count}\" format=\"binary\">",
            escape(name)
        );
        let base64 = base64_simd::STANDARD;
        if self.compress {
            let blocks: Vec<Vec<u8>> = bytes.par_chunks(BLOCK).map(compressed).collect();
            let sizes =
                [blocks.len(), BLOCK, bytes.len() % BLOCK].into_iter().chain(blocks.iter().map(Vec::len));
            let table: Vec<u8> = sizes.flat_map(|size| (size as u64).to_le_bytes()).collect();
            base64.encode_append(table, &mut self.text);
            base64.encode_append(blocks.concat(), &mut self.text);
        } else {
            let mut whole = (bytes.len() as u64).to_le_bytes().to_vec();
            whole.extend(bytes);
            base64.encode_append(whole, &mut self.text);
        }
        self.text += "</DataArray>\n";
    }
}

fn compressed(block: &[u8]) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
    let written = encoder.write_all(block).and_then(|()| encoder.finish());
    written.expect("memory takes every byte")
}
