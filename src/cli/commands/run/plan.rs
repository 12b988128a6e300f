//! Frames of one pipeline, checked before the first is drawn.

use super::{film, sheet};
use crate::cli::arguments::Run;
use crate::cli::present::say;
use crate::core::{Error, Result};
use crate::document::{Document, LocatedError};
use crate::graph::Registry;
use crate::nodes::files::FileIdentity;
use crate::series::files::data_files;
use crate::series::selection::{FrameSelection, Steps};
use crate::series::{self, Frame};
use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

/// Frames of one pipeline.
pub(super) struct Plan {
    /// The pipeline of the only picture, or of the first frame.
    pub first: Document,
    /// The pipeline as the file states it, with its frames; `None`: it is run for one picture.
    pub frames: Option<Frames>,
    pub outputs: Vec<PathBuf>,
    inputs: HashSet<PathBuf>,
}

/// Frames, and the pipeline that they are changes of.
pub(super) struct Frames {
    pub document: Document,
    pub frames: Vec<Frame>,
    /// The sheet of all pictures, where parameters are swept.
    pub sheet: Option<PathBuf>,
    /// True if parameters are swept and a part of the pictures is drawn, of which no sheet is made.
    pub is_part_of_sweep: bool,
}

/// The frames that options select.
pub(super) fn selection(arguments: &Run) -> Result<FrameSelection> {
    let options = &arguments.frames;
    let by_number = options.steps.clone().map(Steps::Numbers);
    Ok(FrameSelection {
        steps: by_number.or_else(|| options.times.clone().map(Steps::Times)),
        ranges: options.ranges,
        data_files: data_files(&options.data_files)?,
        sweeps: options.sweep.clone(),
        turn_count: options.frames.map(|count| count as usize),
        part: options.part,
    })
}

/// The plan of a pipeline; `None` where the part has no frame of it.
pub(super) fn plan(
    document: &Document,
    selection: &FrameSelection,
    arguments: &Run,
    registry: &Registry,
) -> std::result::Result<Option<Plan>, LocatedError> {
    let options = &arguments.frames;
    let frames = series::frames(document, selection, registry).map_err(|error| document.failure(error))?;
    let Some(first) = frames.first() else {
        if !arguments.quiet {
            say(&format!("no frame in this part: {}\n", document.path.display()));
        }
        return Ok(None);
    };
    let own =
        |frame: &Frame| document.changed(&frame.changes, registry).map_err(|error| document.failure(error));
    let first = own(first)?;
    let (mut outputs, inputs) = files(document, &frames, &own)?;
    let is_single =
        frames.len() == 1 && frames[0].varying.is_empty() && options.film.is_none() && !options.resume;
    if is_single {
        return Ok(Some(Plan { first, frames: None, outputs, inputs }));
    }
    let document = document.changed(&[], registry)?;
    let (is_swept, is_part) = (!selection.sweeps.is_empty(), selection.part.is_some());
    let picture = film::picture_path(&first).filter(|_| is_swept && !is_part && frames.len() > 1);
    let sheet = picture.map(|picture| sheet::path(&picture));
    outputs.extend(sheet.clone());
    let frames = Frames { document, frames, sheet, is_part_of_sweep: is_swept && is_part };
    Ok(Some(Plan { first, frames: Some(frames), outputs, inputs }))
}

/// The files that frames write, and those that they read. Errors: one is written by two frames.
fn files(
    document: &Document,
    frames: &[Frame],
    own: &dyn Fn(&Frame) -> std::result::Result<Document, LocatedError>,
) -> std::result::Result<(Vec<PathBuf>, HashSet<PathBuf>), LocatedError> {
    let (mut outputs, mut writers) = (Vec::new(), HashMap::new());
    let (mut inputs, mut looked_at) = (HashSet::new(), HashSet::new());
    for (number, frame) in frames.iter().enumerate() {
        let changed = own(frame)?;
        // Files that lie beside the same ones are looked for once.
        if looked_at.insert(changed.named_inputs()) {
            inputs.extend(changed.inputs());
        }
        for path in changed.outputs() {
            let file = FileIdentity::from_path(&path);
            let other = file.and_then(|file| writers.insert(file, number)).filter(|other| *other != number);
            if let Some(other) = other {
                return Err(document.failure(written_twice(&path, &frames[other], frame)));
            }
            outputs.push(path);
        }
    }
    Ok((outputs, inputs))
}

/// Refuses a call of which an output (a picture, sheet, film or report) is another output, or is read, in any frame of any pipeline.
pub(super) fn refuse_conflicts(plans: &[Plan], arguments: &Run) -> Result<()> {
    let mut read = HashSet::new();
    for path in plans.iter().flat_map(|plan| &plan.inputs) {
        read.extend(FileIdentity::from_path(path));
    }
    let of_plan = |plan: &'_ Plan| {
        let by = plan.first.path.display().to_string();
        plan.outputs.iter().map(|path| (path.clone(), by.clone())).collect::<Vec<_>>()
    };
    let options = [("--film", &arguments.frames.film), ("--report", &arguments.report)];
    let options = options.into_iter().filter_map(|(name, path)| Some((path.clone()?, name.to_string())));
    let mut written: HashMap<FileIdentity, String> = HashMap::new();
    for (path, by) in plans.iter().flat_map(of_plan).chain(options) {
        let Some(file) = FileIdentity::from_path(&path) else { continue };
        if read.contains(&file) {
            return Err(overwritten(&path, &by));
        }
        if let Some(other) = written.insert(file, by.clone()) {
            let error = Error::usage("two outputs of this call are one file");
            let found = format!("'{}' of {other} and of {by}", path.display());
            return Err(error.got(found).expected("a file of its own for every output"));
        }
    }
    Ok(())
}

fn overwritten(path: &Path, by: &str) -> Error {
    let found = format!("'{}' of {by}", path.display());
    Error::usage("this output would overwrite what the call reads")
        .got(found)
        .expected("a file of its own for every output")
}

fn written_twice(path: &Path, first: &Frame, second: &Frame) -> Error {
    let found = format!("'{}' of {} and of {}", path.display(), first.label(), second.label());
    let expected = "{frame} in the name, or another mark in which they differ";
    Error::usage("two frames would be written to one file").got(found).expected(expected)
}
