//! A grid in memory, and the grids of some of its arrays.

use rayon::prelude::*;
use std::collections::BTreeSet;
use std::sync::{Arc, Mutex, PoisonError};
use voltet_core::Result;
use voltet_core::grid::{Array, Grid, Options, RawGrid, build};
use voltet_core::progress::Progress;
use voltet_graph::Arrays;

/// A grid that a program holds in memory, with all of its arrays. A cell with a value that is not finite is left out of the whole,
/// whichever array has it; of the grid that a node gives it is left out for a value of a requested array alone, as a reader does.
#[derive(Debug)]
pub struct HostGrid {
    whole: Arc<Grid>,
    /// The arrays that it was built from, where one has a value that is not finite.
    source: Option<(RawGrid, Options)>,
    /// The last grid of some of the arrays, and their names: a summary of a scalar and its picture are of one.
    last: Mutex<Option<(BTreeSet<String>, Arc<Grid>)>>,
}

impl From<Arc<Grid>> for HostGrid {
    /// A grid whose cells are all drawn, whichever arrays are requested.
    fn from(whole: Arc<Grid>) -> Self {
        HostGrid { whole, source: None, last: Mutex::default() }
    }
}

impl HostGrid {
    /// Builds the tetrahedra. `scalar`: the array of one component that becomes the grid's scalar.
    ///
    /// # Errors
    /// - those of [`build`].
    pub fn build(
        raw: RawGrid,
        scalar: Option<&str>,
        options: &Options,
        progress: &dyn Progress,
    ) -> Result<HostGrid> {
        let arrays = || raw.point_arrays.iter().chain(&raw.cell_arrays);
        if arrays().all(|(_, array)| is_finite(array)) {
            return Ok(Arc::new(built(raw, scalar, options, progress)?).into());
        }
        // Without arrays that leave nothing to draw there may be something.
        let is_of_use = |(name, array): &(&String, &Array)| Some(name.as_str()) == scalar || is_finite(array);
        let names = arrays().filter(is_of_use).map(|(name, _)| name.clone()).collect();
        let whole = built(raw.clone(), scalar, options, progress)
            .or_else(|error| built(only(&raw, &names), scalar, options, progress).map_err(|_| error))?;
        Ok(HostGrid { source: Some((raw, *options)), ..Arc::new(whole).into() })
    }

    /// The grid with all of its arrays; where nothing could be drawn of that, with those whose values are all finite, and its scalar.
    pub fn whole(&self) -> &Arc<Grid> {
        &self.whole
    }

    /// Adds warnings that every run shows.
    pub fn add_warnings(&mut self, warnings: &[String]) {
        let origin = &mut Arc::make_mut(&mut self.whole).origin;
        Arc::make_mut(origin).warnings.extend_from_slice(warnings);
        if let Some((raw, _)) = &mut self.source {
            raw.origin.warnings.extend_from_slice(warnings);
        }
        self.last = Mutex::default();
    }

    /// The grid with at least the requested arrays and the scalar (default: its own): the whole where an array is not known, so that
    /// errors name all that there are.
    ///
    /// # Errors
    /// - no cell has finite values of these arrays.
    pub fn with_requested(
        &self,
        requested: &Arrays,
        scalar: Option<&str>,
        progress: &dyn Progress,
    ) -> Result<Arc<Grid>> {
        let Some((raw, options)) = self.source.as_ref().filter(|_| !requested.and_all_others) else {
            return Ok(self.whole.clone());
        };
        let own = self.whole.scalar.as_ref().map(|_| self.whole.scalar_name.as_str());
        let scalar = scalar.or(own);
        let wanted = requested.named.iter().map(String::as_str).chain(scalar);
        let known: Option<BTreeSet<String>> = wanted.map(|name| array_of(raw, name)).collect();
        let Some(mut names) = known else { return Ok(self.whole.clone()) };
        names.extend(requested.optional.iter().filter_map(|name| array_of(raw, name)));
        let last = || self.last.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, grid)) = last().as_ref().filter(|last| last.0 == names) {
            return Ok(grid.clone());
        }
        let own = own.filter(|name| names.contains(*name));
        let grid = Arc::new(built(only(raw, &names), own, options, progress)?);
        *last() = Some((names, grid.clone()));
        Ok(grid)
    }
}

/// Name of the array that `NAME`, `NAME:magnitude` or `NAME:0` is made from.
fn array_of(raw: &RawGrid, name: &str) -> Option<String> {
    let stem = || name.rsplit_once(':').map(|(stem, _)| stem);
    let is_known = |name: &&str| raw.point_arrays.contains_key(*name) || raw.cell_arrays.contains_key(*name);
    Some(name).filter(is_known).or_else(|| stem().filter(is_known)).map(str::to_string)
}

/// The grid with these arrays alone.
fn only(raw: &RawGrid, names: &BTreeSet<String>) -> RawGrid {
    let mut raw = raw.clone();
    raw.point_arrays.retain(|name, _| names.contains(name));
    raw.cell_arrays.retain(|name, _| names.contains(name));
    raw
}

fn is_finite(array: &Array) -> bool {
    array.values.par_iter().with_min_len(1 << 15).all(|value| value.is_finite())
}

fn built(raw: RawGrid, scalar: Option<&str>, options: &Options, progress: &dyn Progress) -> Result<Grid> {
    let mut grid = build(raw, options, progress)?;
    if let Some(name) = scalar {
        grid.scalar = grid.point_arrays.get(name).map(|array| array.values.clone());
        grid.scalar_name = name.to_string();
    }
    Ok(grid)
}
