//! The cells of a file one by one: which are drawn, and the tetrahedra of each.

use super::cell_types::{CellType, code};
use super::parts::Cells;
use super::split;
use crate::{Error, Result};

/// What becomes of a cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Fate {
    /// It is drawn.
    Drawn,
    /// Left out: a ghost.
    Ghost,
    /// Left out: not three-dimensional.
    NotVolume,
    /// Left out: a position or value is not finite.
    NotFinite,
    /// Left out: a type that cannot be split.
    Unsupported,
}

/// One cell.
pub(super) struct Cell<'a> {
    /// Number in the file.
    pub number: usize,
    /// VTK type code.
    pub code: u8,
    /// Its points.
    pub corners: &'a [u32],
}

/// The cells of a file, checked one by one as they are asked for.
pub(super) struct Source<'a> {
    pub cells: &'a Cells,
    /// Number of points of the file.
    pub point_count: usize,
    /// Cells to leave out.
    pub ghost: Option<&'a [bool]>,
    /// True at points whose position or value is not finite; `None`: all are finite.
    pub point_not_finite: Option<Vec<bool>>,
    /// The same for values on cells.
    pub cell_not_finite: Option<Vec<bool>>,
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
                            .found(format!("{start} to {end} for cell {number}"))
                            .accepted(format!("ascending offsets of at most {}", cells.connectivity.len()))
                    })?;
                Ok(Cell { number, code: cells.types[number], corners })
            }
            Cells::Structured(points) => {
                let (nx, ny) = (points[0], points[1]);
                let (i, rest) = (number % (nx - 1), number / (nx - 1));
                let (j, k) = (rest % (ny - 1), rest / (ny - 1));
                for (corner, slot) in buffer.iter_mut().enumerate() {
                    let at = (i + (corner & 1)) + nx * ((j + (corner >> 1 & 1)) + ny * (k + (corner >> 2)));
                    // `build` has checked that the number of points fits.
                    *slot = at as u32;
                }
                Ok(Cell { number, code: code::VOXEL, corners: &buffer[..] })
            }
        }
    }

    /// What becomes of a cell; an error where it is damaged.
    pub fn fate(&self, cell: &Cell) -> Result<Fate> {
        let number = cell.number;
        let Some(cell_type) = CellType::of(cell.code) else {
            return Err(Error::run(format!("cell {number} has an unknown type"))
                .found(cell.code)
                .accepted("a cell type code of VTK"));
        };
        if cell_type.dimension < 3 {
            return Ok(Fate::NotVolume);
        }
        if let Some(count) = cell_type.point_count
            && cell.corners.len() != usize::from(count)
        {
            return Err(Error::run(format!(
                "cell {number}, a {}, has the wrong number of points",
                cell_type.name
            ))
            .found(cell.corners.len())
            .accepted(count));
        }
        let point_count = self.point_count;
        if let Some(&wrong) = cell.corners.iter().find(|&&c| c as usize >= point_count) {
            return Err(Error::run(format!("cell {number} names a point that does not exist"))
                .found(wrong)
                .accepted(format!("a point number below {point_count}")));
        }
        if self.ghost.is_some_and(|g| g[number]) {
            return Ok(Fate::Ghost);
        }
        if !is_supported(cell.code) {
            return Ok(Fate::Unsupported);
        }
        let bad_point = |c: &u32| self.point_not_finite.as_ref().is_some_and(|bad| bad[*c as usize]);
        if self.cell_not_finite.as_ref().is_some_and(|bad| bad[number]) || cell.corners.iter().any(bad_point)
        {
            return Ok(Fate::NotFinite);
        }
        Ok(Fate::Drawn)
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
            _ => {}
        }
    }
}

/// Whether cells of this type can be split.
pub(super) fn is_supported(code: u8) -> bool {
    matches!(code, code::TETRA..=code::HEXAGONAL_PRISM)
}
