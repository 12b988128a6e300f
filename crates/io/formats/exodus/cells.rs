//! Element types of Exodus as cells of VTK, and the points and cells of a file.
//!
//! Node orders: Exodus II manual (Schoof, Yarberry, SAND92-2137, 2006), figure 4.2, against VTK's, as vtkExodusIIReader turns one into
//! the other. An element with nodes that VTK's cell lacks (in faces or the middle) becomes the cell without these.

use crate::formats::contents::{Meter, Stored};
use crate::formats::lazy::tetrahedra;
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

/// Numbers that one task looks at.
const PART: usize = 1 << 14;

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
        if let [x, y, z] = &axes[..] {
            return Ok(x.par_iter().zip(y).zip(z).map(|((&x, &y), &z)| DVec3::new(x, y, z)).collect());
        }
        let at = |axis: usize, point: usize| axes.get(axis).map_or(0.0, |axis| axis[point]);
        let count = axes.first().map_or(0, Vec::len);
        Ok((0..count).into_par_iter().map(|i| DVec3::new(at(0, i), at(1, i), at(2, i))).collect())
    }

    fn cells(&self, point_count: usize, meter: &Meter) -> Result<Cells> {
        let mut connectivity = Vec::new();
        for BlockElements { shape: ElementShape { nodes, .. }, connectivity: stored } in &self.blocks {
            let mut numbers: Vec<u32> = stored.load(meter)?;
            let is_wrong = |number: u32| number == 0 || number as usize > point_count;
            let has_wrong = |part: &[u32]| part.iter().fold(false, |found, &number| found | is_wrong(number));
            if let Some(wrong) = numbers.par_chunks(PART).find_first(|part| has_wrong(part)) {
                let error = Error::run("an element names a node that does not exist");
                let found = wrong.iter().find(|number| is_wrong(**number)).copied().unwrap_or(0);
                return Err(error
                    .got(found)
                    .expected(format_args!("a number from 1 to {point_count}"))
                    .at_item(&stored.name));
            }
            numbers.par_iter_mut().with_min_len(PART).for_each(|number| *number -= 1);
            let is_in_order = nodes.iter().copied().eq(0..stored.component_count);
            match is_in_order {
                true if connectivity.is_empty() => connectivity = numbers,
                true => connectivity.extend_from_slice(&numbers),
                false => connectivity.par_extend(
                    numbers
                        .par_chunks_exact(stored.component_count)
                        .flat_map_iter(|element| nodes.iter().map(|&node| element[node])),
                ),
            }
        }
        if !connectivity.is_empty() && self.blocks.iter().all(|block| block.shape.code == code::TETRA) {
            return Ok(tetrahedra(connectivity));
        }
        let (mut types, mut offsets) = (Vec::new(), vec![0]);
        for BlockElements { shape: ElementShape { code, nodes }, connectivity: stored } in &self.blocks {
            let (count, begin) = (stored.tuple_count.unwrap_or(0), offsets.last().copied().unwrap_or(0));
            types.resize(types.len() + count as usize, *code);
            offsets
                .par_extend((1..=count as usize).into_par_iter().map(|i| begin + (i * nodes.len()) as u64));
        }
        Ok(Cells::Mixed(CellSet { types, offsets, connectivity, polyhedra: Vec::new() }))
    }
}
