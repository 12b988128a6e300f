//! `voltet run`: runs pipeline files headless, each for one picture or for the frames of a series.

#[cfg(feature = "editor")]
mod edited;
mod film;
mod jobs;
mod messages;
mod plan;
mod report;
mod resume;
mod runner;
mod sheet;
mod task;

#[cfg(feature = "editor")]
pub(super) use edited::film_of;

use super::shared::{DONE, FAILED, Outcome, ShortOption, open_all, show};
use crate::cli::arguments::Run;
use crate::cli::ranks::Launch;
use crate::core::{Error, Result, counted};
use crate::document;
use crate::graph::{ParameterValue, Registry};
use crate::nodes::files;
use plan::Plan;
use runner::Runner;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;

pub fn run(arguments: &Run, registry: &Registry) -> Outcome {
    let launch = Launch::join(arguments.frames.part.is_some())?;
    if launch.ranks.count() == 1 {
        return run_on(arguments, registry, &launch);
    }
    // The other processes wait for this one: whatever ends it ends them all.
    let exit_code = match catch_unwind(AssertUnwindSafe(|| run_on(arguments, registry, &launch))) {
        Ok(Ok(DONE)) => return Ok(DONE),
        Ok(Ok(exit_code)) => exit_code,
        Ok(Err(failure)) => {
            launch.announce_failure();
            show(&failure)
        }
        // It was shown where it happened.
        Err(_) => FAILED,
    };
    launch.announce_failure();
    launch.end_all(exit_code);
    Ok(exit_code)
}

/// Runs the files, as one of the processes of a launch.
fn run_on(arguments: &Run, registry: &Registry, launch: &Launch) -> Outcome {
    let (documents, mut wrong) = open_all(&arguments.files, &shorts(arguments), registry);
    let is_one_of_many = arguments.files.files.len() > 1;
    if documents.is_empty() || wrong != DONE && !is_one_of_many {
        return Ok(wrong);
    }
    film::check(arguments, &documents)?;
    // A file that is wrong is named, and the others are drawn.
    let (selection, mut plans) = (plan::selection(arguments)?, Vec::new());
    let is_open = |file: &&PathBuf| documents.iter().any(|document| document.path == **file);
    let unopened = arguments.files.files.iter().filter(|file| !is_open(file));
    let mut failures: Vec<String> = unopened.map(|file| file.display().to_string()).collect();
    for document in &documents {
        let planned = document.refuse_missing_data().map_err(Into::into);
        match planned.and_then(|()| plan::plan(document, &selection, arguments, registry)) {
            Ok(plan) => plans.extend(plan),
            Err(failure) if is_one_of_many => {
                wrong = wrong.max(show(&failure));
                failures.push(document.path.display().to_string());
            }
            Err(failure) => return Err(failure),
        }
    }
    film::refuse_frame(arguments, plans.iter().flat_map(|plan| &plan.outputs))?;
    let report = arguments.report.as_deref().map(|path| ("--report", path));
    let first = plans.iter().map(|plan| &plan.first);
    document::refuse_conflicts(first, true, report.as_slice())?;
    plan::refuse_conflicts(&plans, arguments)?;
    arguments.report.as_deref().map_or(Ok(()), files::refuse_unwritable)?;
    let outputs = plans.iter().flat_map(|plan| &plan.outputs).chain(&arguments.report);
    let streams = outputs.into_iter().any(|path| files::is_standard_output(path));
    refuse_exhaustive(arguments, &plans, streams)?;
    refuse_several(arguments, launch)?;
    if arguments.jobs > 1 && streams {
        let error = Error::usage("the standard output takes one picture at a time");
        return Err(error.got(format!("--jobs {}", arguments.jobs)).expected("the path of a file").into());
    }
    Runner::new(arguments, registry, streams, (wrong, failures), launch)?.run(&plans)
}

/// Refuses what several processes do not do together.
fn refuse_several(arguments: &Run, launch: &Launch) -> Result<()> {
    let options = [
        ("--exhaustive", arguments.exhaustive),
        ("--resume", arguments.frames.resume),
        ("--jobs", arguments.jobs > 1),
    ];
    match options.into_iter().find(|(_, is_given)| *is_given && launch.ranks.count() > 1) {
        None => Ok(()),
        Some((option, _)) => {
            let found = counted(launch.ranks.count(), "rank");
            Err(Error::usage(format!("{option} is for one process"))
                .got(found)
                .expected("the command without mpirun"))
        }
    }
}

/// Options that are short for `--set`.
fn shorts(arguments: &Run) -> Vec<ShortOption> {
    let size = arguments.size.map(|size| ShortOption {
        name: "--size",
        node_type: "camera",
        parameter: "size",
        value: size.into_iter().map(|side| ParameterValue::Integer(side.into())).collect(),
    });
    let output = arguments.output.as_ref().map(|path| ShortOption {
        name: "--output",
        node_type: "image-writer",
        parameter: "path",
        value: ParameterValue::Text(path.to_string_lossy().into_owned()),
    });
    size.into_iter().chain(output).collect()
}

/// Refuses a comparison with an exhaustive run where that would be of several pictures, or of a stream.
fn refuse_exhaustive(arguments: &Run, plans: &[Plan], streams: bool) -> Result<()> {
    let is_series = plans.iter().any(|plan| plan.frames.is_some());
    let (what, expected) = match arguments.exhaustive {
        true if is_series => {
            ("--exhaustive compares runs of one picture, and the file makes several", "one step alone")
        }
        true if streams => (
            "--exhaustive writes every picture several times, and the standard output takes one",
            "the path of a file in place of \"-\"",
        ),
        _ => return Ok(()),
    };
    Err(Error::usage(what).expected(expected))
}
