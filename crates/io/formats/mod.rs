//! File formats: what the `reader` node and `voltet info` read.
//!
//! | format | module |
//! | --- | --- |
//! | .vtu .vts .vtr .vti, .pvtu .pvts .pvtr .pvti, .pvd | [`xml`] |
//! | .vtk (legacy 2.0 to 5.1, ASCII and binary) | [`legacy`] |
//! | PLOT3D grid and solution | [`plot3d`] |
//!
//! | file | what |
//! | --- | --- |
//! | `request`, `select` | what is asked of a file, and which of its arrays that means |
//! | `open` | the list of formats, and what tells a file's |
//! | `format` | the declaration of a format: how its files are told, and what reads them |
//! | `outside`, `added`, `chosen` | formats that come from outside: table of contents, what their reader decodes, which reader |
//! | `unsupported` | formats that are not read, by name and with what to do |
//! | `source` | a file, read at positions |
//! | `piece`, `stored` | the table of contents: counts, geometry, and how each array lies in the file |
//! | `decodable` | an array's bytes, their number compared with what headers promise |
//! | `codec`, `base64`, `ascii`, `numbers` | from bytes to numbers |
//! | `decode` | arrays into memory, in parallel |
//! | `cells`, `merge`, `assemble` | cells, pieces and the grid |
//! | `inspect` | what `voltet info` shows |
//!
//! Every format is turned into the same table of contents first ([`piece`]: counts, geometry, and for each array its
//! type and where its bytes lie), without decoding anything. What a [`Request`] asks for is then decoded in
//! parallel straight into its destination ([`decodable`], [`codec`], [`decode`]) and put together ([`assemble`]).
//! The format is told by the content of the file, not by its name; PLOT3D, which has no magic, by its name or by a
//! solution file being given. A further format is a module that gives a [`Dataset`] and declares a
//! [`Format`], and a line in `FORMATS` in `open`.
//!
//! Nothing is allocated because a header says so: a size is believed only after the bytes that back it were found
//! in the file (with compression, after the greatest ratio that the codec can reach was applied).
//!
//! Legacy files are read here and not through vtkio, because guarding it (it panics and allocates on damaged
//! files, decodes every array, drops the line numbers) would take more code than reading the format; vtkio serves
//! the tests as an independent writer.

mod assemble;
mod cells;
mod codec;
mod contents;
mod decode;
mod inspect;
mod legacy;
mod numbers;
mod open;
mod plot3d;
mod request;
mod select;
mod source;
mod unsupported;
mod xml;

pub use assemble::{SkippedArray, length};
pub use cells::face_stream;
pub(crate) use cells::into_set;
pub use inspect::{ArrayHead, ArraySummary, Summary, arrays, inspect};
pub use open::{FILES, ships};
pub use request::{Association, Request, SelectedArrays, TimeStep};
pub use select::Component;
pub use voltet_core::grid::CellValues;

use open::open;
use std::path::{Path, PathBuf};
use voltet_core::Result;
use voltet_core::grid::Grid;
use voltet_core::progress::Progress;

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
pub fn unread(path: &Path, request: &Request) -> Result<SkippedArray> {
    let dataset = open(path, request)?;
    assemble::unread(&dataset, &assemble::choices(&dataset, request)?).map_err(|error| error.in_file(path))
}

/// The number of time steps of a file: 1 where it is no series. Reads headers alone.
///
/// # Errors
/// As [`read`], as far as headers show them.
pub fn step_count(path: &Path, request: &Request) -> Result<usize> {
    Ok(open(path, request)?.time_steps.len().max(1))
}

/// The files that reading a data file may open beside it: those that a series or a parallel file names, the solution beside
/// a PLOT3D grid. What cannot be read names none.
pub fn files_beside(path: &Path) -> Vec<PathBuf> {
    let solution = Some(path.with_extension("q")).filter(|solution| solution != path && solution.is_file());
    xml::files_named(path, None).into_iter().chain(solution).collect()
}

/// Further files that reading for this request opens: of a series the files of one step.
pub fn files_read_beside(path: &Path, request: &Request) -> Vec<PathBuf> {
    let solution = plot3d::solution_beside(path, request);
    xml::files_named(path, Some(request)).into_iter().chain(solution).collect()
}
