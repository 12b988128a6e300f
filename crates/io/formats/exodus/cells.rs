//! Element types of Exodus as cells of VTK, and the points and cells of a file.
//!
//! Node orders: Exodus II manual (Schoof, Yarberry, SAND92-2137, 2006), figure 4.2, against VTK's, as vtkExodusIIReader turns one into
//! the other. An element with nodes that VTK's cell lacks (in faces or the middle) becomes the cell without these.

use crate::formats::contents::{Meter, Stored};
use glam::DVec3;
use rayon::prelude::*;
use std::ops::Range;
use voltet_core::grid::{CellSet, Cells, code};
use voltet_core::progress::Progress;
use voltet_core::reading::{GridHead, GridRead, OpenGrid};
use voltet_core::{Error, Result};

/// A cell type: its code, and for each of its points the number of the element's node.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ElementShape {
    pub code: u8,
    pub nodes: Vec<usize>,
}

/// VTK's codes of cells of fewer dimensions.
const VERTEX: u8 = 1;
const LINE: u8 = 3;
const TRIANGLE: u8 = 5;
const QUAD: u8 = 9;
const QUADRATIC_EDGE: u8 = 21;
const QUADRATIC_TRIANGLE: u8 = 22;
const QUADRATIC_QUAD: u8 = 23;
const BIQUADRATIC_QUAD: u8 = 28;
const BIQUADRATIC_TRIANGLE: u8 = 34;

/// The cell type of elements by their name in the file and the number of their nodes; `None`: no such is read.
pub(super) fn element_shape(name: &str, node_count: u64) -> Option<ElementShape> {
    let family = name.trim().to_ascii_uppercase().chars().take(3).collect::<String>();
    let plain = |code: u8, count: usize| (code, (0..count).collect::<Vec<usize>>());
    let parts = |code: u8, parts: &[Range<usize>]| (code, parts.iter().cloned().flatten().collect());
    // Exodus has the edges of the middle before those of the upper face, VTK after them.
    let (code, nodes): (u8, Vec<usize>) = match (family.as_str(), node_count) {
        ("HEX", 8 | 9) => plain(code::HEXAHEDRON, 8),
        ("HEX", 20 | 21) => parts(code::QUADRATIC_HEXAHEDRON, &[0..12, 16..20, 12..16]),
        // In the middle, then below, above, left, right, in front, behind; VTK has that in the middle last, left first.
        ("HEX", 27) => parts(code::TRIQUADRATIC_HEXAHEDRON, &[0..12, 16..20, 12..16, 23..27, 21..23, 20..21]),
        ("TET", 4 | 5 | 8) => plain(code::TETRA, 4),
        ("TET", 10 | 11 | 14 | 15) => plain(code::QUADRATIC_TETRA, 10),
        ("WED" | "PRI", 6 | 7) => plain(code::WEDGE, 6),
        ("WED" | "PRI", 15 | 16 | 20 | 21) => parts(code::QUADRATIC_WEDGE, &[0..9, 12..15, 9..12]),
        ("WED" | "PRI", 18) => parts(code::BIQUADRATIC_QUADRATIC_WEDGE, &[0..9, 12..15, 9..12, 15..18]),
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

/// The elements of a block.
pub(super) struct BlockElements {
    pub shape: ElementShape,
    /// Node numbers from 1, those of an element side by side.
    pub connectivity: Stored,
}

/// Points and cells of a file.
pub(super) struct Mesh {
    pub head: GridHead,
    /// One array for each axis of space.
    pub coordinates: Vec<Stored>,
    pub blocks: Vec<BlockElements>,
}

impl OpenGrid for Mesh {
    fn head(&self) -> &GridHead {
        &self.head
    }

    fn read(&self, geometry: bool, _arrays: &[usize], progress: &dyn Progress) -> Result<GridRead> {
        let mut read = GridRead { points: None, cells: None, arrays: Vec::new(), warnings: Vec::new() };
        if geometry {
            let meter = Meter::new(
                progress,
                self.head.point_count.saturating_mul(24).saturating_add(self.head.cell_bytes),
            );
            let points = self.points(&meter)?;
            read.cells = Some(self.cells(points.len(), &meter)?);
            read.points = Some(points);
        }
        Ok(read)
    }
}

impl Mesh {
    fn points(&self, meter: &Meter) -> Result<Vec<DVec3>> {
        let axes: Result<Vec<Vec<f64>>> = self.coordinates.iter().map(|axis| axis.load(meter)).collect();
        let axes = axes?;
        let at = |axis: usize, point: usize| axes.get(axis).map_or(0.0, |axis| axis[point]);
        let count = axes.first().map_or(0, Vec::len);
        Ok((0..count).into_par_iter().map(|i| DVec3::new(at(0, i), at(1, i), at(2, i))).collect())
    }

    fn cells(&self, point_count: usize, meter: &Meter) -> Result<Cells> {
        let (mut types, mut offsets, mut connectivity) = (Vec::new(), vec![0], Vec::new());
        for BlockElements { shape: ElementShape { code, nodes }, connectivity: stored } in &self.blocks {
            let numbers: Vec<u32> = stored.load(meter)?;
            let elements = numbers.par_chunks_exact(stored.component_count);
            types.resize(types.len() + elements.len(), *code);
            let begin = connectivity.len() as u64;
            offsets
                .par_extend((1..=elements.len()).into_par_iter().map(|i| begin + (i * nodes.len()) as u64));
            // A number of 0 becomes one beyond all.
            connectivity.par_extend(
                elements.flat_map_iter(|element| nodes.iter().map(|&node| element[node].wrapping_sub(1))),
            );
            if let Some(wrong) =
                numbers.par_iter().find_any(|&&number| number == 0 || number as usize > point_count)
            {
                let error = Error::run("an element names a node that does not exist").got(wrong);
                return Err(error
                    .expected(format_args!("a number from 1 to {point_count}"))
                    .at_item(&stored.name));
            }
        }
        if !types.is_empty() && types.par_iter().all(|&code| code == code::TETRA) {
            return Ok(Cells::Tetrahedra(connectivity.as_chunks().0.to_vec().into()));
        }
        Ok(Cells::Mixed(CellSet { types, offsets, connectivity, polyhedra: Vec::new() }))
    }
}
