//! Grids with results to VTK files (.vtu).

use glam::DVec3;
use std::sync::Arc;
use voltet_core::grid::{Array, CellSet, Cells, FileCells, Grid, code, into_set};
use voltet_core::{Error, Result, SharedSlice};
use vtkio::model::{Attribute, ByteOrder, DataArray, DataSet, IOBuffer, Version, VertexNumbers, Vtk};
use vtkio::xml::{Compressor, Data, EncodingInfo, ScalarType};
use vtkio::{model, xml};

/// Points, cells and arrays.
pub struct Contents<'a> {
    grid: &'a Grid,
    /// The file whose cells are written; `None`: the tetrahedra that they were split into.
    file: Option<&'a FileCells>,
    /// Positions, world units.
    pub points: SharedSlice<DVec3>,
    /// The cells; none before the first offset.
    pub cells: CellSet,
    /// One tuple a point.
    pub point_arrays: Vec<Column>,
    /// One tuple a cell.
    pub cell_arrays: Vec<Column>,
}

/// An array by name.
pub struct Column {
    /// Its name.
    pub name: String,
    role: Role,
    component_count: usize,
    /// Tuples side by side; quantities in 64 bits.
    values: IOBuffer,
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

/// A tetrahedron whose fourth corner lies on the side of the others' normal, as VTK has it.
fn oriented(grid: &Grid, i: usize) -> [u32; 4] {
    let [a, b, c, d] = grid.tetrahedra[i];
    let [p, q, r, s] = grid.corners(i);
    if (q - p).cross(r - p).dot(s - p) < 0.0 { [a, c, b, d] } else { [a, b, c, d] }
}

/// Cell numbers in 32 bits where they fit.
fn cell_numbers(numbers: Vec<u32>) -> IOBuffer {
    match numbers.iter().all(|&number| number <= i32::MAX as u32) {
        true => IOBuffer::I32(numbers.into_iter().map(|number| number as i32).collect()),
        false => IOBuffer::I64(numbers.into_iter().map(i64::from).collect()),
    }
}

impl<'a> Contents<'a> {
    /// The cells of `file`, those of structured grids as hexahedra, or where there is none the tetrahedra of the grid; with the arrays
    /// that belong to them, and no others.
    pub fn new(grid: &'a Grid, file: Option<&'a FileCells>) -> Contents<'a> {
        let (points, cells) = match file {
            None => {
                let oriented = (0..grid.tetrahedra.len()).map(|i| oriented(grid, i)).collect();
                (&grid.points, into_set(Cells::Tetrahedra(oriented), code::HEXAHEDRON))
            }
            Some(file) => match &file.cells {
                Cells::Mixed(CellSet { types, offsets, connectivity, polyhedra }) => {
                    // What stands before the first cell and behind the last belongs to none.
                    let used = offsets[0] as usize..offsets[types.len()] as usize;
                    let cells = CellSet {
                        connectivity: connectivity[used].to_vec(),
                        offsets: offsets.iter().map(|end| end - offsets[0]).collect(),
                        types: types.clone(),
                        polyhedra: polyhedra.clone(),
                    };
                    (&file.points, cells)
                }
                cells => (&file.points, into_set(cells.clone(), code::HEXAHEDRON)),
            },
        };
        let (point_arrays, cell_arrays, points) = (Vec::new(), Vec::new(), points.clone());
        let mut contents = Contents { grid, file, points, cells, point_arrays, cell_arrays };
        let Some(file) = file else {
            let cells = (0..grid.tetrahedra.len()).map(|i| grid.source_cell(i) as u32).collect();
            contents.add_to_cells("file_cell", 1, cell_numbers(cells));
            return contents;
        };
        if let Some(ghost) = &file.ghost {
            contents.add_to_cells("vtkGhostType", 1, IOBuffer::U8(ghost.clone()));
        }
        if let Some(degrees) = &file.degrees {
            contents.add_to_cells(DEGREES, 3, IOBuffer::U8(degrees.as_flattened().to_vec()));
        }
        contents
    }

    fn add_to_cells(&mut self, name: &str, component_count: usize, values: IOBuffer) {
        let name = name.to_string();
        self.cell_arrays.push(Column { name, role: Role::Plain, component_count, values });
    }

    /// Adds values of the grid's points. Points of the file that no tetrahedron uses get NaN.
    pub fn add_point_values(&mut self, name: &str, role: Role, values: &[f64], component_count: usize) {
        let n = component_count;
        let values = match self.file {
            None => values.to_vec(),
            Some(file) => {
                let mut own = Vec::with_capacity(file.points.len() * n);
                for point in 0..file.points.len() {
                    match file.grid_point(point) {
                        Some(at) => own.extend_from_slice(&values[at * n..(at + 1) * n]),
                        None => own.extend(std::iter::repeat_n(f64::NAN, n)),
                    }
                }
                own
            }
        };
        let (name, values) = (name.to_string(), IOBuffer::F64(values));
        self.point_arrays.push(Column { name, role, component_count, values });
    }

    /// Adds arrays of the file's cells.
    pub fn add_cell_arrays<'b>(&mut self, arrays: impl Iterator<Item = (&'b String, &'b Arc<Array>)>) {
        let grid = self.grid;
        for (name, array) in arrays {
            let n = array.component_count;
            let values = match self.file {
                Some(_) => array.values.to_vec(),
                None => (0..grid.tetrahedra.len())
                    .map(|i| grid.source_cell(i))
                    .flat_map(|cell| &array.values[cell * n..(cell + 1) * n])
                    .copied()
                    .collect(),
            };
            self.add_to_cells(name, n, IOBuffer::F64(values));
        }
    }

    /// Adds numbers of tetrahedra, none negative. A cell has the largest of its tetrahedra's.
    pub fn add_tetrahedra_values(&mut self, name: &str, numbers: &[f32]) {
        let values = self.largest_in_cells(|i| f64::from(numbers[i]));
        self.add_to_cells(name, 1, IOBuffer::F64(values));
    }

    /// Adds flags of culled cells (1), none of whose tetrahedra is `kept`.
    pub fn add_culled(&mut self, name: &str, kept: &[bool]) {
        let kept = self.largest_in_cells(|i| f64::from(u8::from(kept[i])));
        let culled = kept.iter().map(|&kept| u8::from(kept == 0.0)).collect();
        self.add_to_cells(name, 1, IOBuffer::U8(culled));
    }

    /// The largest value of each cell's tetrahedra, at least 0.
    fn largest_in_cells(&self, value: impl Fn(usize) -> f64) -> Vec<f64> {
        let count = self.grid.tetrahedra.len();
        let Some(file) = self.file else { return (0..count).map(value).collect() };
        let mut cells = vec![0.0; file.cells.count()];
        for i in 0..count {
            let cell: &mut f64 = &mut cells[self.grid.source_cell(i)];
            *cell = cell.max(value(i));
        }
        cells
    }

    /// Points of the file that have no values, since no tetrahedron uses them.
    pub fn points_without_values(&self) -> usize {
        self.file.map_or(0, |file| (0..file.points.len()).filter(|&p| file.grid_point(p).is_none()).count())
    }
}

/// The degrees of Lagrange and Bezier cells along their axes, as a cell array.
const DEGREES: &str = "HigherOrderDegrees";

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
    let Contents { points, cells, point_arrays, cell_arrays, .. } = contents;
    let coordinates: Vec<f64> = points.iter().flat_map(|p| p.to_array()).collect();
    let points_written = buffer(IOBuffer::F64(coordinates), precision);
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
        // The variants bear VTK's names.
        section += &format!(
            "<DataArray type=\"{:?}\" Name=\"{name}\" format=\"binary\">{text}</DataArray>",
            array.scalar_type
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
    let arrays = contents.point_arrays.iter().chain(&contents.cell_arrays);
    let arrays: usize = arrays.map(|array| array.values.num_bytes()).sum();
    let CellSet { connectivity, types, .. } = &contents.cells;
    let width = if is_narrow(connectivity, contents.points.len()) { 4 } else { 8 };
    let cells = width * (connectivity.len() + types.len()) + types.len();
    // base64 takes four characters for three bytes.
    ((24 * contents.points.len() + arrays + cells) as u64).saturating_mul(8) / 3
}

/// True if 32 bits hold all numbers of points and offsets: half of most files.
fn is_narrow(connectivity: &[u32], point_count: usize) -> bool {
    point_count.max(connectivity.len()) <= i32::MAX as usize
}

/// The arrays of the section of the cells, by name.
fn sections(cells: CellSet, point_count: usize) -> Vec<(&'static str, IOBuffer)> {
    let CellSet { connectivity, offsets, types, polyhedra } = cells;
    let narrow = is_narrow(&connectivity, point_count);
    let whole = |numbers: Box<dyn Iterator<Item = i64>>| match narrow {
        true => IOBuffer::I32(numbers.map(|number| number as i32).collect()),
        false => IOBuffer::I64(numbers.collect()),
    };
    let cell_count = types.len();
    let mut sections = vec![
        ("connectivity", whole(Box::new(connectivity.into_iter().map(i64::from)))),
        ("offsets", whole(Box::new(offsets.into_iter().skip(1).map(|end| end as i64)))),
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

/// Quantities in the bits that are asked for; flags and numbers as they are.
fn buffer(values: IOBuffer, precision: Precision) -> IOBuffer {
    let IOBuffer::F64(floats) = values else { return values };
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

fn first(bytes: &[u8], mark: &[u8]) -> Option<usize> {
    bytes.windows(mark.len()).position(|part| part == mark)
}

fn last(bytes: &[u8], mark: &[u8]) -> Option<usize> {
    bytes.windows(mark.len()).rposition(|part| part == mark)
}
