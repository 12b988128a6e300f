//! Files of formats that come from outside: the table of contents of what their reader says, decoded by it.
//!
//! What a request means is asked of the reader at once ([`Added::fetch`]), since one that looks through a text would do so for
//! every array; what is asked for later is read when it is wanted.

use super::numbers::{ByteOrder, NumberType};
use super::piece::{Dataset, Geometry, Piece, PieceArray};
use super::request::{Request, TimeStep};
use super::source::Source;
use super::stored::{Compute, Encoding, Stored};
use glam::DVec3;
use std::path::Path;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use voltet_core::grid::{Association, Cells};
use voltet_core::parameters::Parameters;
use voltet_core::progress::{Progress, refuse_beyond_memory};
use voltet_core::reading::{GridRead, GridReader, OpenGrid};
use voltet_core::{Error, Result};

/// The reader of a format that comes from outside, with what its parameters are set to.
#[derive(Clone)]
pub struct Chosen {
    /// The reader.
    pub reader: &'static dyn GridReader,
    /// Its parameters, and maybe others.
    pub parameters: Parameters,
}

impl Chosen {
    /// With its standard values, for a file of its format; the first of several. `None` where it is of none of theirs.
    ///
    /// Errors: the file cannot be read; a parameter that must be given.
    pub fn for_file(
        path: &Path,
        mut readers: impl Iterator<Item = &'static dyn GridReader>,
    ) -> Result<Option<Chosen>> {
        let mut head = None;
        let meant = readers.find_map(|reader| {
            // Not opened for nobody.
            let head = head.get_or_insert_with(|| Source::open(path).and_then(|source| source.head(256)));
            match head {
                Ok(head) => reader.is_meant(head, path).then_some(Ok(reader)),
                Err(error) => Some(Err(error.clone())),
            }
        });
        let Some(reader) = meant.transpose()? else { return Ok(None) };
        let parameters = Parameters::of(reader.declaration().parameters, [])?;
        Ok(Some(Chosen { reader, parameters }))
    }
}

impl PartialEq for Chosen {
    fn eq(&self, other: &Chosen) -> bool {
        std::ptr::addr_eq(self.reader, other.reader) && self.parameters == other.parameters
    }
}

impl std::fmt::Debug for Chosen {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Chosen").field("reader", &self.reader.declaration().name).finish_non_exhaustive()
    }
}

/// An open file, and what was read of it and not yet taken.
pub(super) struct Added {
    open: Box<dyn OpenGrid>,
    ready: Mutex<Ready>,
}

#[derive(Default)]
struct Ready {
    points: Option<Vec<DVec3>>,
    cells: Option<Cells>,
    arrays: Vec<Option<Vec<f64>>>,
    warnings: Vec<String>,
}

impl std::fmt::Debug for Added {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Added").field("head", self.open.head()).finish_non_exhaustive()
    }
}

/// Reads the table of contents.
pub(super) fn open(source: &Arc<Source>, request: &Request, chosen: &Chosen) -> Result<Dataset> {
    let Chosen { reader, parameters } = chosen;
    let at = |step: usize| reader.open(source.path(), step, parameters, &voltet_core::progress::Silent);
    let step = match request.time_step {
        None => 0,
        Some(TimeStep::Index(step)) => step,
        Some(TimeStep::Time(time)) => nearest(&at(0)?.head().times, time)?,
    };
    let mut open = at(0)?;
    let step_count = open.head().times.len();
    if step >= step_count.max(1) && step_count > 0 {
        return Err(Error::run("the series has no such time step")
            .found(step)
            .accepted(format!("0 to {}", step_count - 1)));
    }
    if step > 0 && step_count > 0 {
        open = at(step)?;
    }
    let head = open.head().clone();
    let ready = Ready { arrays: vec![None; head.arrays.len()], ..Ready::default() };
    let added = Arc::new(Added { open, ready: Mutex::new(ready) });
    let array = |(place, array): (usize, &voltet_core::reading::ArrayOfFile)| {
        let (per_cell, of) = (array.association == Association::Cell, added.clone());
        let compute: Compute = Arc::new(move |meter| of.array(place, meter.progress()));
        let stored = Stored {
            source: source.clone(),
            name: array.name.clone(),
            number_type: NumberType::F64,
            order: ByteOrder::Little,
            component_count: array.component_count,
            tuple_count: Some(if per_cell { head.cell_count } else { head.point_count }),
            encoding: Encoding::Computed(compute),
        };
        PieceArray { per_cell, stored }
    };
    let piece = Piece {
        point_count: head.point_count,
        cell_count: head.cell_count,
        arrays: head.arrays.iter().enumerate().map(array).collect(),
        geometry: Geometry::Added(added, source.clone()),
    };
    Ok(Dataset {
        format: head.format,
        pieces: vec![piece],
        time_steps: head.times,
        active_scalars: head.scalar,
        warnings: Vec::new(),
    })
}

/// The step whose time is nearest.
fn nearest(times: &[f64], time: f64) -> Result<usize> {
    let (Some(first), Some(last)) = (times.first(), times.last()) else { return Ok(0) };
    if !(*first..=*last).contains(&time) {
        let error = Error::run("the time lies outside the series").found(time);
        return Err(error.accepted(format!("{first} to {last}")));
    }
    let distance = |step: &usize| (times[*step] - time).abs();
    let steps = 0..times.len();
    Ok(steps.min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(0))
}

impl Added {
    fn ready(&self) -> MutexGuard<'_, Ready> {
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
                Err(error.found(found.unwrap_or(0)).accepted(accepted))
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
        self.taken(|ready| ready.points.take(), true, &[], progress)
    }

    /// The cells.
    pub fn cells(&self, progress: &dyn Progress) -> Result<Cells> {
        self.taken(|ready| ready.cells.take(), true, &[], progress)
    }

    /// The values of an array.
    fn array(&self, place: usize, progress: &dyn Progress) -> Result<Vec<f64>> {
        self.taken(|ready| ready.arrays[place].take(), false, &[place], progress)
    }

    fn taken<T>(
        &self,
        take: impl Fn(&mut Ready) -> Option<T>,
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

    /// What the reader warns of.
    pub fn warnings(&self) -> Vec<String> {
        self.ready().warnings.clone()
    }
}
