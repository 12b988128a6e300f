//! The cells of a file one by one: which are drawn, and the tetrahedra of each.

use super::cell_set::Polyhedron;
use super::cell_types::{CellType, code};
use super::curved::{Curved, is_curved};
use super::parts::{Cell, Cells, is_left_out, is_neighbour, structured_corners};
use super::polyhedra::{self, Added, Polyhedra};
use super::split;
use crate::{Error, Result};
use rayon::prelude::*;

/// Classification of a cell on import.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum CellStatus {
    /// It is drawn, or a ghost that serves those that are.
    Drawn,
    /// Left out: another piece draws it, or it is hidden.
    Ghost,
    /// Left out: not three-dimensional.
    NotVolume,
    /// Left out: a position or value is not finite.
    NotFinite,
    /// Left out: a type that cannot be split.
    Unsupported,
    /// Left out: a polyhedron that cannot be split.
    NotSplit,
}

/// The cells of a file, checked one by one as they are asked for.
pub(super) struct Source<'a> {
    pub cells: &'a Cells,
    /// Number of points of the file.
    pub point_count: usize,
    /// `vtkGhostType` of every cell.
    pub ghost: Option<&'a [u8]>,
    /// True at points whose position or value is not finite; `None`: all are finite.
    pub point_not_finite: Option<Vec<bool>>,
    /// Flags of cells with a value that is not finite.
    pub cell_not_finite: Option<Vec<bool>>,
    pub degrees: Option<&'a [[u8; 3]]>,
    /// Subdivision of curved cells.
    pub curved: Curved,
    pub polyhedra: Polyhedra,
}

impl Source<'_> {
    /// Cell `number`; `buffer` holds the corners of cells that are not stored.
    pub fn cell<'b>(&'b self, number: usize, buffer: &'b mut [u32; 8]) -> Result<Cell<'b>> {
        match self.cells {
            Cells::Tetrahedra(t) => Ok(Cell { number, code: code::TETRA, corners: &t[number] }),
            Cells::Mixed(cells) => {
                let (start, end) = (cells.offsets[number], cells.offsets[number + 1]);
                let corners = usize::try_from(start)
                    .ok()
                    .zip(usize::try_from(end).ok())
                    .and_then(|(start, end)| cells.connectivity.get(start..end))
                    .ok_or_else(|| {
                        Error::run("a cell's offsets do not lie in the connectivity")
                            .got(format!("{start} to {end} for cell {number}"))
                            .expected(format!("ascending offsets of at most {}", cells.connectivity.len()))
                    })?;
                Ok(Cell { number, code: cells.types[number], corners })
            }
            Cells::Structured(points) => {
                *buffer = structured_corners(*points, number);
                Ok(Cell { number, code: code::VOXEL, corners: &buffer[..] })
            }
        }
    }

    /// Type of a cell.
    ///
    /// Errors: none has the code.
    fn cell_type(cell: &Cell) -> Result<&'static CellType> {
        CellType::from_code(cell.code).ok_or_else(|| {
            let error = Error::run(format!("cell {} has an unknown type", cell.number)).got(cell.code);
            error.expected("a cell type code of VTK")
        })
    }

    /// Refuses a damaged cell, of whatever dimension.
    pub fn check(&self, cell: &Cell) -> Result<()> {
        self.check_points(cell, Self::cell_type(cell)?)
    }

    fn check_points(&self, cell: &Cell, cell_type: &CellType) -> Result<()> {
        let number = cell.number;
        if let Some(count) = cell_type.point_count
            && cell.corners.len() != usize::from(count)
        {
            return Err(Error::run(format!(
                "cell {number}, a {}, has the wrong number of points",
                cell_type.name
            ))
            .got(cell.corners.len())
            .expected(count));
        }
        let point_count = self.point_count;
        if let Some(&wrong) = cell.corners.iter().find(|&&c| c as usize >= point_count) {
            return Err(Error::run(format!("cell {number} names a point that does not exist"))
                .got(wrong)
                .expected(format!("a point number below {point_count}")));
        }
        Ok(())
    }

    /// Classifies a cell; an error where it is damaged.
    pub fn fate(&self, cell: &Cell) -> Result<CellStatus> {
        let number = cell.number;
        let cell_type = Self::cell_type(cell)?;
        if cell_type.dimension < 3 {
            return Ok(CellStatus::NotVolume);
        }
        self.check_points(cell, cell_type)?;
        if self.ghost.is_some_and(|flags| is_left_out(flags[number])) {
            return Ok(CellStatus::Ghost);
        }
        if !is_supported(cell.code) {
            return Ok(CellStatus::Unsupported);
        }
        let bad_point = |c: &u32| self.point_not_finite.as_ref().is_some_and(|bad| bad[*c as usize]);
        let has_bad_point = if cell.code == code::POLYHEDRON {
            let Cells::Mixed(set) = self.cells else { return Ok(CellStatus::Unsupported) };
            let polyhedron = self.polyhedra.polyhedron(set, number).ok_or_else(|| {
                Error::run(format!("cell {number}, a polyhedron, has no faces"))
                    .expected("the faces of every polyhedron")
            })?;
            polyhedron.faces.iter().flatten().any(bad_point)
        } else {
            cell.corners.iter().any(bad_point)
        };
        let has_bad_value = self.cell_not_finite.as_ref().is_some_and(|bad| bad[number]);
        Ok(if has_bad_value || has_bad_point {
            CellStatus::NotFinite
        } else if cell.code == code::POLYHEDRON && self.polyhedra.is_left_out(number) {
            CellStatus::NotSplit
        } else {
            CellStatus::Drawn
        })
    }

    /// True for a cell of another part of the grid, which counts there.
    pub fn is_neighbour(&self, number: usize) -> bool {
        self.ghost.is_some_and(|flags| is_neighbour(flags[number]))
    }

    /// Key of a curved cell's subdivision.
    pub fn kind(&self, cell: &Cell) -> (u8, usize, Option<[u8; 3]>) {
        let degrees = if cell.code >= code::LAGRANGE_TETRAHEDRON { self.degrees } else { None };
        (cell.code, cell.corners.len(), degrees.map(|d| d[cell.number]))
    }

    /// Prepares curved cells and polyhedra; `points` are the file's. Afterwards all cells can be split.
    pub fn prepare(&mut self, points: &[glam::DVec3], subdivision: usize) -> Result<()> {
        let Cells::Mixed(set) = self.cells else { return Ok(()) };
        if set.types.iter().any(|&code| is_curved(code)) {
            let mut curved = Curved::default();
            let mut last = None;
            let mut buffer = [0; 8];
            for number in 0..set.types.len() {
                if !is_curved(set.types[number]) {
                    continue;
                }
                let cell = self.cell(number, &mut buffer)?;
                let kind = self.kind(&cell);
                if last != Some(kind) {
                    curved.prepare(&cell, kind, subdivision)?;
                    last = Some(kind);
                }
            }
            if let Some(mut numbering) = curved.numbering(set.types.len(), self.point_count) {
                for number in 0..set.types.len() {
                    let cell = self.cell(number, &mut buffer)?;
                    let adds = is_curved(cell.code) && self.fate(&cell)? == CellStatus::Drawn;
                    numbering.take(adds.then(|| (&cell, self.kind(&cell))))?;
                }
            }
            self.curved = curved;
        }
        if !set.polyhedra.is_empty() {
            self.polyhedra = Polyhedra::index(set, self.point_count)?;
            let is_drawn = |polyhedron: &Polyhedron| {
                let number = polyhedron.cell as usize;
                number < set.types.len()
                    && self.cell(number, &mut [0; 8]).and_then(|cell| self.fate(&cell)).ok()
                        == Some(CellStatus::Drawn)
            };
            let drawn: Vec<bool> = set.polyhedra.par_iter().map(is_drawn).collect();
            let first_free = self.point_count + self.curved.origins.len();
            self.polyhedra.choose(set, points, &drawn, first_free)?;
            if let Some(flags) = self.ghost {
                self.polyhedra.retain_left_out(|cell| !is_neighbour(flags[cell as usize]));
            }
        }
        Ok(())
    }

    /// Number of points that the cells add to the file's.
    pub fn added_count(&self) -> usize {
        self.curved.origins.len() + self.polyhedra.added.len()
    }

    /// Calls `f` with the points of the file and their weights that make added point `i`.
    pub fn weights_of_added<R>(
        &self,
        i: usize,
        f: impl FnOnce(&mut dyn Iterator<Item = (u32, f64)>) -> R,
    ) -> Result<R> {
        if let Some(&(number, added)) = self.curved.origins.get(i) {
            let mut buffer = [0; 8];
            let cell = self.cell(number as usize, &mut buffer)?;
            let weights = self.curved.weights(self.kind(&cell), added);
            return Ok(f(&mut weights.iter().map(|&(node, w)| (cell.corners[node], w))));
        }
        let Cells::Mixed(set) = self.cells else { return Ok(f(&mut std::iter::empty())) };
        match &self.polyhedra.added[i - self.curved.origins.len()] {
            Added::Mean(position) => {
                let corners = polyhedra::corners(&set.polyhedra[*position]);
                let weight = 1.0 / corners.len() as f64;
                Ok(f(&mut corners.into_iter().map(|c| (c, weight))))
            }
            Added::Weights(weights) => Ok(f(&mut weights.iter().copied())),
        }
    }

    /// Hands out the tetrahedra of a cell that is drawn.
    pub fn tetrahedra(&self, cell: &Cell, emit: &mut impl FnMut([u32; 4])) {
        let v = cell.corners;
        match cell.code {
            code::TETRA => emit([v[0], v[1], v[2], v[3]]),
            code::VOXEL => {
                split::hexahedron(&[v[0], v[1], v[2], v[3], v[4], v[5], v[6], v[7]], emit);
            }
            code::HEXAHEDRON => split::hexahedron(&split::voxel_order(v), emit),
            code::WEDGE => split::star(v, split::WEDGE_FACES, emit),
            code::PYRAMID => split::star(v, split::PYRAMID_FACES, emit),
            code::PENTAGONAL_PRISM => split::star(v, split::PENTAGONAL_PRISM_FACES, emit),
            code::HEXAGONAL_PRISM => split::star(v, split::HEXAGONAL_PRISM_FACES, emit),
            code::POLYHEDRON => {
                if let Cells::Mixed(set) = self.cells {
                    self.polyhedra.tetrahedra(set, cell.number, emit);
                }
            }
            _ => self.curved.tetrahedra(cell, self.kind(cell), emit),
        }
    }
}

/// True if cells of this type can be split.
pub(super) fn is_supported(code: u8) -> bool {
    matches!(code, code::TETRA..=code::HEXAGONAL_PRISM | code::POLYHEDRON) || is_curved(code)
}
