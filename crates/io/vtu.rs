//! Grids with results to VTK files (.vtu).

use glam::DVec3;
use std::collections::BTreeMap;
use std::sync::Arc;
use voltet_core::grid::{Array, CellSet, Cells, FileCells, Grid, Polyhedron, code};
use voltet_core::{Error, Result, SharedSlice};
use vtkio::model::{Attribute, ByteOrder, DataArray, DataSet, IOBuffer, Version, VertexNumbers, Vtk};
use vtkio::xml::{Compressor, Data, EncodingInfo, ScalarType};
use vtkio::{model, xml};

/// Points, cells and arrays.
#[derive(Debug, Clone)]
pub struct Contents {
    /// Positions, world units.
    pub points: SharedSlice<DVec3>,
    /// The cells.
    pub cells: Topology,
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

/// Cells as a file lists them.
#[derive(Debug, Clone, Default)]
pub struct Topology {
    /// Point numbers of all cells, one after the other.
    pub connectivity: Vec<u32>,
    /// End of each cell's part.
    pub offsets: Vec<u64>,
    /// VTK type codes.
    pub types: Vec<u8>,
    /// Faces of the polyhedra.
    pub polyhedra: Vec<Polyhedron>,
}

impl Topology {
    /// Tetrahedra.
    pub fn of_tetrahedra(tetrahedra: &[[u32; 4]]) -> Self {
        Topology {
            connectivity: tetrahedra.as_flattened().to_vec(),
            offsets: (1..=tetrahedra.len() as u64).map(|i| 4 * i).collect(),
            types: vec![code::TETRA; tetrahedra.len()],
            polyhedra: Vec::new(),
        }
    }

    /// The cells of a file; those of structured grids become hexahedra.
    pub fn of_cells(cells: &Cells) -> Self {
        match cells {
            Cells::Tetrahedra(own) => Self::of_tetrahedra(own),
            Cells::Mixed(CellSet { types, offsets, connectivity, polyhedra }) => Topology {
                // What stands before the first cell and behind the last belongs to none.
                connectivity: connectivity[offsets[0] as usize..offsets[types.len()] as usize].to_vec(),
                offsets: offsets[1..].iter().map(|end| end - offsets[0]).collect(),
                types: types.clone(),
                polyhedra: polyhedra.clone(),
            },
            &Cells::Structured(points) => {
                let count = cells.count();
                Topology {
                    connectivity: (0..count).flat_map(|i| hexahedron(points, i)).collect(),
                    offsets: (1..=count as u64).map(|i| 8 * i).collect(),
                    types: vec![code::HEXAHEDRON; count],
                    polyhedra: Vec::new(),
                }
            }
        }
    }
}

/// The corners of a cell of a structured grid with so many points along its axes, in VTK's order of a hexahedron.
fn hexahedron([nx, ny, _]: [usize; 3], number: usize) -> [u32; 8] {
    let (i, rest) = (number % (nx - 1), number / (nx - 1));
    let (j, k) = (rest % (ny - 1), rest / (ny - 1));
    let at = |[di, dj, dk]: [usize; 3]| ((i + di) + nx * ((j + dj) + ny * (k + dk))) as u32;
    [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]].map(at)
}

impl Values {
    /// Their number.
    pub fn len(&self) -> usize {
        match self {
            Values::Floats(floats) => floats.len(),
            Values::Bytes(bytes) => bytes.len(),
            Values::Numbers(numbers) => numbers.len(),
        }
    }

    /// True if there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
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

/// The contents without arrays, to which the others are added.
pub fn gather(grid: &Grid, form: CellSource) -> Contents {
    match form {
        CellSource::File(file) => {
            let mut cell_arrays = Vec::new();
            if let Some(ghost) = &file.ghost {
                let flags = ghost.iter().map(|&ghost| u8::from(ghost)).collect();
                cell_arrays.push(Column::plain("vtkGhostType", 1, Values::Bytes(flags)));
            }
            if let Some(degrees) = &file.degrees {
                let degrees = degrees.as_flattened().to_vec();
                cell_arrays.push(Column::plain(DEGREES, 3, Values::Bytes(degrees)));
            }
            let (points, cells) = (file.points.clone(), Topology::of_cells(&file.cells));
            Contents { points, cells, point_arrays: Vec::new(), cell_arrays }
        }
        CellSource::Tetrahedra => {
            let oriented: Vec<[u32; 4]> = (0..grid.tetrahedra.len()).map(|i| oriented(grid, i)).collect();
            let cells = (0..grid.tetrahedra.len()).map(|i| grid.source_cell(i) as u32).collect();
            Contents {
                points: grid.points.clone(),
                cells: Topology::of_tetrahedra(&oriented),
                point_arrays: Vec::new(),
                cell_arrays: vec![Column::plain("file_cell", 1, Values::Numbers(cells))],
            }
        }
    }
}

impl Column {
    fn plain(name: &str, component_count: usize, values: Values) -> Column {
        Column { name: name.into(), role: Role::Plain, component_count, values }
    }
}

/// A tetrahedron whose fourth corner lies on the side of the others' normal, as VTK has it.
fn oriented(grid: &Grid, i: usize) -> [u32; 4] {
    let [a, b, c, d] = grid.tetrahedra[i];
    let [p, q, r, s] = grid.corners(i);
    if (q - p).cross(r - p).dot(s - p) < 0.0 { [a, c, b, d] } else { [a, b, c, d] }
}

impl Contents {
    /// Adds values of the grid's points. Points of the file that no tetrahedron uses get NaN.
    pub fn add_point_values(
        &mut self,
        form: CellSource,
        name: &str,
        role: Role,
        values: &[f64],
        components: usize,
    ) {
        let values = match form {
            CellSource::Tetrahedra => values.to_vec(),
            CellSource::File(file) => {
                let mut own = Vec::with_capacity(file.points.len() * components);
                for point in 0..file.points.len() {
                    match file.grid_point(point) {
                        Some(at) => own.extend_from_slice(&values[at * components..(at + 1) * components]),
                        None => own.extend(std::iter::repeat_n(f64::NAN, components)),
                    }
                }
                own
            }
        };
        let (name, values) = (name.to_string(), Values::Floats(values));
        self.point_arrays.push(Column { name, role, component_count: components, values });
    }

    /// Adds arrays of the file's cells.
    pub fn add_cell_arrays(&mut self, grid: &Grid, form: CellSource, arrays: &BTreeMap<String, Arc<Array>>) {
        for (name, array) in arrays {
            let n = array.component_count;
            let values = match form {
                CellSource::File(_) => array.values.to_vec(),
                CellSource::Tetrahedra => (0..grid.tetrahedra.len())
                    .map(|i| grid.source_cell(i))
                    .flat_map(|cell| &array.values[cell * n..(cell + 1) * n])
                    .copied()
                    .collect(),
            };
            self.cell_arrays.push(Column::plain(name, n, Values::Floats(values)));
        }
    }

    /// Adds numbers of tetrahedra.
    pub fn add_of_tetrahedra(
        &mut self,
        grid: &Grid,
        form: CellSource,
        name: &str,
        numbers: TetrahedraSource,
    ) {
        // Of each cell the largest of its tetrahedra's.
        let largest = |of: &dyn Fn(usize) -> f64, least: f64| -> Vec<f64> {
            let count = grid.tetrahedra.len();
            let CellSource::File(file) = form else { return (0..count).map(of).collect() };
            let mut cells = vec![least; file.cells.count()];
            for i in 0..count {
                let cell = &mut cells[grid.source_cell(i)];
                *cell = cell.max(of(i));
            }
            cells
        };
        let values = match numbers {
            TetrahedraSource::Largest(numbers) => Values::Floats(largest(&|i| f64::from(numbers[i]), 0.0)),
            TetrahedraSource::Kept(kept) => {
                let kept = largest(&|i| f64::from(u8::from(kept[i])), 0.0);
                Values::Bytes(kept.iter().map(|&kept| u8::from(kept == 0.0)).collect())
            }
        };
        self.cell_arrays.push(Column::plain(name, 1, values));
    }

    /// Points of the file that have no values, since no tetrahedron uses them.
    pub fn points_without_values(form: CellSource) -> usize {
        match form {
            CellSource::Tetrahedra => 0,
            CellSource::File(file) => {
                (0..file.points.len()).filter(|&p| file.grid_point(p).is_none()).count()
            }
        }
    }
}

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
