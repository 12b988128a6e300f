//! Element types of Exodus as cells of VTK, and the points and cells of a file.
//!
//! Node orders: Exodus II manual (Schoof, Yarberry, SAND92-2137, 2006), figure 4.2, against VTK's, as vtkExodusIIReader turns one into
//! the other. An element with nodes that VTK's cell lacks (in faces or the middle) becomes the cell without these.

use crate::formats::contents::{Meter, Stored};
use crate::formats::lazy::tetrahedra;
use crate::formats::node_orders::{HEXAHEDRON, IN_ORDER, WEDGE};
use glam::DVec3;
use rayon::prelude::*;
use voltet_core::grid::{CellSet, CellType, Cells, code};
use voltet_core::progress::{Progress, refuse_beyond_memory};
use voltet_core::{Error, Result, counted};

/// A cell type: its code, and for each of its points the number of the element's node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ElementShape {
    pub code: u8,
    pub nodes: &'static [u8],
}

/// VTK's codes of cells of fewer dimensions.
const VERTEX: u8 = 1;
const LINE: u8 = 3;
const POLYGON: u8 = 7;
const TRIANGLE: u8 = 5;
const QUAD: u8 = 9;
const QUADRATIC_EDGE: u8 = 21;
const QUADRATIC_TRIANGLE: u8 = 22;
const QUADRATIC_QUAD: u8 = 23;
const BIQUADRATIC_QUAD: u8 = 28;
const BIQUADRATIC_TRIANGLE: u8 = 34;

#[derive(Clone)]
pub(super) enum BlockKind {
    Shape(ElementShape),
    Polygons,
    Polyhedra,
}

impl BlockKind {
    /// The kind of elements by their name in the file and the number of their nodes; `None`: no such is read.
    pub fn of_elements(name: &str, node_count: u64) -> Option<BlockKind> {
        match name.trim().to_ascii_uppercase().as_str() {
            "NSIDED" => Some(BlockKind::Polygons),
            "NFACED" => Some(BlockKind::Polyhedra),
            _ => element_shape(name, node_count).map(BlockKind::Shape),
        }
    }

    /// True if cells with a volume have fewer points than the elements have nodes.
    pub fn lacks_nodes(&self, node_count: u64) -> bool {
        let BlockKind::Shape(shape) = self else { return false };
        let is_volume = CellType::from_code(shape.code).is_some_and(|cell| cell.dimension == 3);
        is_volume && node_count > shape.nodes.len() as u64
    }

    /// Nodes of a cell; polyhedra are taken for hexahedra, and polygons for squares.
    pub fn node_count(&self) -> u64 {
        match self {
            BlockKind::Shape(shape) => shape.nodes.len() as u64,
            BlockKind::Polygons => 4,
            BlockKind::Polyhedra => 8,
        }
    }
}

/// In the middle, then below, above, left, right, in front, behind; VTK has that in the middle last, left first.
const HEXAHEDRON_27: &[u8; 27] =
    &[0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 16, 17, 18, 19, 12, 13, 14, 15, 23, 24, 25, 26, 21, 22, 20];

/// The cell type of elements by their name in the file and the number of their nodes; `None`: no such is read.
fn element_shape(name: &str, node_count: u64) -> Option<ElementShape> {
    let family = name.trim().to_ascii_uppercase().chars().take(3).collect::<String>();
    let plain = |code: u8, count: usize| (code, &IN_ORDER[..count]);
    let (code, nodes): (u8, &[u8]) = match (family.as_str(), node_count) {
        ("HEX", 8 | 9) => plain(code::HEXAHEDRON, 8),
        ("HEX", 20 | 21) => (code::QUADRATIC_HEXAHEDRON, &HEXAHEDRON[..20]),
        ("HEX", 27) => (code::TRIQUADRATIC_HEXAHEDRON, HEXAHEDRON_27),
        ("TET", 4 | 5 | 8) => plain(code::TETRA, 4),
        ("TET", 10 | 11 | 14 | 15) => plain(code::QUADRATIC_TETRA, 10),
        ("WED" | "PRI", 6 | 7) => plain(code::WEDGE, 6),
        ("WED" | "PRI", 15 | 16 | 20 | 21) => (code::QUADRATIC_WEDGE, &WEDGE[..15]),
        ("WED" | "PRI", 18) => (code::BIQUADRATIC_QUADRATIC_WEDGE, WEDGE),
        ("PYR", 5 | 6) => plain(code::PYRAMID, 5),
        ("PYR", 13 | 14 | 18 | 19) => plain(code::QUADRATIC_PYRAMID, 13),
        ("TRI" | "SHE", 3) | ("TRI", 4) => plain(TRIANGLE, 3),
        ("TRI" | "SHE", 6) => plain(QUADRATIC_TRIANGLE, 6),
        ("TRI" | "SHE", 7) => plain(BIQUADRATIC_TRIANGLE, 7),
        ("QUA" | "SHE", 4 | 5) => plain(QUAD, 4),
        ("QUA" | "SHE", 8) => plain(QUADRATIC_QUAD, 8),
        ("QUA" | "SHE", 9) => plain(BIQUADRATIC_QUAD, 9),
        ("BEA" | "TRU" | "BAR" | "ROD" | "EDG", 2) => plain(LINE, 2),
        ("BEA" | "TRU" | "BAR" | "ROD" | "EDG", 3) => plain(QUADRATIC_EDGE, 3),
        ("SPH" | "CIR" | "POI", 1) => plain(VERTEX, 1),
        _ => return None,
    };
    Some(ElementShape { code, nodes })
}

/// Numbers that one task looks at.
const PART: usize = 1 << 14;

/// The elements of a block; numbers of nodes and faces are from 1.
pub(super) enum BlockElements {
    /// Elements of one type: the nodes of each side by side.
    Alike { shape: ElementShape, connectivity: Stored },
    /// Polygons: the number of nodes of each, then the nodes of all.
    Polygons { counts: Stored, connectivity: Stored },
    /// Polyhedra: the number of faces of each, then the faces of all.
    Polyhedra { counts: Stored, faces: Stored },
}

/// Faces of a face block: numbers of their nodes, or `None` where all have as many as components; then the nodes of all.
pub(super) struct FaceBlock {
    pub counts: Option<Stored>,
    pub nodes: Stored,
}

/// Points and cells of a file.
pub(super) struct Mesh {
    /// One array for each axis of space.
    pub coordinates: Vec<Stored>,
    pub blocks: Vec<BlockElements>,
    /// Faces of polyhedra, in the order in which they are numbered.
    pub faces: Vec<FaceBlock>,
}

impl Mesh {
    /// Points and cells; `byte_count`: of all, for progress.
    pub fn read(&self, byte_count: u64, progress: &dyn Progress) -> Result<(Vec<DVec3>, Cells)> {
        let meter = Meter::new(progress, byte_count);
        let points = self.points(&meter)?;
        let cells = self.cells(points.len(), &meter)?;
        Ok((points, cells))
    }

    fn points(&self, meter: &Meter) -> Result<Vec<DVec3>> {
        let axes: Result<Vec<Vec<f64>>> = self.coordinates.iter().map(|axis| axis.load(meter)).collect();
        let axes = axes?;
        let at = |axis: usize, point: usize| axes.get(axis).map_or(0.0, |axis| axis[point]);
        let count = axes.first().map_or(0, Vec::len);
        Ok((0..count).into_par_iter().map(|i| DVec3::new(at(0, i), at(1, i), at(2, i))).collect())
    }

    fn cells(&self, point_count: usize, meter: &Meter) -> Result<Cells> {
        let mut cells = CellSet::default();
        let mut faces = None;
        for block in &self.blocks {
            match block {
                BlockElements::Alike { shape, connectivity } => {
                    add_alike(shape, connectivity, point_count, &mut cells, meter)?;
                }
                BlockElements::Polygons { counts, connectivity } => {
                    let nodes = lists(counts, connectivity, point_count, meter)?;
                    nodes.into_iter().for_each(|nodes| cells.push(POLYGON, nodes));
                }
                BlockElements::Polyhedra { counts, faces: numbers } => {
                    if faces.is_none() {
                        faces = Some(self.read_faces(point_count, meter)?);
                    }
                    let known = faces.as_deref().unwrap_or_default();
                    let of_cell =
                        |own: Vec<u32>| own.into_iter().map(|face| known[face as usize].clone()).collect();
                    let of_cells = lists(counts, numbers, known.len(), meter)?;
                    let lengths =
                        of_cells.iter().flatten().map(|&face| known[face as usize].len() as u64 + 6);
                    // Each face of a cell is a list of its own.
                    let bytes = lengths.fold(0, u64::saturating_add).saturating_mul(size_of::<u32>() as u64);
                    let what = || format!("the faces of {}", counted(of_cells.len(), "cell"));
                    refuse_beyond_memory(meter.progress(), what, bytes)?;
                    for own in of_cells {
                        cells.push_polyhedron(of_cell(own));
                    }
                }
            }
        }
        let are_tetrahedra = |block: &BlockElements| matches!(block, BlockElements::Alike { shape, .. } if shape.code == code::TETRA);
        if !cells.types.is_empty() && self.blocks.iter().all(are_tetrahedra) {
            return Ok(tetrahedra(cells.connectivity));
        }
        Ok(Cells::Mixed(cells))
    }

    fn read_faces(&self, point_count: usize, meter: &Meter) -> Result<Vec<Vec<u32>>> {
        let mut faces = Vec::new();
        for FaceBlock { counts, nodes } in &self.faces {
            match counts {
                Some(counts) => faces.extend(lists(counts, nodes, point_count, meter)?),
                None => {
                    let numbers = checked(nodes, point_count, meter)?;
                    faces.extend(numbers.chunks(nodes.component_count).map(<[u32]>::to_vec));
                }
            }
        }
        Ok(faces)
    }
}

fn add_alike(
    ElementShape { code, nodes }: &ElementShape,
    connectivity: &Stored,
    point_count: usize,
    cells: &mut CellSet,
    meter: &Meter,
) -> Result<()> {
    let numbers = checked(connectivity, point_count, meter)?;
    let elements = numbers.par_chunks_exact(connectivity.component_count);
    let count = elements.len();
    cells.types.resize(cells.types.len() + count, *code);
    let begin = cells.connectivity.len() as u64;
    cells.offsets.par_extend((1..=count).into_par_iter().map(|i| begin + (i * nodes.len()) as u64));
    let is_in_order = nodes.iter().map(|&node| usize::from(node)).eq(0..connectivity.component_count);
    match is_in_order {
        true if cells.connectivity.is_empty() => cells.connectivity = numbers,
        true => cells.connectivity.extend_from_slice(&numbers),
        false => cells.connectivity.par_extend(
            elements.flat_map_iter(|element| nodes.iter().map(|&node| element[usize::from(node)])),
        ),
    }
    Ok(())
}

/// Numbers from 0 of things of which there are `count`. Errors: one that is not there.
fn checked(numbers: &Stored, count: usize, meter: &Meter) -> Result<Vec<u32>> {
    let mut own: Vec<u32> = numbers.load(meter)?;
    let is_wrong = |number: u32| number == 0 || number as usize > count;
    let has_wrong = |part: &[u32]| part.iter().fold(false, |found, &number| found | is_wrong(number));
    if let Some(part) = own.par_chunks(PART).find_first(|part| has_wrong(part)) {
        let wrong = part.iter().copied().find(|&number| is_wrong(number)).unwrap_or(0);
        let error = Error::run("an element names a node or a face that does not exist").got(wrong);
        return Err(error.expected(format_args!("a number from 1 to {count}")).at_item(&numbers.name));
    }
    own.par_iter_mut().with_min_len(PART).for_each(|number| *number -= 1);
    Ok(own)
}

/// Lists of such numbers by their lengths.
fn lists(lengths: &Stored, numbers: &Stored, count: usize, meter: &Meter) -> Result<Vec<Vec<u32>>> {
    let (lengths_of, all): (Vec<u32>, Vec<u32>) = (lengths.load(meter)?, checked(numbers, count, meter)?);
    let sum: u64 = lengths_of.iter().map(|&length| u64::from(length)).sum();
    if sum != all.len() as u64 {
        let error = Error::run("the numbers of nodes or faces of elements are wrong");
        let expected = format!("a sum of {}, as '{}' has", all.len(), numbers.name);
        return Err(error.got(format_args!("a sum of {sum}")).expected(expected).at_item(&lengths.name));
    }
    let mut rest = &all[..];
    let list = |length: u32| {
        let (own, after) = rest.split_at(length as usize);
        rest = after;
        own.to_vec()
    };
    Ok(lengths_of.into_iter().map(list).collect())
}
