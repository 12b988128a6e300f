//! Files of formats that come from outside, decoded by their reader.
//!
//! What a request means is asked of the reader at once ([`Added::fetch`]), since one that looks through a text would do so for
//! every array; what is asked for later is read when it is wanted.

use glam::DVec3;
use std::sync::{Mutex, MutexGuard, PoisonError};
use voltet_core::grid::{Association, Cells};
use voltet_core::progress::{Progress, refuse_beyond_memory};
use voltet_core::reading::{GridRead, OpenGrid};
use voltet_core::{Error, Result};

/// An open file, and what was read of it and not yet taken.
pub(super) struct ExternalFormat {
    open: Box<dyn OpenGrid>,
    ready: Mutex<ParsedHead>,
}

#[derive(Default)]
struct ParsedHead {
    points: Option<Vec<DVec3>>,
    cells: Option<Cells>,
    arrays: Vec<Option<Vec<f64>>>,
    warnings: Vec<String>,
}

impl std::fmt::Debug for ExternalFormat {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Added").field("head", self.open.head()).finish_non_exhaustive()
    }
}

impl ExternalFormat {
    /// Wraps an open file of which nothing was read yet.
    pub fn new(open: Box<dyn OpenGrid>) -> ExternalFormat {
        let ready = ParsedHead { arrays: vec![None; open.head().arrays.len()], ..ParsedHead::default() };
        ExternalFormat { open, ready: Mutex::new(ready) }
    }

    fn ready(&self) -> MutexGuard<'_, ParsedHead> {
        self.ready.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Reads the grid and the arrays with these names, at once, as they are taken afterwards.
    ///
    /// Errors: memory ends before they are there.
    pub fn fetch(&self, wanted: impl Fn(&str, bool) -> bool, progress: &dyn Progress) -> Result<()> {
        let head = self.open.head();
        let is_wanted = |place: &usize| {
            let array = &head.arrays[*place];
            wanted(&array.name, array.association == Association::Cell)
        };
        let places: Vec<usize> = (0..head.arrays.len()).filter(is_wanted).collect();
        let numbers = |place: &usize| {
            let array = &head.arrays[*place];
            let on_cells = array.association == Association::Cell;
            let tuples = if on_cells { head.cell_count } else { head.point_count };
            tuples.saturating_mul(array.component_count as u64)
        };
        let arrays = places.iter().map(numbers).fold(0u64, u64::saturating_add);
        let bytes = head.point_count.saturating_mul(24).saturating_add(head.cell_bytes);
        let what = || format!("a grid of {} points and {} cells", head.point_count, head.cell_count);
        refuse_beyond_memory(progress, what, bytes.saturating_add(arrays.saturating_mul(8)))?;
        self.read(true, &places, progress)
    }

    fn read(&self, geometry: bool, places: &[usize], progress: &dyn Progress) -> Result<()> {
        let read = self.open.read(geometry, places, progress)?;
        self.check(&read, geometry, places)?;
        let mut ready = self.ready();
        if geometry {
            (ready.points, ready.cells) = (read.points, read.cells);
        }
        for (&place, values) in places.iter().zip(read.arrays) {
            ready.arrays[place] = Some(values);
        }
        ready.warnings.extend(read.warnings);
        Ok(())
    }

    /// Errors: the reader gave more or less than its head says.
    fn check(&self, read: &GridRead, geometry: bool, places: &[usize]) -> Result<()> {
        let head = self.open.head();
        let expect = |what: &str, found: Option<usize>, accepted: u64| match found {
            Some(found) if found as u64 == accepted => Ok(()),
            found => {
                let error = Error::run(format!("the reader did not give {what}, as it had said"));
                Err(error.got(found.unwrap_or(0)).expected(accepted))
            }
        };
        if geometry {
            expect("all points", read.points.as_ref().map(Vec::len), head.point_count)?;
            expect("all cells", read.cells.as_ref().map(Cells::count), head.cell_count)?;
        }
        expect("all arrays", Some(read.arrays.len()), places.len() as u64)
    }

    /// The points; read now if they are not there.
    pub fn points(&self, progress: &dyn Progress) -> Result<Vec<DVec3>> {
        self.checked(|ready| ready.points.take(), true, &[], progress)
    }

    /// The cells.
    pub fn cells(&self, progress: &dyn Progress) -> Result<Cells> {
        self.checked(|ready| ready.cells.take(), true, &[], progress)
    }

    /// The values of an array.
    pub fn array(&self, place: usize, progress: &dyn Progress) -> Result<Vec<f64>> {
        self.checked(|ready| ready.arrays[place].take(), false, &[place], progress)
    }

    fn checked<T>(
        &self,
        take: impl Fn(&mut ParsedHead) -> Option<T>,
        geometry: bool,
        places: &[usize],
        progress: &dyn Progress,
    ) -> Result<T> {
        if let Some(taken) = take(&mut self.ready()) {
            return Ok(taken);
        }
        self.read(geometry, places, progress)?;
        let gone = || Error::run("the reader did not give what was asked for");
        take(&mut self.ready()).ok_or_else(gone)
    }

    /// Warnings of the reader.
    pub fn warnings(&self) -> Vec<String> {
        self.ready().warnings.clone()
    }
}
