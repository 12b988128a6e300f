//! A grid of tetrahedra with its arrays, and what it was made from.

use super::extent;
use super::parts::{Array, FileCells, HangingPoint, ImportStats};
use crate::error::ErrorKind;
use crate::parameters::suggest;
use crate::{Error, Result, SharedSlice, counted};
use glam::DVec3;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::sync::Arc;

/// A grid of tetrahedra. Immutable once made; nodes share it.
#[derive(Debug, Clone, Default)]
pub struct Grid {
    /// Point positions, world units.
    pub points: SharedSlice<DVec3>,
    /// Four point numbers a cell, **ascending** (orientation carries no meaning for a volume picture, and a
    /// canonical order makes neighbours treat a shared face alike).
    pub tetrahedra: SharedSlice<[u32; 4]>,
    /// For each tetrahedron the cell of the file it is a part of; `None`: tetrahedron i is cell i.
    pub source_cells: Option<Arc<Vec<u32>>>,
    /// The scalar that the reader was asked for, per point.
    pub scalar: Option<SharedSlice<f64>>,
    /// Its name as the user wrote it (`momentum:magnitude`).
    pub scalar_name: String,
    /// Further point arrays that somebody asked for (fields of gaussian-nd widgets, a solver's own gradient).
    pub point_arrays: BTreeMap<String, Arc<Array>>,
    /// Arrays of the file's cells that somebody asked for as they are: one tuple a cell of the file (see
    /// [`Grid::source_cell`]). Their values need not be finite.
    pub cell_arrays: BTreeMap<String, Arc<Array>>,
    /// Ghost cells that serve those that are drawn, where there are such.
    pub ghosts: Option<Arc<GhostCells>>,
    /// The file's own cells and points, where somebody asked for them and every point of the file is one point here
    /// (cells that keep constant values have points of their own).
    pub file_cells: Option<Arc<FileCells>>,
    /// For a grid of boxes of several sizes the points within faces and edges of larger boxes, each after those that its corners
    /// are. Means of cell values look at them; `None`: the grid is of another kind, or nothing is on cells.
    pub hanging: Option<Arc<Vec<HangingPoint>>>,
    /// Counts of the import.
    pub origin: Arc<ImportStats>,
}

/// Cells of other pieces beside those that are drawn: gradients at the points of both look at them.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct GhostCells {
    /// Four point numbers each, ascending.
    pub tetrahedra: Vec<[u32; 4]>,
    /// Number of points that drawn cells use; those after them are of ghosts alone.
    pub drawn_points: usize,
}

impl Grid {
    /// Number of points that drawn cells use: the first of all.
    pub fn drawn_points(&self) -> usize {
        self.ghosts.as_ref().map_or(self.points.len(), |ghosts| ghosts.drawn_points)
    }

    /// The grid whose cells are those that are drawn and the ghosts.
    pub fn with_ghosts(&self) -> Cow<'_, Grid> {
        let Some(ghosts) = &self.ghosts else { return Cow::Borrowed(self) };
        let tetrahedra = self.tetrahedra.iter().chain(&ghosts.tetrahedra).copied().collect();
        let (points, point_arrays) = (self.points.clone(), self.point_arrays.clone());
        Cow::Owned(Grid { points, tetrahedra, point_arrays, ..Grid::default() })
    }

    /// Positions of the four corners of tetrahedron `i`.
    #[inline]
    pub fn corners(&self, i: usize) -> [DVec3; 4] {
        extent::corners_of(&self.points, self.tetrahedra[i])
    }

    /// The cell of the file that tetrahedron `i` is a part of.
    #[inline]
    pub fn source_cell(&self, i: usize) -> usize {
        self.source_cells.as_ref().map_or(i, |cells| cells[i] as usize)
    }

    /// Values of the scalar point array of that name, for messages of what reads it: "the probe".
    ///
    /// Errors: there is none; says which there are.
    pub fn field(&self, reader: &str, name: &str) -> Result<&[f64]> {
        let array = self.point_array(name, 1).map_err(|error| {
            let what = format!("{reader} reads the field '{name}': {}", error.what);
            Error { kind: ErrorKind::Usage, what, ..error }
        })?;
        Ok(&array.values)
    }

    /// The point array of that name with so many components a tuple.
    ///
    /// Errors: there is none; says which there are.
    pub fn point_array(&self, name: &str, component_count: usize) -> Result<&Array> {
        let of = format!("a point array of {}", counted(component_count, "component"));
        let fits = |array: &Array| {
            array.component_count == component_count
                && array.values.len() == component_count * self.points.len()
        };
        let fitting = self.point_arrays.iter().filter(|(_, array)| fits(array));
        let names: Vec<&str> = fitting.map(|(name, _)| name.as_str()).collect();
        let accepted = match names.is_empty() {
            // Others of the file are not read.
            true => of,
            false => format!("{of}: {}", suggest(name, names)),
        };
        match self.point_arrays.get(name) {
            Some(array) if fits(array) => Ok(array),
            Some(array) if component_count == 1 && array.component_count > 1 => {
                Err(Error::run("an array has several components")
                    .got(format!("'{name}' of {}", counted(array.component_count, "component")))
                    .expected(format!("'{name}:magnitude', or '{name}:0' for a component")))
            }
            Some(array) => Err(Error::run("an array has the wrong shape")
                .got(format!("'{name}' of {}", counted(array.component_count, "component")))
                .expected(accepted)),
            None => Err(Error::run("there is no such array").got(format!("'{name}'")).expected(accepted)),
        }
    }

    /// Refuses values of another number than points; `what` has them.
    pub(crate) fn check_values(&self, what: &str, values: &[f64]) -> Result<()> {
        if values.len() == self.points.len() {
            return Ok(());
        }
        let error = Error::run(format!("{what} does not have one value a point")).got(values.len());
        Err(error.expected(self.points.len()))
    }

    /// Lowest and highest coordinates of the finite points of drawn cells; `None` where there is none.
    pub fn bounds(&self) -> Option<[DVec3; 2]> {
        extent::bounds(&self.points[..self.drawn_points()])
    }

    /// The power of two that brings the largest extent of the grid to between 0.5 and 1, so that products of lengths
    /// stay far from the ends of the number range whatever the unit of length; 1 for a grid without extent.
    pub fn length_scale(&self) -> f64 {
        let [low, high] = self.bounds().unwrap_or_default();
        let extent = (high * 0.5 - low * 0.5).max_element();
        if extent > 0.0 && extent.is_finite() {
            // Within the exponents for which the scale and its inverse are normal numbers.
            let exponent = (libm::ilogb(extent) + 2).clamp(-1000, 1000);
            libm::ldexp(1.0, -exponent)
        } else {
            1.0
        }
    }
}

/// Volume of a tetrahedron, ≥ 0.
#[inline]
pub fn tetrahedron_volume([a, b, c, d]: [DVec3; 4]) -> f64 {
    (b - a).dot((c - a).cross(d - a)).abs() / 6.0
}
