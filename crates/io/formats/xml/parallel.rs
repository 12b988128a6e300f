//! Grids in pieces, each a file: .pvtu .pvts .pvtr .pvti; and tables of contents put together.

use super::header::{self, Appended, Element};
use super::hyper_tree;
use super::named::{beside, open_named};
use super::serial::{grid, marked, open_serial, refusal};
use crate::formats::contents::Dataset;
use crate::formats::request::Request;
use crate::formats::source::Source;
use std::sync::Arc;
use voltet_core::{Error, Result, counted};

/// Type of the files that name the files of time steps.
pub(super) const SERIES: &str = "Collection";
/// Types of files whose root is a tree of data sets.
pub(super) const TREES: [&str; 6] = [
    "vtkMultiBlockDataSet",
    "vtkPartitionedDataSetCollection",
    "vtkPartitionedDataSet",
    "vtkOverlappingAMR",
    "vtkNonOverlappingAMR",
    "vtkHierarchicalBoxDataSet",
];
/// Types whose leaves are patches of an adaptive grid.
pub(super) const PATCHES: &[&str] = TREES.split_at(3).1;

/// True if a file of this type names the files of its pieces.
pub(super) fn names_pieces(kind: &str) -> bool {
    kind.starts_with('P') && kind != "PolyData"
}

/// One file of a step, or of a piece of it, which may not be in pieces again.
pub(super) fn open_step(
    source: Arc<Source>,
    root: &Element,
    appended: Option<Appended>,
    request: &Request,
    may_have_pieces: bool,
) -> Result<Dataset> {
    match root.required("type")? {
        kind if kind == SERIES || TREES.contains(&kind) || !may_have_pieces && names_pieces(kind) => {
            let error = Error::run("a file names another of a kind that cannot stand there").got(kind);
            let expected = if may_have_pieces { "files of data" } else { "files of data in one part" };
            Err(error.expected(expected))
        }
        kind if names_pieces(kind) => open_parallel(&source, root, request),
        hyper_tree::KIND => hyper_tree::open(source, root, appended),
        _ => open_serial(source, root, appended, request),
    }
}

/// Reads the tables of contents of all pieces.
fn open_parallel(source: &Source, root: &Element, request: &Request) -> Result<Dataset> {
    let kind = root.required("type")?;
    if !["PUnstructuredGrid", "PStructuredGrid", "PRectilinearGrid", "PImageData"].contains(&kind) {
        return Err(refusal(kind, root));
    }
    let grid = grid(root, kind)?;
    let mut dataset = Dataset {
        active_scalars: marked(grid, &["PPointData", "PCellData"], "Scalars"),
        ..Dataset::default()
    };
    let mut count = 0;
    for piece in grid.children_of("Piece") {
        add(source, piece.required("Source")?, request, false, &mut dataset)?;
        count += 1;
    }
    if count == 0 {
        let error = Error::run(format!("<{kind}> names no pieces"));
        return Err(error.expected("at least one <Piece Source=\"…\">"));
    }
    dataset.format = format!("VTK XML {kind} of {}; {}", counted(count, "piece"), dataset.format);
    Ok(dataset)
}

/// Reads the file `name`, a path relative to the file that names it, and adds its pieces.
fn add(by: &Source, name: &str, request: &Request, may_have_pieces: bool, to: &mut Dataset) -> Result<()> {
    let path = beside(by.path(), name);
    let source = open_named(by.path(), &path, to.pieces.len())?;
    let read = header::read(&source);
    let part = read.and_then(|(root, appended)| open_step(source, &root, appended, request, may_have_pieces));
    to.merge(part.map_err(|error| error.in_file(&path))?);
    Ok(())
}

impl Dataset {
    /// Adds the pieces of another file.
    pub(super) fn merge(&mut self, part: Dataset) {
        self.pieces.extend(part.pieces);
        self.warnings.extend(part.warnings);
        self.time_steps = part.time_steps;
        self.time = self.time.or(part.time);
        self.file_bytes += part.file_bytes;
        self.active_scalars = self.active_scalars.take().or(part.active_scalars);
        self.global_ids = self.global_ids.take().or(part.global_ids);
        if self.format.is_empty() {
            self.format = part.format;
        }
    }
}
