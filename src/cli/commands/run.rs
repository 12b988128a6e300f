//! `voltet run`: runs pipeline files headless.

use super::shared::{DONE, FAILED, Outcome, ShortOption, open_all, show, tell, warn};
use crate::Document;
use crate::cli::arguments::Run;
use crate::cli::present::{Bar, say, summary, warnings};
use crate::core::error::ErrorKind;
use crate::core::{Error, Result};
use crate::document;
use crate::graph::{Observer, ParameterValue, Registry, RunReport};
use crate::io::provenance::{run_report, whole_report};
use crate::nodes::files;
use std::path::PathBuf;
use voltet_study::ExhaustiveComparison;

pub fn run(arguments: &Run, registry: &Registry) -> Outcome {
    // Every file is checked before the first one runs.
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
    let shorts: Vec<ShortOption> = size.into_iter().chain(output).collect();
    let (documents, wrong) = open_all(&arguments.files, &shorts, registry);
    if wrong != DONE {
        return Ok(wrong);
    }
    let report = arguments.report.as_deref().map(|path| ("--report", path));
    document::refuse_conflicts(&documents, true, report.as_slice())?;
    documents.iter().try_for_each(Document::refuse_missing_data)?;
    arguments.report.as_deref().map_or(Ok(()), files::refuse_unwritable)?;
    let streams =
        outputs(&documents).chain(arguments.report.clone()).any(|path| files::is_standard_output(&path));
    if streams && arguments.exhaustive {
        let error = Error::usage(
            "--exhaustive writes every picture several times, and the standard output takes one",
        );
        return Err(error.expected("the path of a file in place of \"-\"").into());
    }
    let bar = Bar::new(arguments.quiet);
    let mut session = crate::nodes::session();
    let mut worst = DONE;
    let mut reports = Vec::new();
    for document in &documents {
        if !arguments.quiet {
            warn(document);
        }
        let outcome = match arguments.exhaustive {
            true => compared(document, &bar),
            false => session.run(&document.graph, &bar).map(|report| (report, None)),
        };
        bar.clear();
        match outcome {
            Ok((report, exhaustive)) => {
                if !arguments.quiet {
                    say(&warnings(&report.warnings, document.graph.warnings.len()));
                    let mut text = summary(&report);
                    text.extend(exhaustive.iter().map(ExhaustiveComparison::to_text));
                    tell(&text, streams)?;
                }
                let path = document.path.display().to_string();
                let mut report = run_report(&path, &report, &document.graph.stated);
                if let Some(exhaustive) = exhaustive {
                    report["exhaustive"] = exhaustive.as_json();
                    // The key of former versions.
                    report["no_leave_out"] = report["exhaustive"].clone();
                }
                reports.push(report);
            }
            Err(error) => {
                let is_stopped = error.kind == ErrorKind::Cancelled;
                worst = worst.max(show(&document.failure(error)));
                if is_stopped {
                    return Ok(FAILED);
                }
            }
        }
    }
    if let (Some(path), DONE) = (&arguments.report, worst) {
        files::write_whole(path, format!("{:#}\n", whole_report(reports)).as_bytes())?;
    }
    Ok(worst)
}

/// The files that the nodes of these pipelines write.
fn outputs(documents: &[Document]) -> impl Iterator<Item = PathBuf> {
    let written = |document: &Document| {
        let named = document.graph.nodes.iter().flat_map(|node| node.parameters.paths());
        let written = named.filter(|named| named.written).map(|named| named.from(&document.graph.folder));
        written.collect::<Vec<_>>()
    };
    documents.iter().flat_map(written)
}

/// Modes in which a file is run in turn, true for exhaustive ones. The first run finds cold caches and is not counted.
const TURNS: [bool; 5] = [false, true, false, true, false];

/// The file's exhaustive run, compared with the usual one: the fastest of each, every run from a
/// fresh start.
fn compared(
    document: &Document,
    observer: &dyn Observer,
) -> Result<(RunReport, Option<ExhaustiveComparison>)> {
    let mut runs: [Option<RunReport>; 2] = [None, None];
    for (turn, exhaustive) in TURNS.into_iter().enumerate() {
        let session = crate::nodes::session();
        let mut session = if exhaustive { session.exhaustive() } else { session };
        let report = session.run(&document.graph, observer)?;
        let fastest = &mut runs[usize::from(exhaustive)];
        if turn > 0 && fastest.as_ref().is_none_or(|fastest| report.seconds < fastest.seconds) {
            *fastest = Some(report);
        }
    }
    match runs {
        [Some(usual), Some(exhaustive)] => {
            let comparison = ExhaustiveComparison::compare(&usual, &exhaustive);
            Ok((exhaustive, Some(comparison)))
        }
        _ => Err(Error::run("the file was not run")),
    }
}
