//! The VTK XML formats: .vtu .vts .vtr .vti ([`serial`]), and the files that name others: their parallel forms, and .pvd, a series
//! of time steps.

mod header;
mod serial;

use super::contents::{Dataset, Format};
use super::request::Request;
use super::source::Source;
use header::{Appended, Element};
use serial::refusal;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use voltet_core::{Error, Result};

/// The declaration.
pub(super) const FORMAT: Format = Format {
    files: "a VTK XML file (.vtu, .vts, .vtr, .vti, their parallel forms, .pvd)",
    matches: |head, _, _| head.starts_with(b"<"),
    open,
    has_solution: false,
};

/// Type of the files that name the files of time steps.
const SERIES: &str = "Collection";

/// True if a file of this type names the files of its pieces.
fn names_pieces(kind: &str) -> bool {
    kind.starts_with('P') && kind != "PolyData"
}

/// Reads the table of contents of a file of any of these formats.
fn open(source: Arc<Source>, request: &Request) -> Result<Dataset> {
    let (root, appended) = header::read(&source)?;
    match root.required("type")? {
        SERIES => open_series(&source, &root, request),
        _ => open_step(source, &root, appended),
    }
}

/// Reads the tables of contents of the files of one step.
fn open_series(source: &Source, root: &Element, request: &Request) -> Result<Dataset> {
    let (time_steps, files) = step(root, request)?;
    let mut dataset = Dataset::default();
    for file in files {
        add(source, file, open_step, &mut dataset)?;
    }
    dataset.format = format!("VTK time series of {} steps; {}", time_steps.len(), dataset.format);
    dataset.time_steps = time_steps;
    Ok(dataset)
}

/// One file of a step.
fn open_step(source: Arc<Source>, root: &Element, appended: Option<Appended>) -> Result<Dataset> {
    match root.required("type")? {
        SERIES => Err(misplaced(SERIES)),
        kind if names_pieces(kind) => open_parallel(&source, root),
        _ => serial::open(source, root, appended),
    }
}

/// Reads the tables of contents of all pieces.
fn open_parallel(source: &Source, root: &Element) -> Result<Dataset> {
    let kind = root.required("type")?;
    if !["PUnstructuredGrid", "PStructuredGrid", "PRectilinearGrid", "PImageData"].contains(&kind) {
        return Err(refusal(kind, root));
    }
    let grid = root
        .child(kind)
        .ok_or_else(|| Error::run(format!("the file holds no <{kind}>")).expected("what its type says"))?;
    let mut dataset = Dataset::default();
    let scalars = |tag| grid.child(tag).and_then(|section| section.attribute("Scalars"));
    dataset.active_scalars = scalars("PPointData").or_else(|| scalars("PCellData")).map(str::to_owned);
    let mut count = 0;
    for piece in grid.children_of("Piece") {
        add(source, piece.required("Source")?, open_piece, &mut dataset)?;
        count += 1;
    }
    if count == 0 {
        let error = Error::run(format!("<{kind}> names no pieces"));
        return Err(error.expected("at least one <Piece Source=\"…\">"));
    }
    dataset.format = format!("VTK XML {kind} of {count} pieces; {}", dataset.format);
    Ok(dataset)
}

/// One piece's file.
fn open_piece(source: Arc<Source>, root: &Element, appended: Option<Appended>) -> Result<Dataset> {
    match root.required("type")? {
        kind if kind == SERIES || names_pieces(kind) => Err(misplaced(kind)),
        _ => serial::open(source, root, appended),
    }
}

/// Reads the file `name`, a path relative to the file that names it, by `open`, and adds its pieces.
fn add(
    by: &Source,
    name: &str,
    open: impl FnOnce(Arc<Source>, &Element, Option<Appended>) -> Result<Dataset>,
    to: &mut Dataset,
) -> Result<()> {
    let path = by.path().parent().unwrap_or(Path::new("")).join(name);
    let source = Source::open(&path)?;
    let inner = || {
        let (root, appended) = header::read(&source)?;
        open(source.clone(), &root, appended)
    };
    let part = inner().map_err(|error| error.in_file(&path))?;
    to.pieces.extend(part.pieces);
    to.warnings.extend(part.warnings);
    to.active_scalars = to.active_scalars.take().or(part.active_scalars);
    if to.format.is_empty() {
        to.format = part.format;
    }
    Ok(())
}

/// The error about a named file of a kind that cannot be named there.
fn misplaced(kind: &str) -> Error {
    Error::run("a file names another of a kind that cannot stand there").got(kind)
}

/// The times of all steps, and the files of that asked for.
fn step<'a>(root: &'a Element, request: &Request) -> Result<(Vec<f64>, Vec<&'a str>)> {
    let collection = root.child(SERIES).ok_or_else(|| Error::run("the file holds no <Collection>"))?;
    let mut entries = Vec::new();
    for element in collection.children_of("DataSet") {
        let time = element.number::<f64>("timestep")?.unwrap_or(0.0);
        if !time.is_finite() {
            return Err(element.wrong("timestep", "a finite number"));
        }
        entries.push((time, element.required("file")?));
    }
    let mut time_steps: Vec<f64> = entries.iter().map(|entry| entry.0).collect();
    time_steps.sort_by(f64::total_cmp);
    time_steps.dedup();
    if time_steps.is_empty() {
        return Err(Error::run("the time series is empty").expected("at least one <DataSet file=\"…\">"));
    }
    let time = time_steps[request.step_index(&time_steps)?];
    let files = entries.into_iter().filter(|entry| entry.0 == time).map(|entry| entry.1).collect();
    Ok((time_steps, files))
}

/// Bytes of a file within which its type stands.
const HEAD: u64 = 1024;

/// The types that name others, as every writer spells them.
const MARKS: [&str; 2] = ["type=\"Collection\"", "type=\"P"];

/// The files that a series (of every step, or of that asked for) or a parallel file names, and those that these name; none for
/// files of other kinds, of which no more than the head is read.
pub(super) fn files_named(path: &Path, request: Option<&Request>) -> Vec<PathBuf> {
    files_marked(path, &MARKS, request)
}

/// Files that a file of one of these types names.
fn files_marked(path: &Path, marks: &[&str], request: Option<&Request>) -> Vec<PathBuf> {
    let Ok(source) = Source::open(path) else { return Vec::new() };
    let head = source.head(HEAD).unwrap_or_default();
    let names_others = |mark: &[u8]| head.windows(mark.len()).any(|window| window == mark);
    if !head.trim_ascii_start().starts_with(b"<") || !marks.iter().any(|mark| names_others(mark.as_bytes())) {
        return Vec::new();
    }
    let Ok((root, _)) = header::read(&source) else { return Vec::new() };
    let folder = path.parent().unwrap_or(Path::new(""));
    // A series may name parallel files; these name no further ones.
    let is_series = root.attribute("type") == Some(SERIES);
    let names = match request.filter(|_| is_series) {
        Some(request) => step(&root, request).map(|(_, files)| files).unwrap_or_default(),
        None => root.attributes_below(&["file", "Source"]),
    };
    let mut paths: Vec<PathBuf> = names.into_iter().map(|name| folder.join(name)).collect();
    if is_series {
        let further: Vec<PathBuf> =
            paths.iter().flat_map(|path| files_marked(path, &MARKS[1..], None)).collect();
        paths.extend(further);
    }
    paths
}
