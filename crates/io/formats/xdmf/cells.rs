//! Cells of XDMF, whose nodes stand in the order of VTK.
//!
//! Source: XDMF Model and Format (xdmf.org), numbers of types as in XdmfTopology; VTK's reader gives the same order of nodes for
//! each type.

use crate::formats::contents::{Convert, Meter, Stored};
use crate::formats::lazy::tetrahedra;
use std::sync::Arc;
use voltet_core::grid::{CellSet, Cells, code};
use voltet_core::{Error, Result};

/// A cell type: names without `_` in small letters, number in mixed topologies, nodes (0: their number stands before them), VTK's type.
pub(super) struct Topology {
    names: &'static [&'static str],
    number: u32,
    node_count: usize,
    vtk: u8,
}

const fn topology(names: &'static [&'static str], number: u32, node_count: usize, vtk: u8) -> Topology {
    Topology { names, number, node_count, vtk }
}

/// Numbers of the types of any number of nodes (vertices, lines, polygons): in a topology of one type all cells have as many.
const ANY_NUMBER: [u32; 3] = [1, 2, 3];
const POLYHEDRON: u32 = 16;
const MIXED: u32 = 112;

const TOPOLOGIES: &[Topology] = &[
    topology(&["polyvertex"], 1, 0, 2),
    topology(&["polyline"], 2, 0, 4),
    topology(&["polygon"], 3, 0, 7),
    topology(&["triangle", "tri"], 4, 3, 5),
    topology(&["quadrilateral", "quad"], 5, 4, 9),
    topology(&["tetrahedron", "tetra", "tet"], 6, 4, code::TETRA),
    topology(&["pyramid"], 7, 5, code::PYRAMID),
    topology(&["wedge"], 8, 6, code::WEDGE),
    topology(&["hexahedron", "hex"], 9, 8, code::HEXAHEDRON),
    topology(&["polyhedron"], POLYHEDRON, 0, code::POLYHEDRON),
    topology(&["edge3"], 34, 3, 21),
    topology(&["quadrilateral9", "quad9"], 35, 9, 28),
    topology(&["triangle6", "tri6"], 36, 6, 22),
    topology(&["quadrilateral8", "quad8"], 37, 8, 23),
    topology(&["tetrahedron10", "tetra10", "tet10"], 38, 10, code::QUADRATIC_TETRA),
    topology(&["pyramid13"], 39, 13, code::QUADRATIC_PYRAMID),
    topology(&["wedge15"], 40, 15, code::QUADRATIC_WEDGE),
    topology(&["wedge18"], 41, 18, code::BIQUADRATIC_QUADRATIC_WEDGE),
    topology(&["hexahedron20", "hex20"], 48, 20, code::QUADRATIC_HEXAHEDRON),
    topology(&["hexahedron24", "hex24"], 49, 24, code::BIQUADRATIC_QUADRATIC_HEXAHEDRON),
    topology(&["hexahedron27", "hex27"], 50, 27, code::TRIQUADRATIC_HEXAHEDRON),
    topology(&["mixed"], MIXED, 0, 0),
];

impl Topology {
    pub fn named(name: &str) -> Option<&'static Topology> {
        let plain = name.replace('_', "").to_lowercase();
        TOPOLOGIES.iter().find(|topology| topology.names.contains(&plain.as_str()))
    }

    /// Nodes of each cell, where all have as many; `declared`: those that the topology declares for a type of any number.
    pub fn node_count(&self, declared: Option<u64>) -> Option<u64> {
        let declared = declared.filter(|_| ANY_NUMBER.contains(&self.number));
        Some(self.node_count as u64).filter(|&count| count > 0).or(declared)
    }

    /// True for vertices, of one node each where nothing else is declared.
    pub fn is_vertex(&self) -> bool {
        self.number == ANY_NUMBER[0]
    }

    /// Makes the cells of a connectivity, of so many nodes each, or of as many as stand before each cell's; `base`: number of the
    /// first point.
    pub fn convert(
        &'static self,
        node_count: Option<u64>,
        connectivity: Stored,
        cell_count: u64,
        base: u32,
    ) -> Convert {
        Arc::new(move |meter| {
            let cells = self.cells(node_count, &connectivity, cell_count, base, meter);
            cells.map_err(|error| error.at_item(&connectivity.name))
        })
    }

    fn cells(
        &self,
        node_count: Option<u64>,
        connectivity: &Stored,
        cell_count: u64,
        base: u32,
        meter: &Meter,
    ) -> Result<Cells> {
        let mut numbers: Vec<u32> = connectivity.load(meter)?;
        let Some(node_count) = node_count.and_then(|count| usize::try_from(count).ok()) else {
            return self.counted(&numbers, cell_count, base).map(Cells::Mixed);
        };
        if base > 0 {
            for number in &mut numbers {
                *number = point(*number, base)?;
            }
        }
        if self.vtk == code::TETRA {
            return Ok(tetrahedra(numbers));
        }
        Ok(Cells::Mixed(CellSet::of_type(self.vtk, node_count, numbers)))
    }

    /// Cells of several types or numbers of nodes.
    fn counted(&self, numbers: &[u32], cell_count: u64, base: u32) -> Result<CellSet> {
        let mut cells = CellSet::default();
        let mut rest = numbers;
        for number in 0..cell_count {
            let ends = || Error::run(format!("the connectivity ends within cell {number}"));
            let topology =
                if self.number == MIXED { by_number(take(&mut rest, 1).ok_or_else(ends)?[0])? } else { self };
            if topology.number == POLYHEDRON {
                polyhedron(&mut rest, base, &mut cells)?.ok_or_else(ends)?;
                continue;
            }
            let count = match topology.node_count {
                0 => take(&mut rest, 1).ok_or_else(ends)?[0] as usize,
                count => count,
            };
            let nodes = take(&mut rest, count).ok_or_else(ends)?;
            for &node in nodes {
                point(node, base)?;
            }
            cells.push(topology.vtk, nodes.iter().map(|node| node - base));
        }
        match rest {
            [] => Ok(cells),
            _ => {
                let error = Error::run("the connectivity holds more numbers than the cells take");
                Err(error.got(numbers.len()).expected(numbers.len() - rest.len()))
            }
        }
    }
}

fn point(node: u32, base: u32) -> Result<u32> {
    let error = || {
        Error::run("a node number is less than BaseOffset")
            .got(node)
            .expected(format_args!("at least {base}"))
    };
    node.checked_sub(base).ok_or_else(error)
}

fn by_number(number: u32) -> Result<&'static Topology> {
    let known = TOPOLOGIES.iter().find(|topology| topology.number == number && number != MIXED);
    known.ok_or_else(|| Error::run("a cell type of XDMF is not known").got(number))
}

fn take<'a>(rest: &mut &'a [u32], count: usize) -> Option<&'a [u32]> {
    let (taken, after) = rest.split_at_checked(count)?;
    *rest = after;
    Some(taken)
}

/// Adds a polyhedron: the number of its faces, then of each the number of its nodes and these. `None`: the numbers end before.
fn polyhedron(rest: &mut &[u32], base: u32, cells: &mut CellSet) -> Result<Option<()>> {
    let mut faces = Vec::new();
    let Some(face_count) = take(rest, 1) else { return Ok(None) };
    for _ in 0..face_count[0] {
        let Some(nodes) = take(rest, 1).and_then(|count| take(rest, count[0] as usize)) else {
            return Ok(None);
        };
        faces.push(nodes.iter().map(|&node| point(node, base)).collect::<Result<Vec<u32>>>()?);
    }
    cells.push_polyhedron(faces);
    Ok(Some(()))
}
