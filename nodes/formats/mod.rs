//! File formats: what the `reader` node and `voltet info` read.
//!
//! | format | module |
//! | --- | --- |
//! | .vtu .vts .vtr .vti, .pvtu .pvts .pvtr .pvti, .pvd | [`xml`] |
//! | .vtk (legacy 2.0 to 5.1, ASCII and binary) | [`legacy`] |
//! | PLOT3D grid and solution | [`plot3d`] |
//!
//! Every format is turned into the same table of contents first ([`piece`]: counts, geometry, and for each array its
//! type and where its bytes lie), without decoding anything. What a [`Request`] asks for is then decoded in
//! parallel straight into its destination ([`stored`], [`codec`], [`numbers`]) and put together ([`assemble`]).
//! The format is told by the content of the file, not by its name; PLOT3D, which has no magic, by its name or by a
//! solution file being given. A further format is a module that gives a [`Dataset`](piece::Dataset) and declares a
//! [`Format`], and a line in [`FORMATS`].
//!
//! Nothing is allocated because a header says so: a size is believed only after the bytes that back it were found
//! in the file (with compression, after the greatest ratio that the codec can reach was applied).
//!
//! Legacy files are read here and not through vtkio, because guarding it (it panics and allocates on damaged
//! files, decodes every array, drops the line numbers) would take more code than reading the format; vtkio serves
//! the tests as an independent writer.

mod ascii;
mod assemble;
mod base64;
mod cells;
mod codec;
mod found;
mod inspect;
mod legacy;
mod merge;
mod numbers;
mod piece;
mod plot3d;
mod select;
mod source;
mod stored;
mod xml;
mod xz;

pub use assemble::Unread;
pub use inspect::{ArraySummary, Summary, inspect};
use piece::Dataset;
use source::Source;
use std::path::{Path, PathBuf};
use std::sync::Arc;
pub use voltet_core::grid::CellValues;
use voltet_core::grid::Grid;
use voltet_core::progress::Progress;
use voltet_core::{Error, Result};

/// A format of files.
struct Format {
    /// What its files are called in messages.
    files: &'static str,
    /// Whether a file is one, by its name and how it begins (a byte order mark and white space left out).
    is_meant: fn(head: &[u8], path: &Path, request: &Request) -> bool,
    /// Reads the table of contents.
    open: fn(Arc<Source>, &Request) -> Result<Dataset>,
    /// Whether a file may come with a second one, [`Request::solution`].
    has_solution: bool,
}

/// The formats, in the order in which a file is tried as one of them.
const FORMATS: &[Format] = &[xml::FORMAT, legacy::FORMAT, plot3d::FORMAT];

/// What the reader's help says of its files.
pub const FILES: &str = "VTK (.vtu .vts .vtr .vti, .pvtu …, .pvd, legacy .vtk) or a PLOT3D grid";

/// What the formats' files are called, in one phrase.
fn files(mut formats: impl Iterator<Item = &'static Format>) -> String {
    let first = formats.next().map_or(String::new(), |format| format.files.to_string());
    formats.fold(first, |phrase, format| phrase + " or " + format.files)
}

/// Whether an array belongs to the points or to the cells.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Association {
    /// The point array of that name, or, if there is none, the cell array.
    #[default]
    Auto,
    /// One tuple a point.
    Point,
    /// One tuple a cell.
    Cell,
}

/// A step of a time series.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum TimeStep {
    /// The step's number in the series, from 0.
    Index(usize),
    /// The step whose time is nearest; must lie within the series.
    Time(f64),
}

/// What is asked of a file. [`Request::default`] reads the only array (or the one the file marks as its scalars).
#[derive(Debug, Clone, PartialEq)]
pub struct Request {
    /// The scalar: an array's name (`density`), or for arrays of several components `NAME:magnitude` or `NAME:0`.
    /// `None`: the only array of the file, or the one that the file marks as its scalars.
    pub scalar: Option<String>,
    /// Where to look for the scalar.
    pub association: Association,
    /// What becomes of a scalar per cell.
    pub cell_values: CellValues,
    /// Further arrays, per point (cell arrays are averaged); all components, or one as in `scalar`.
    pub point_arrays: Vec<String>,
    /// Cell arrays that are wanted as they are; all components, or one as in `scalar`.
    pub cell_arrays: Vec<String>,
    /// The step of a time series (.pvd); `None`: the first.
    pub time_step: Option<TimeStep>,
    /// Pieces between two neighbouring nodes of a curved cell's edge, 1 to 64: 1 goes straight from node to node
    /// (through the mid-edge nodes).
    pub subdivision: u32,
    /// The PLOT3D solution (q) file that belongs to the grid file; `None`: the grid's name with the ending `.q`, if
    /// there is such a file.
    pub solution: Option<PathBuf>,
    /// Every other array is decoded too, though nobody looks at it: to show what not doing so saves.
    pub every_array: bool,
}

impl Default for Request {
    fn default() -> Self {
        Request {
            scalar: None,
            association: Association::Auto,
            cell_values: CellValues::Average,
            point_arrays: Vec::new(),
            cell_arrays: Vec::new(),
            time_step: None,
            subdivision: 1,
            solution: None,
            every_array: false,
        }
    }
}

/// Reads a grid and the arrays that `request` names.
///
/// # Errors
/// One error that names the file, the array or element, what was found and what would be right.
pub fn read(path: &Path, request: &Request, progress: &dyn Progress) -> Result<Grid> {
    let dataset = open(path, request)?;
    assemble::assemble(&dataset, request, progress).map_err(|error| error.in_file(path))
}

/// Arrays that [`read`] would not decode for this request, and how many numbers they hold. Reads headers alone.
///
/// # Errors
/// As [`read`], as far as headers show them.
pub fn unread(path: &Path, request: &Request) -> Result<Unread> {
    let dataset = open(path, request)?;
    assemble::unread(&dataset, &assemble::choices(&dataset, request)?).map_err(|error| error.in_file(path))
}

/// Reads the table of contents of a file by the format that it shows; what is asked for but cannot be of such a file is an
/// error.
fn open(path: &Path, request: &Request) -> Result<Dataset> {
    let source = Source::open(path)?;
    let in_file = |error: Error| error.in_file(path);
    let head = source.head(256).map_err(in_file)?;
    let text = head.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(&head).trim_ascii_start();
    let Some(format) = FORMATS.iter().find(|format| (format.is_meant)(text, path, request)) else {
        let error = Error::run("the format of the file is not known").found(source::shown(&head));
        return Err(in_file(error.accepted(files(FORMATS.iter()))));
    };
    let dataset = (format.open)(source, request).map_err(in_file)?;
    if dataset.time_steps.is_empty()
        && let Some(step) = request.time_step.filter(|step| *step != TimeStep::Index(0))
    {
        let found = match step {
            TimeStep::Index(index) => format!("step {index}"),
            TimeStep::Time(time) => format!("time {time}"),
        };
        let error = Error::run("a time step is asked for, but the file is no time series");
        return Err(in_file(error.found(found).accepted("a .pvd file, or no time step")));
    }
    if request.solution.is_some() && !format.has_solution {
        let with = files(FORMATS.iter().filter(|format| format.has_solution));
        return Err(in_file(
            Error::run("a solution is named, but the grid is of a format without")
                .found(&dataset.format)
                .accepted(format!("{with}, or no solution")),
        ));
    }
    Ok(dataset)
}
