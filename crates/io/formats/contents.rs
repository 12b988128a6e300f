//! The table of contents of a data set: what lies in which file, before anything is decoded.

use super::codec::Codec;
use super::numbers::{ByteOrder, NumberType};
use super::source::Source;
use glam::{DMat3, DVec3};
use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use voltet_core::grid::{Association, Cells};
use voltet_core::progress::{Progress, refuse_beyond_memory};
use voltet_core::reading::{GridRead, OpenGrid};
use voltet_core::{Error, Result};

/// Arrays with these names flag ghosts and are not offered as quantities.
pub(super) const GHOST_TYPE: &str = "vtkGhostType";
/// The flag's older form: the number of layers from the piece's own cells.
pub(super) const GHOST_LEVELS: &str = "vtkGhostLevels";

/// Everything that one reading may decode.
#[derive(Debug, Default)]
pub(super) struct Dataset {
    /// Format and encoding, for people: "VTK XML UnstructuredGrid, appended raw, zlib, little-endian".
    pub format: String,
    /// The parts, whose cells are put together.
    pub pieces: Vec<Piece>,
    /// Times of a series' steps; empty where there is no series.
    pub time_steps: Vec<f64>,
    /// Name of the array that the file marks as its scalars.
    pub active_scalars: Option<String>,
    /// Sentences for the user.
    pub warnings: Vec<String>,
}

/// One part: its own points and cells.
#[derive(Debug)]
pub(super) struct Piece {
    pub point_count: u64,
    pub cell_count: u64,
    pub geometry: Geometry,
    pub arrays: Vec<PieceArray>,
}

/// An array of a piece.
#[derive(Debug)]
pub(super) struct PieceArray {
    /// True: one tuple a cell; false: one a point.
    pub per_cell: bool,
    pub stored: Stored,
}

/// Points and cells.
#[derive(Debug)]
pub(super) enum Geometry {
    /// Points and cells of any type.
    Unstructured { points: Stored, cells: Box<StoredCells> },
    /// A box of hexahedra; `dimensions` counts points. `points`: first coordinate fastest.
    Curvilinear { dimensions: [u64; 3], points: Stored },
    /// Grid of a reader from outside, from that file.
    Added(Arc<ExternalFormat>, Arc<Source>),
    /// Axis-parallel boxes between coordinates.
    Rectilinear { dimensions: [u64; 3], axes: Box<[Stored; 3]> },
    /// Equal boxes: point (i, j, k) lies at `origin + direction · (spacing · (first + (i, j, k)))`.
    Uniform { dimensions: [u64; 3], first: DVec3, origin: DVec3, spacing: DVec3, direction: DMat3 },
}

/// Cells as a file stores them.
#[derive(Debug)]
pub(super) enum StoredCells {
    /// Connectivity with the end (or the bounds) of every cell's part; faces of polyhedra.
    Offsets { connectivity: Stored, offsets: Stored, types: Stored, faces: StoredFaces },
    /// The list of legacy files before 5.0: a count before each cell's points.
    Counted { list: Stored, types: Stored },
}

/// Faces of polyhedra as a file stores them.
#[derive(Debug)]
pub(super) enum StoredFaces {
    /// There are none.
    None,
    /// `faces`: for each polyhedron the number of faces, then each face's count and points; `offsets`: for each cell
    /// the end of its part, -1 where it is none.
    Stream { faces: Box<Stored>, offsets: Box<Stored> },
    /// Faces once, by number: points of all faces and their bounds; faces of all cells and their bounds.
    Indexed { points: Box<Stored>, point_offsets: Box<Stored>, faces: Box<Stored>, face_offsets: Box<Stored> },
    /// The connectivity of a polyhedron is its stream (legacy files).
    InConnectivity,
}

impl Piece {
    /// The arrays of points (`per_cell` false) or cells.
    pub fn arrays_of(&self, per_cell: bool) -> impl Iterator<Item = &PieceArray> {
        self.arrays.iter().filter(move |array| array.per_cell == per_cell)
    }
}

/// Points and cells of a structured extent, by its numbers of points; `None` on overflow.
pub(super) fn structured_counts(dimensions: [u64; 3]) -> Option<(u64, u64)> {
    let product = |n: [u64; 3]| n[0].checked_mul(n[1])?.checked_mul(n[2]);
    let points = product(dimensions)?;
    // As in VTK, an axis with one point gives cells of a lower dimension.
    let cells = if points == 0 { 0 } else { product(dimensions.map(|n| (n - 1).max(1)))? };
    Some((points, cells))
}

/// Dimensions from an extent (first and last index of each axis).
pub(super) fn extent_dimensions(extent: [i64; 6]) -> [u64; 3] {
    std::array::from_fn(|axis| {
        let span = i128::from(extent[2 * axis + 1]) - i128::from(extent[2 * axis]) + 1;
        u64::try_from(span.max(0)).unwrap_or(u64::MAX)
    })
}

/// Progress of one reading, shared by all its arrays; counts bytes of the file.
pub(super) struct Meter<'a> {
    progress: &'a dyn Progress,
    done: AtomicU64,
    total: u64,
}

impl<'a> Meter<'a> {
    /// A meter over `total` bytes.
    pub fn new(progress: &'a dyn Progress, total: u64) -> Self {
        Meter { progress, done: AtomicU64::new(0), total: total.max(1) }
    }

    /// Progress, for code that reports by itself.
    pub fn progress(&self) -> &'a dyn Progress {
        self.progress
    }

    /// Says that `bytes` more were decoded; an error once the user has stopped the run.
    pub fn advance(&self, bytes: u64) -> Result<()> {
        let done = self.done.fetch_add(bytes, Ordering::Relaxed) + bytes;
        self.progress.report("reading", (done as f64 / self.total as f64).min(1.0));
        if self.progress.cancelled() { Err(Error::cancelled()) } else { Ok(()) }
    }
}

/// Makes the values of an array that no part of the file holds as such (PLOT3D's derived quantities).
pub(super) type Compute = Arc<dyn Fn(&Meter) -> Result<Vec<f64>> + Send + Sync>;

/// Location and encoding of the values.
#[derive(Clone)]
pub(super) enum Encoding {
    /// Bytes of the file, without a header.
    Bytes(u64),
    /// Words of text in these parts of the file.
    Text(Vec<Range<u64>>),
    /// The binary form of the VTK XML formats: a length or block table, then the values; `base64` text or bytes,
    /// between `at` and `end`.
    Xml { at: u64, end: u64, base64: bool, wide: bool, codec: Option<Codec> },
    /// Not in the file.
    Computed(Compute),
}

impl std::fmt::Debug for Encoding {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Encoding::Bytes(at) => write!(f, "bytes from {at}"),
            Encoding::Text(parts) => write!(f, "text in {parts:?}"),
            Encoding::Xml { at, base64, codec, .. } => {
                write!(f, "XML binary at {at}, base64 {base64}, {codec:?}")
            }
            Encoding::Computed(_) => write!(f, "computed"),
        }
    }
}

/// An array that lies in a file.
#[derive(Debug, Clone)]
pub(super) struct Stored {
    pub source: Arc<Source>,
    pub name: String,
    pub number_type: NumberType,
    pub order: ByteOrder,
    /// Components of a tuple, at least 1.
    pub component_count: usize,
    /// Tuples that the headers promise; `None` where only the data itself tells.
    pub tuple_count: Option<u64>,
    pub encoding: Encoding,
}

impl Stored {
    /// Number of values that the headers promise.
    pub(super) fn promised(&self) -> Result<Option<u64>> {
        let Some(tuple_count) = self.tuple_count else { return Ok(None) };
        match tuple_count.checked_mul(self.component_count as u64).filter(|&n| n <= isize::MAX as u64 / 32) {
            Some(count) => Ok(Some(count)),
            None => Err(Error::run("the array cannot be that large")
                .got(format_args!("{tuple_count} tuples of {} components", self.component_count))),
        }
    }

    /// Flags of the points, hidden where this array is 0.
    pub fn hidden_where_zero(&self) -> Stored {
        let blanking = self.clone();
        let hidden = |value: f64| if value == 0.0 { 2.0 } else { 0.0 };
        let flags: Compute =
            Arc::new(move |meter| Ok(blanking.load::<f64>(meter)?.into_iter().map(hidden).collect()));
        Stored { name: GHOST_TYPE.to_owned(), encoding: Encoding::Computed(flags), ..self.clone() }
    }
}

/// An open file of a format that comes from outside, and what was read of it and not yet taken.
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
