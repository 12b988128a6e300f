//! A grid in memory, and the grids of some of its arrays.

use rayon::prelude::*;
use std::collections::BTreeSet;
use std::sync::{Arc, Mutex, PoisonError};
use voltet_core::grid::{Array, Grid, Options, RawGrid, SharedPoints, build, build_part, join_by};
use voltet_core::progress::{NoProgress, Progress};
use voltet_core::{Error, Result};
use voltet_graph::Arrays;

/// A grid that a program holds in memory, with all of its arrays, or the piece of one process of it. A cell with a value that is not finite
/// is left out of the whole, whichever array has it; of the grid that a node gives it is left out for a value of a requested array alone, as
/// a reader does. Points of pieces are one that have one position and equal values: of all arrays in the whole, of the requested ones in the
/// grid that a node gives. Pieces that several processes have joined with each other stay as they are.
#[derive(Debug)]
pub struct HostGrid {
    whole: Arc<Grid>,
    /// Names of the arrays that it was built from.
    names: BTreeSet<String>,
    /// Source that it was built from, where the grid of some of its arrays has other cells or points.
    source: Option<Source>,
    /// The last grid of some of the arrays, and their names: a summary of a scalar and its picture are of one.
    last: Mutex<Option<GridOfArrays>>,
}

/// Names of arrays, and the grid with these; `None`: a piece that has nothing to draw of them.
type GridOfArrays = (BTreeSet<String>, Option<Arc<Grid>>);

/// Pieces of a grid, and how it is made of them.
#[derive(Debug, Clone)]
struct Source {
    pieces: Vec<RawGrid>,
    options: Options,
    /// True if they are the piece of a process, which may have nothing to draw.
    is_piece: bool,
}

impl From<Arc<Grid>> for HostGrid {
    /// A grid whose cells are all drawn, whichever arrays are requested.
    fn from(whole: Arc<Grid>) -> Self {
        let names = whole.point_arrays.keys().chain(whole.cell_arrays.keys()).cloned().collect();
        HostGrid { whole, names, source: None, last: Mutex::default() }
    }
}

impl HostGrid {
    /// Puts pieces together and builds the tetrahedra. `scalar`: the array of one component that becomes the grid's scalar.
    ///
    /// # Errors
    /// - those of [`join_by`] and [`build`].
    pub fn build(pieces: Vec<RawGrid>, scalar: Option<&str>, options: &Options) -> Result<HostGrid> {
        let grid = Source::new(pieces, options, false).into_grid(scalar)?;
        grid.ok_or_else(|| Error::run("the grid has nothing to draw"))
    }

    /// Builds the tetrahedra of a piece; `None` where it has nothing to draw.
    ///
    /// # Errors
    /// - those of [`build_part`].
    pub fn build_piece(raw: RawGrid, scalar: Option<&str>, options: &Options) -> Result<Option<HostGrid>> {
        Source::new(vec![raw], options, true).into_grid(scalar)
    }

    /// The grid with all of its arrays; where nothing could be drawn of that, with those whose values are all finite, and its scalar.
    pub fn whole(&self) -> &Arc<Grid> {
        &self.whole
    }

    /// Adds warnings that every run shows.
    pub fn add_warnings(&mut self, warnings: &[String]) {
        let origin = &mut Arc::make_mut(&mut self.whole).origin;
        Arc::make_mut(origin).warnings.extend_from_slice(warnings);
        if let Some(piece) = self.source.iter_mut().find_map(|source| source.pieces.first_mut()) {
            piece.origin.warnings.extend_from_slice(warnings);
        }
        self.last = Mutex::default();
    }

    /// The grid with at least the requested arrays and the scalar (default: its own): the whole where an array is not known, so that
    /// errors name all that there are. `None`: a piece that has nothing to draw of these.
    ///
    /// # Errors
    /// - no cell has finite values of these arrays.
    pub fn with_requested(
        &self,
        requested: &Arrays,
        scalar: Option<&str>,
        progress: &dyn Progress,
    ) -> Result<Option<Arc<Grid>>> {
        let Some(source) = self.source.as_ref().filter(|_| !requested.and_all_others) else {
            return Ok(Some(self.whole.clone()));
        };
        let own = self.whole.scalar.as_ref().map(|_| self.whole.scalar_name.as_str());
        let scalar = scalar.or(own);
        let wanted = requested.named.iter().map(String::as_str).chain(scalar);
        let known: Option<BTreeSet<String>> = wanted.map(|name| source.array_of(name)).collect();
        let Some(mut names) = known else { return Ok(Some(self.whole.clone())) };
        names.extend(requested.optional.iter().filter_map(|name| source.array_of(name)));
        if names == self.names {
            return Ok(Some(self.whole.clone()));
        }
        let last = || self.last.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, grid)) = last().as_ref().filter(|last| last.0 == names) {
            return Ok(grid.clone());
        }
        let own = own.filter(|name| names.contains(*name));
        let grid = source.only(&names).built(None, own, progress)?.map(Arc::new);
        *last() = Some((names, grid.clone()));
        Ok(grid)
    }
}

impl Source {
    fn new(mut pieces: Vec<RawGrid>, options: &Options, is_piece: bool) -> Source {
        // As they are joined: the arrays of others do not count.
        if pieces.iter().any(|piece| piece.cells.count() > 0) {
            pieces.retain(|piece| piece.cells.count() > 0);
        }
        Source { pieces, options: *options, is_piece }
    }

    fn into_grid(self, scalar: Option<&str>) -> Result<Option<HostGrid>> {
        let arrays =
            || self.pieces.iter().flat_map(|piece| piece.point_arrays.iter().chain(&piece.cell_arrays));
        let shared = SharedPoints::by_values(&self.pieces);
        let is_one_for_all = arrays().all(|(_, array)| is_finite(array))
            && shared.as_ref().is_none_or(|shared| !shared.are_parted_by_values(&self.pieces));
        if is_one_for_all {
            let grid = self.built(shared, scalar, &NoProgress)?;
            return Ok(grid.map(|grid| HostGrid::from(Arc::new(grid))));
        }
        // Pieces that do not fit together are an error, whatever could be drawn of them.
        let whole = self.split(join_by(self.pieces.clone(), shared)?, scalar, &NoProgress);
        let whole = match &whole {
            Ok(Some(_)) => whole,
            // Without arrays that leave nothing to draw there may be something.
            _ => {
                let is_not_finite =
                    |(name, array): &(&String, &Array)| Some(name.as_str()) != scalar && !is_finite(array);
                let spoilt: BTreeSet<&String> = arrays().filter(is_not_finite).map(|own| own.0).collect();
                let names =
                    arrays().map(|own| own.0).filter(|name| !spoilt.contains(name)).cloned().collect();
                self.only(&names).built(None, scalar, &NoProgress).or(whole)
            }
        };
        Ok(whole?.map(|whole| HostGrid { source: Some(self), ..Arc::new(whole).into() }))
    }

    /// Source of these arrays alone.
    fn only(&self, names: &BTreeSet<String>) -> Source {
        let mut source = self.clone();
        for piece in &mut source.pieces {
            piece.point_arrays.retain(|name, _| names.contains(name));
            piece.cell_arrays.retain(|name, _| names.contains(name));
        }
        source
    }

    /// Name of the array that `NAME`, `NAME:magnitude` or `NAME:0` is made from.
    fn array_of(&self, name: &str) -> Option<String> {
        let stem = || name.rsplit_once(':').map(|(stem, _)| stem);
        let is_known = |name: &&str| {
            let has = |piece: &RawGrid| {
                piece.point_arrays.contains_key(*name) || piece.cell_arrays.contains_key(*name)
            };
            self.pieces.iter().any(has)
        };
        Some(name).filter(is_known).or_else(|| stem().filter(is_known)).map(str::to_string)
    }

    /// The grid, by the shared points of the pieces where they are known; `None`: a piece that has nothing to draw.
    fn built(
        mut self,
        shared: Option<SharedPoints>,
        scalar: Option<&str>,
        progress: &dyn Progress,
    ) -> Result<Option<Grid>> {
        let raw = join_by(std::mem::take(&mut self.pieces), shared)?;
        self.split(raw, scalar, progress)
    }

    /// The grid of the joined pieces, its cells split into tetrahedra; `None`: a piece that has nothing to draw.
    fn split(&self, raw: RawGrid, scalar: Option<&str>, progress: &dyn Progress) -> Result<Option<Grid>> {
        let grid = match self.is_piece {
            true => build_part(raw, &self.options, progress)?,
            false => Some(build(raw, &self.options, progress)?),
        };
        Ok(grid.map(|mut grid| {
            if let Some(name) = scalar {
                grid.scalar = grid.point_arrays.get(name).map(|array| array.values.clone());
                grid.scalar_name = name.to_string();
            }
            grid
        }))
    }
}

fn is_finite(array: &Array) -> bool {
    array.values.par_iter().with_min_len(1 << 15).all(|value| value.is_finite())
}
