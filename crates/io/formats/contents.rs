//! The table of contents of a data set: what lies in which file, before anything is decoded.

use super::codec::Codec;
use super::hdf5_chunks::ChunkRows;
use super::lattice::Lattice;
use super::numbers::{ByteOrder, NumberType};
use super::source::Source;
use glam::{DMat3, DVec3};
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use voltet_core::grid::{Association, BoundaryValues, Cells};
use voltet_core::progress::{NoProgress, Progress, refuse_beyond_memory};
use voltet_core::reading::{FileArray, OpenGrid};
use voltet_core::{Error, Result, counted};

/// Name of the cell array that holds the number of each cell's block.
pub const BLOCK: &str = "block";
/// Arrays with these names flag ghosts and are not offered as quantities.
pub(super) const GHOST_TYPE: &str = "vtkGhostType";
/// The flag's older form: the number of layers from the piece's own cells.
pub(super) const GHOST_LEVELS: &str = "vtkGhostLevels";
/// Fields that hold the time of a file: VTK's, and that of VisIt.
pub(super) const TIME: [&str; 2] = ["TimeValue", "TIME"];
/// The degrees of Lagrange and Bézier cells along their axes: the name of the cell array, and of the attribute that marks one.
pub(super) const DEGREES: &str = "HigherOrderDegrees";
/// Names that VTK and its readers give to the array that numbers the points of all pieces, where none is marked as such.
pub(super) const GLOBAL_IDS: [&str; 4] =
    ["GlobalPointIds", "vtkGlobalPointIds", "GlobalNodeIds", "GlobalNodeId"];

/// Everything that one reading may decode.
#[derive(Default)]
pub(super) struct Dataset {
    /// Format and encoding, for people: "VTK XML UnstructuredGrid, appended raw, zlib, little-endian".
    pub format: String,
    /// The parts, whose cells are put together.
    pub pieces: Vec<Piece>,
    /// True if the parts are different grids, whose points stay apart.
    pub has_blocks: bool,
    /// Names of the blocks in the order of the file, those that the request leaves out, too; with `/` between those of a group and
    /// of a block within. Empty where the format has no blocks, or the file one without a name.
    pub blocks: Vec<String>,
    /// Name of the array that the file marks as the global ids of the points.
    pub global_ids: Option<String>,
    /// Times of a series' steps; empty where there is no series.
    pub time_steps: Vec<f64>,
    /// The time that the file says it is of.
    pub time: Option<f64>,
    /// Name of the array that the file marks as its scalars.
    pub active_scalars: Option<String>,
    /// Sentences for the user.
    pub warnings: Vec<String>,
    /// Further contents of the file, for people: "2 node sets: 'inlet', 'outlet'".
    pub notes: Vec<String>,
    /// Bytes of the files that hold points, cells and arrays.
    pub file_bytes: u64,
}

impl Dataset {
    /// Notes the times of the first of its parts that has some as its own; `parts`: what they are. Errors: they are no times, or
    /// others than those.
    pub fn note_times(&mut self, times: &[f64], parts: &str) -> Result<()> {
        if times.is_empty() || times.iter().any(|time| !time.is_finite()) {
            let error = Error::run("the times of the steps are damaged");
            return Err(error.expected("at least one finite time"));
        }
        if self.time_steps.is_empty() {
            self.time_steps = times.to_vec();
        } else if self.time_steps != times {
            return Err(Error::run(format!("the {parts} differ in their time steps")));
        }
        Ok(())
    }
}

/// One part: its own points and cells.
pub(super) struct Piece {
    pub point_count: u64,
    pub cell_count: u64,
    pub geometry: Geometry,
    pub arrays: Vec<PieceArray>,
    pub blocks: CellBlocks,
    /// True if the file is of a version in which Lagrange and Bézier hexahedra had two edges in the other order.
    pub is_old_order: bool,
}

/// A piece and its number in [`Dataset::pieces`].
pub(super) type NumberedPiece<'a> = (usize, &'a Piece);

/// Blocks of the cells of a piece, by their numbers in [`Dataset::blocks`].
#[derive(Clone)]
pub(super) enum CellBlocks {
    /// One for all cells.
    One(usize),
    /// One after the other: the number of a block, and of its cells.
    Runs(Vec<(usize, u64)>),
    /// In any order: the number of each cell's block. Where grids are several, pieces of one have the same `grid`, the number of
    /// one of its blocks.
    Each { numbers: Compute, grid: Option<usize> },
}

impl Default for CellBlocks {
    fn default() -> Self {
        CellBlocks::One(0)
    }
}

#[derive(Clone)]
pub(super) struct PieceArray {
    pub association: Association,
    pub stored: Stored,
    /// Names of the components, where the file gives them.
    pub component_names: Vec<String>,
    /// Blocks of the piece without values, whose cells have NaN.
    pub blocks_without: Vec<usize>,
    /// Unit that the file states.
    pub unit: Option<String>,
    /// Values of an array of cells on faces at the boundary, where the file has some.
    pub boundary: Option<ComputeBoundary>,
}

/// Reads the values of an array on faces at the boundary, with warnings about those that are not read.
pub(super) type ComputeBoundary = Arc<dyn Fn(&Meter) -> Result<(BoundaryValues, Vec<String>)> + Send + Sync>;

pub(super) enum Geometry {
    /// Points and cells of any type.
    Unstructured { points: Stored, cells: Box<StoredCells> },
    /// A box of hexahedra; `dimensions` counts points. `points`: first coordinate fastest.
    Curvilinear { dimensions: [u64; 3], points: Stored },
    /// Grid that is read in passes, by code of a format or by a reader from outside.
    Open(Arc<OpenPiece>),
    /// Boxes of several sizes.
    Adaptive(Arc<Lattice>),
    /// Axis-parallel boxes between coordinates.
    Rectilinear { dimensions: [u64; 3], axes: Box<[Stored; 3]> },
    /// Equal boxes: point (i, j, k) lies at `origin + direction · (spacing · (first + (i, j, k)))`.
    Uniform { dimensions: [u64; 3], first: DVec3, origin: DVec3, spacing: DVec3, direction: DMat3 },
}

/// Makes cells of what a file stores in a form of its own.
pub(super) type Convert = Arc<dyn Fn(&Meter) -> Result<Cells> + Send + Sync>;

pub(super) enum StoredCells {
    /// Connectivity with the end (or the bounds) of every cell's part; faces of polyhedra.
    Offsets { connectivity: Stored, offsets: Stored, types: Stored, faces: StoredFaces },
    /// The list of legacy files before 5.0: a count before each cell's points.
    Counted { list: Stored, types: Stored },
    /// In another form, made by a function.
    Converted(Convert),
}

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

impl StoredFaces {
    /// Numbers that they are stored as beside the connectivity; 0 where headers tell none.
    pub fn value_count(&self) -> u64 {
        let count = |stored: &Stored| stored.value_count().unwrap_or(0);
        match self {
            StoredFaces::Stream { faces, .. } => count(faces),
            StoredFaces::Indexed { points, faces, .. } => count(points).saturating_add(count(faces)),
            StoredFaces::None | StoredFaces::InConnectivity => 0,
        }
    }
}

impl PieceArray {
    /// An array whose components have no names.
    pub fn new(association: Association, stored: Stored) -> PieceArray {
        PieceArray {
            association,
            stored,
            component_names: Vec::new(),
            blocks_without: Vec::new(),
            unit: None,
            boundary: None,
        }
    }

    /// An array that is computed when it is asked for. `counts`: of points and of cells.
    pub fn computed(
        source: &Arc<Source>,
        head: &FileArray,
        counts: [u64; 2],
        compute: impl Fn(&Meter) -> Result<Vec<f64>> + Send + Sync + 'static,
    ) -> PieceArray {
        let &FileArray { ref name, association, component_count } = head;
        let tuple_count = counts[usize::from(association == Association::Cell)];
        PieceArray::new(association, Stored::computed(source, name, component_count, tuple_count, compute))
    }

    pub fn head(&self) -> FileArray {
        let Stored { name, component_count, .. } = &self.stored;
        FileArray { name: name.clone(), association: self.association, component_count: *component_count }
    }
}

impl Piece {
    /// Part without blocks of its own. Counts: of points and of cells.
    pub fn new([point_count, cell_count]: [u64; 2], geometry: Geometry, arrays: Vec<PieceArray>) -> Piece {
        Piece {
            point_count,
            cell_count,
            geometry,
            arrays,
            blocks: CellBlocks::default(),
            is_old_order: false,
        }
    }

    /// Part whose points, cells and arrays an open file gives when they are asked for.
    pub fn of_open(source: &Arc<Source>, open: Arc<dyn OpenGrid>) -> Piece {
        let head = open.head().clone();
        let counts = [head.point_count, head.cell_count];
        let open = Arc::new(OpenPiece::new(open));
        let array = |(place, array): (usize, &FileArray)| {
            let of = open.clone();
            PieceArray::computed(source, array, counts, move |meter| {
                of.take(Some(place), |read| read.arrays.remove(&place), meter.progress())
            })
        };
        let arrays = head.arrays.iter().enumerate().map(array).collect();
        Piece::new(counts, Geometry::Open(open), arrays)
    }

    pub fn with_blocks(self, blocks: CellBlocks) -> Piece {
        Piece { blocks, ..self }
    }

    pub fn arrays_of(&self, association: Association) -> impl Iterator<Item = &PieceArray> {
        self.arrays.iter().filter(move |array| array.association == association)
    }

    pub fn array(&self, association: Association, name: &str) -> Option<&Stored> {
        self.arrays_of(association).map(|array| &array.stored).find(|stored| stored.name == name)
    }
}

/// Points and cells of a structured extent, by its numbers of points. Errors: they leave 64 bits.
pub(super) fn structured_counts(dimensions: [u64; 3]) -> Result<(u64, u64)> {
    let too_large = || Error::run("the grid cannot be that large").got(format_args!("{dimensions:?} points"));
    let product = |n: [u64; 3]| n[0].checked_mul(n[1])?.checked_mul(n[2]);
    let points = product(dimensions).ok_or_else(too_large)?;
    // As in VTK, an axis with one point gives cells of a lower dimension, of which there are no more than points.
    let cells = if points == 0 { None } else { product(dimensions.map(|n| (n - 1).max(1))) };
    Ok((points, cells.unwrap_or(0)))
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
        self.progress.check_cancelled()
    }
}

/// Makes the values of an array that no part of the file holds as such (PLOT3D's derived quantities).
pub(super) type Compute = Arc<dyn Fn(&Meter) -> Result<Vec<f64>> + Send + Sync>;

/// Reads the bytes of an array, in its type and byte order, from where they do not lie side by side (chunks of HDF5).
pub(super) type Gather = Arc<dyn Fn() -> Result<Vec<u8>> + Send + Sync>;

pub(super) type FindChunks = Arc<dyn Fn() -> Option<ChunkRows> + Send + Sync>;

#[derive(Clone)]
pub(super) enum Encoding {
    /// Bytes of the file, without a header.
    Bytes(u64),
    /// Words of text in these parts of the file.
    Text(Vec<Range<u64>>),
    /// The binary form of the VTK XML formats: a length or block table, then the values; `base64` text or bytes,
    /// between `at` and `end`.
    Xml { at: u64, end: u64, base64: bool, wide: bool, codec: Option<Codec> },
    /// Bytes from many places of the file.
    Gathered(Gather),
    /// Chunks of HDF5 that are decoded here, or by the other function where the first finds none.
    Chunked(FindChunks, Gather),
    /// Not in the file.
    Computed(Compute),
}

/// An array that lies in a file.
#[derive(Clone)]
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
    /// The first number; `None` where there is none, or where it is damaged.
    pub fn first(&self) -> Option<f64> {
        self.load(&Meter::new(&NoProgress, 1)).ok().and_then(|numbers: Vec<f64>| numbers.first().copied())
    }

    /// An array of 64-bit numbers.
    pub fn of_f64(
        source: &Arc<Source>,
        name: &str,
        component_count: usize,
        tuple_count: u64,
        encoding: Encoding,
    ) -> Stored {
        Stored {
            source: source.clone(),
            name: name.to_owned(),
            number_type: NumberType::F64,
            order: ByteOrder::Little,
            component_count,
            tuple_count: Some(tuple_count),
            encoding,
        }
    }

    /// An array of 64-bit numbers that is computed when it is asked for.
    pub fn computed(
        source: &Arc<Source>,
        name: &str,
        component_count: usize,
        tuple_count: u64,
        compute: impl Fn(&Meter) -> Result<Vec<f64>> + Send + Sync + 'static,
    ) -> Stored {
        Stored::of_f64(source, name, component_count, tuple_count, Encoding::Computed(Arc::new(compute)))
    }

    /// That its file may hold as many values as the headers promise: with compression, as many as the codec can make of the whole file.
    pub fn check_backing(&self) -> Result<()> {
        let greatest = match &self.encoding {
            // A value takes a letter, and a space before the next.
            Encoding::Text(parts) => {
                parts.iter().map(|part| (part.end - part.start).div_ceil(2)).fold(0, u64::saturating_add)
            }
            Encoding::Xml { at, end, codec, .. } => {
                let len = end.saturating_sub(*at);
                let bytes = codec.map_or(len, |codec| codec.greatest_size(len));
                bytes.saturating_mul(8) / self.number_type.byte_count(8).unwrap_or(8)
            }
            Encoding::Bytes(at) => {
                let bytes = self.promised()?.and_then(|count| self.number_type.byte_count(count));
                return self
                    .source
                    .check(*at, bytes.unwrap_or(u64::MAX))
                    .map_err(|error| error.at_item(&self.name));
            }
            // Chunks were compared with their file when they were found.
            Encoding::Gathered(_) | Encoding::Chunked(..) | Encoding::Computed(_) => return Ok(()),
        };
        match self.promised()? {
            Some(count) if count > greatest => {
                let error =
                    Error::run("the array is larger than the file can hold").got(counted(count, "value"));
                Err(error.expected(format_args!("at most {greatest}")).at_item(&self.name))
            }
            _ => Ok(()),
        }
    }

    pub(super) fn promised(&self) -> Result<Option<u64>> {
        let Some(tuple_count) = self.tuple_count else { return Ok(None) };
        match tuple_count.checked_mul(self.component_count as u64).filter(|&n| n <= isize::MAX as u64 / 32) {
            Some(count) => Ok(Some(count)),
            None => {
                Err(Error::run("the array cannot be that large")
                    .got(tuples(tuple_count, self.component_count)))
            }
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

/// An open grid, and what was read of it and not yet taken.
pub(super) struct OpenPiece {
    open: Arc<dyn OpenGrid>,
    ready: Mutex<PartsRead>,
}

/// Parts of a file that were read.
#[derive(Default)]
pub(super) struct PartsRead {
    pub points: Option<Vec<DVec3>>,
    pub cells: Option<Cells>,
    /// By their places in the head.
    pub arrays: BTreeMap<usize, Vec<f64>>,
    pub warnings: Vec<String>,
    /// Places of arrays that are read in one pass with what is taken next.
    ahead: Vec<usize>,
}

impl OpenPiece {
    /// Wraps an open grid of which nothing was read yet.
    pub fn new(open: Arc<dyn OpenGrid>) -> OpenPiece {
        OpenPiece { open, ready: Mutex::default() }
    }

    /// Parts that were read and not yet taken.
    pub fn ready(&self) -> MutexGuard<'_, PartsRead> {
        self.ready.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Places in the head of those arrays of its piece that are `wanted`: the head's come first, by the names that the piece gives them.
    pub fn places(&self, piece: &Piece, wanted: impl Fn(&PieceArray) -> bool) -> Vec<usize> {
        let arrays = piece.arrays.iter().take(self.open.head().arrays.len()).enumerate();
        arrays.filter(|(_, array)| wanted(array)).map(|(place, _)| place).collect()
    }

    /// Has the arrays at these places read in one pass with the part that is taken next.
    pub fn read_ahead(&self, places: Vec<usize>) {
        let mut ready = self.ready();
        ready.ahead = places.into_iter().filter(|place| !ready.arrays.contains_key(place)).collect();
    }

    /// Bytes of the points, and of one number a point of each of at most so many arrays, that were read and not yet taken.
    pub fn ready_bytes(&self, array_count: usize) -> u64 {
        let (ready, point_count) = (self.ready(), self.open.head().point_count);
        let points = ready.points.as_ref().map_or(0, |points| size_of_val(&points[..]) as u64);
        let numbers = ready.arrays.values().take(array_count).map(|own| point_count.min(own.len() as u64));
        points.saturating_add(numbers.fold(0, u64::saturating_add).saturating_mul(8))
    }

    /// Bytes that the grid and the arrays at these places take.
    pub fn byte_count(&self, geometry: bool, places: &[usize]) -> u64 {
        let head = self.open.head();
        let grid =
            if geometry { head.point_count.saturating_mul(24).saturating_add(head.cell_bytes) } else { 0 };
        let numbers =
            |array: &FileArray| head.tuple_count(array).saturating_mul(array.component_count as u64);
        let arrays = places.iter().filter_map(|&place| head.arrays.get(place));
        arrays.fold(grid, |sum, array| sum.saturating_add(numbers(array).saturating_mul(8)))
    }

    /// Reads the grid, if `geometry`, and the arrays at these places, as they are taken afterwards. The caller has refused what is
    /// beyond memory.
    ///
    /// Errors: the reader fails, or gives more or less than its head says.
    pub fn read(&self, geometry: bool, places: &[usize], progress: &dyn Progress) -> Result<()> {
        let (head, read) = (self.open.head(), self.open.read(geometry, places, progress)?);
        let points = (read.points.as_ref().map_or(0, Vec::len), head.point_count, "all points");
        let cells = (read.cells.as_ref().map_or(0, Cells::count), head.cell_count, "all cells");
        let arrays = (read.arrays.len(), places.len() as u64, "all arrays");
        let parts = if geometry { &[points, cells, arrays][..] } else { &[arrays] };
        if let Some((found, accepted, what)) = parts.iter().find(|part| part.0 as u64 != part.1) {
            let error = Error::run(format!("the reader did not give {what}, as it had said"));
            return Err(error.got(found).expected(accepted));
        }
        let mut ready = self.ready();
        if geometry {
            (ready.points, ready.cells) = (read.points, read.cells);
        }
        ready.arrays.extend(places.iter().copied().zip(read.arrays));
        ready.warnings.extend(read.warnings);
        Ok(())
    }

    /// A part by the function that takes it from what was read: the geometry, or the array at a place. Read now if it is not there, with the
    /// arrays that are read ahead.
    ///
    /// Errors: as [`read`](Self::read); memory ends before it is there.
    pub fn take<T>(
        &self,
        array: Option<usize>,
        take: impl Fn(&mut PartsRead) -> Option<T>,
        progress: &dyn Progress,
    ) -> Result<T> {
        let mut places = {
            let mut ready = self.ready();
            if let Some(taken) = take(&mut ready) {
                return Ok(taken);
            }
            std::mem::take(&mut ready.ahead)
        };
        places.extend(array.filter(|place| !places.contains(place)));
        let head = self.open.head();
        let what = || grid_of(head.point_count, head.cell_count);
        refuse_beyond_memory(progress, what, self.byte_count(array.is_none(), &places))?;
        self.read(array.is_none(), &places, progress)?;
        take(&mut self.ready()).ok_or_else(|| Error::run("the reader did not give what was asked for"))
    }
}

/// "a grid of 8 points and 1 cell".
pub(super) fn grid_of(point_count: u64, cell_count: u64) -> String {
    format!("a grid of {} and {}", counted(point_count, "point"), counted(cell_count, "cell"))
}

/// "64 tuples of 3 components".
pub(super) fn tuples(tuple_count: u64, component_count: usize) -> String {
    format!("{} of {}", counted(tuple_count, "tuple"), counted(component_count, "component"))
}
