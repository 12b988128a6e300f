//! `voltet run`: runs pipeline files headless, each for one picture or for the frames of a series.

mod film;
mod plan;
mod resume;
mod runner;
mod sheet;

use super::shared::{DONE, FAILED, Outcome, ShortOption, open_all, show};
use crate::Document;
use crate::cli::arguments::Run;
use crate::cli::ranks::Launch;
use crate::core::{Error, Result, counted};
use crate::document;
use crate::graph::{ParameterValue, Registry};
use crate::io::provenance::whole_report;
use crate::nodes::files;
use plan::Plan;
use runner::Runner;
use std::panic::{AssertUnwindSafe, catch_unwind};

pub fn run(arguments: &Run, registry: &Registry) -> Outcome {
    let launch = Launch::join()?;
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
    // Every file is checked before the first one runs.
    let (documents, wrong) = open_all(&arguments.files, &shorts(arguments), registry);
    if wrong != DONE {
        return Ok(wrong);
    }
    documents.iter().try_for_each(Document::refuse_missing_data)?;
    film::check(arguments, &documents)?;
    let plans = plan::plans(&documents, arguments, registry)?;
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
    let is_first = launch.ranks.rank() == 0;
    let mut runner = Runner::new(arguments, registry, streams, launch);
    for plan in &plans {
        let goes_on = match &plan.frames {
            None => runner.run_picture(&plan.first)?,
            Some(frames) => runner.run_frames(plan, frames)?,
        };
        if !goes_on {
            return Ok(runner.worst);
        }
    }
    let is_series = plans.iter().any(|plan| plan.frames.is_some());
    if let (Some(path), true) = (&arguments.report, is_first && (runner.worst == DONE || is_series)) {
        files::write_whole(path, format!("{:#}\n", whole_report(runner.reports)).as_bytes())?;
    }
    Ok(runner.worst)
}

/// Refuses what several processes do not do together.
fn refuse_several(arguments: &Run, launch: &Launch) -> Result<()> {
    let options = [("--exhaustive", arguments.exhaustive), ("--resume", arguments.frames.resume)];
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
