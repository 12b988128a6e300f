//! Frames of one pipeline, checked before the first is drawn.

use crate::cli::arguments::Run;
use crate::core::{Error, Result};
use crate::document::{Document, LocatedError};
use crate::graph::Registry;
use crate::nodes::files::FileIdentity;
use crate::series::files::files_named;
use crate::series::selection::{FrameSelection, Steps};
use crate::series::{self, Frame};
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// Frames of one pipeline.
pub(super) struct Plan {
    /// The pipeline of the only picture, or of the first frame.
    pub first: Document,
    /// The pipeline as the file states it, with its frames; `None`: it is run for one picture.
    pub frames: Option<Frames>,
    /// Files that are written.
    pub outputs: Vec<PathBuf>,
}

/// Frames, and the pipeline that they are changes of.
pub(super) struct Frames {
    pub document: Document,
    pub frames: Vec<Frame>,
    /// True if parameters are swept: a sheet of all pictures is made.
    pub has_sheet: bool,
}

/// The plans of pipelines.
pub(super) fn plans(
    documents: &[Document],
    arguments: &Run,
    registry: &Registry,
) -> std::result::Result<Vec<Plan>, LocatedError> {
    let selection = selection(arguments)?;
    documents.iter().map(|document| plan(document, &selection, arguments, registry)).collect()
}

fn selection(arguments: &Run) -> Result<FrameSelection> {
    let options = &arguments.frames;
    let by_number = options.steps.clone().map(Steps::Numbers);
    let mut data_files = Vec::new();
    for pattern in &options.data_files {
        let found = files_named(pattern);
        if found.is_empty() {
            let error = Error::usage("no file has such a name").got(format!("--for '{pattern}'"));
            return Err(
                error.expected("data files; * stands for any letters within the name of a file or folder")
            );
        }
        data_files.extend(found);
    }
    Ok(FrameSelection {
        steps: by_number.or_else(|| options.times.clone().map(Steps::Times)),
        ranges: options.ranges,
        data_files,
        sweeps: options.sweep.clone(),
        turn_count: options.frames.map(|count| count as usize),
        part: options.part,
    })
}

fn plan(
    document: &Document,
    selection: &FrameSelection,
    arguments: &Run,
    registry: &Registry,
) -> std::result::Result<Plan, LocatedError> {
    let options = &arguments.frames;
    let frames = series::frames(document, selection, registry).map_err(|error| document.failure(error))?;
    let Some(first) = frames.first() else {
        let error = Error::usage("this part has no frame").in_file(&document.path);
        return Err(error.expected("a count of parts of at most the number of frames").into());
    };
    let own =
        |frame: &Frame| document.changed(&frame.changes, registry).map_err(|error| document.failure(error));
    let first = own(first)?;
    let outputs = outputs(document, &first, &frames, &own)?;
    let is_single =
        frames.len() == 1 && frames[0].varying.is_empty() && options.film.is_none() && !options.resume;
    if is_single {
        return Ok(Plan { first, frames: None, outputs });
    }
    let (document, has_sheet) = (document.changed(&[], registry)?, !selection.sweeps.is_empty());
    Ok(Plan { first, frames: Some(Frames { document, frames, has_sheet }), outputs })
}

/// The files that frames write. Errors: one is written twice, or is read.
fn outputs(
    document: &Document,
    first: &Document,
    frames: &[Frame],
    own: &dyn Fn(&Frame) -> std::result::Result<Document, LocatedError>,
) -> std::result::Result<Vec<PathBuf>, LocatedError> {
    let (mut outputs, mut writers) = (Vec::new(), HashMap::new());
    let mut read: HashMap<FileIdentity, PathBuf> = HashMap::new();
    for path in first.inputs() {
        read.extend(FileIdentity::from_path(&path).map(|file| (file, path)));
    }
    for (number, frame) in frames.iter().enumerate() {
        let changed = own(frame)?;
        for path in changed.outputs() {
            let Some(file) = FileIdentity::from_path(&path) else {
                outputs.push(path);
                continue;
            };
            if number > 0 && read.contains_key(&file) {
                return Err(document.failure(overwritten(&path, frame)));
            }
            let other = writers.insert(file, number).filter(|other| *other != number);
            if let Some(other) = other {
                return Err(document.failure(written_twice(&path, &frames[other], frame)));
            }
            outputs.push(path);
        }
    }
    Ok(outputs)
}

fn overwritten(path: &Path, frame: &Frame) -> Error {
    let found = format!("'{}' of {}", path.display(), frame.label());
    Error::usage("a frame would be written over what the call reads").got(found).expected("another name")
}

fn written_twice(path: &Path, first: &Frame, second: &Frame) -> Error {
    let found = format!("'{}' of {} and of {}", path.display(), first.label(), second.label());
    let expected = "{frame} in the name, or another mark in which they differ";
    Error::usage("two frames would be written to one file").got(found).expected(expected)
}
