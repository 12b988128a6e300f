//! The list of formats, and what tells a file's; files of formats that come from outside.

use super::contents::{
    Compute, Dataset, Encoding, ExternalFormat, Format, Geometry, Piece, PieceArray, Stored,
};
use super::numbers::{ByteOrder, NumberType};
use super::request::{Request, SelectedArrays, TimeStep};
use super::source::Source;
use super::{legacy, plot3d, source, unsupported, xml};
use std::path::Path;
use std::sync::Arc;
use voltet_core::grid::Association;
use voltet_core::reading::FileArray;
use voltet_core::{Error, Result};

/// The formats, in the order in which a file is tried as one of them.
const FORMATS: &[Format] = &[xml::FORMAT, legacy::FORMAT, plot3d::FORMAT];

/// File types of the reader, for its help.
pub const FILES: &str = "VTK (.vtu .vts .vtr .vti, .pvtu …, .pvd, legacy .vtk) or a PLOT3D grid";

/// File types of several formats, in one phrase.
fn files(mut formats: impl Iterator<Item = &'static Format>) -> String {
    let first = formats.next().map_or(String::new(), |format| format.files.to_string());
    formats.fold(first, |phrase, format| phrase + " or " + format.files)
}

/// Reads the table of contents of a file by the format that it shows; what is asked for but cannot be of such a file is an
/// error.
pub(super) fn open(path: &Path, request: &Request) -> Result<Dataset> {
    unsupported::refuse_folder(path)?;
    let source = Source::open(path)?;
    let in_file = |error: Error| error.in_file(path);
    if let Some(chosen) = &request.chosen {
        let dataset = open_external(&source, request, chosen).map_err(in_file)?;
        return refuse_no_series(dataset, request, "a file that is a series, or no time step")
            .map_err(in_file);
    }
    unsupported::refuse_by_magic(&source).map_err(in_file)?;
    let head = source.head(256).map_err(in_file)?;
    let Some(format) = format_of(&head, path, request) else {
        unsupported::refuse_by_words(&source).map_err(in_file)?;
        let error = Error::run("the format of the file is not known").got(source::printable(&head));
        let formats = files(FORMATS.iter());
        return Err(in_file(
            error.expected(format!("{formats}; formats from outside have nodes of their own")),
        ));
    };
    let dataset = (format.open)(source, request).map_err(in_file)?;
    let dataset = refuse_no_series(dataset, request, "a .pvd file, or no time step").map_err(in_file)?;
    if request.solution.is_some() && !format.has_solution {
        let with = files(FORMATS.iter().filter(|format| format.has_solution));
        return Err(in_file(
            Error::run("a solution is named, but the grid is of a format without")
                .got(&dataset.format)
                .expected(format!("{with}, or no solution")),
        ));
    }
    Ok(dataset)
}

/// True if a file is of a format that ships. One that cannot be read is, too: there is nothing to ask others for.
pub fn ships(path: &Path) -> bool {
    let head = Source::open(path).and_then(|source| source.head(256));
    head.is_err() || head.is_ok_and(|head| format_of(&head, path, &Request::default()).is_some())
}

/// The format that a file shows, by how it begins and its name.
fn format_of(head: &[u8], path: &Path, request: &Request) -> Option<&'static Format> {
    let text = head.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(head).trim_ascii_start();
    FORMATS.iter().find(|format| (format.matches)(text, path, request))
}

/// Errors: a step that is none is asked for.
fn refuse_no_series(dataset: Dataset, request: &Request, accepted: &str) -> Result<Dataset> {
    let step = request.time_step.filter(|step| *step != TimeStep::Index(0));
    let Some(step) = step.filter(|_| dataset.time_steps.is_empty()) else { return Ok(dataset) };
    let found = match step {
        TimeStep::Index(index) => format!("step {index}"),
        TimeStep::Time(time) => format!("time {time}"),
    };
    let error = Error::run("a time step is asked for, but the file is no time series");
    Err(error.got(found).expected(accepted))
}

/// Reads the table of contents.
pub(super) fn open_external(
    source: &Arc<Source>,
    request: &Request,
    chosen: &SelectedArrays,
) -> Result<Dataset> {
    let SelectedArrays { reader, parameters } = chosen;
    let at = |step: usize| reader.open(source.path(), step, parameters, &voltet_core::progress::NoProgress);
    let mut opened = at(0)?;
    let step = match opened.head().times.as_slice() {
        [] => 0,
        times => request.step_index(times)?,
    };
    if step > 0 {
        opened = at(step)?;
    }
    let head = opened.head().clone();
    let added = Arc::new(ExternalFormat::new(opened));
    let array = |(place, array): (usize, &FileArray)| {
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
