//! `voltet run`: runs pipeline files headless.

use super::outcome::{DONE, code, show, warn};
use super::pipelines::open_all;
use crate::Document;
use crate::arguments::Run;
use crate::core::error::ErrorKind;
use crate::core::graph::{Observer, Registry, RunReport};
use crate::core::{Error, Result};
use crate::nodes::files;
use crate::present::{Bar, json, summary};
use crate::study::Thorough;

pub fn run(arguments: &Run, registry: &Registry) -> Result<u8> {
    // Every file is checked before the first one runs.
    let (documents, wrong) = open_all(&arguments.files, &arguments.set.options, registry);
    if wrong != DONE {
        return Ok(wrong);
    }
    if let Some(path) = &arguments.report {
        files::refuse_unwritable(path)?;
    }
    let bar = Bar::new(arguments.quiet);
    let mut session = crate::nodes::session();
    let mut worst = DONE;
    let mut reports = Vec::new();
    for document in &documents {
        if !arguments.quiet {
            warn(document);
        }
        let outcome = match arguments.no_leave_out {
            true => compared(document, &bar),
            false => session.run(&document.graph, &bar).map(|report| (report, None)),
        };
        bar.clear();
        match outcome {
            Ok((report, thorough)) => {
                if !arguments.quiet {
                    print!("{}", summary(document, &report));
                    thorough.iter().for_each(|thorough| print!("{}", thorough.in_words()));
                }
                let mut report = json(document, &report);
                if let Some(thorough) = thorough {
                    report["no_leave_out"] = thorough.as_json();
                }
                reports.push(report);
            }
            Err(error) => {
                let error = document.locate(error);
                worst = worst.max(show(&error, Some(&document.text)));
                if error.kind == ErrorKind::Cancelled {
                    return Ok(code(&error));
                }
            }
        }
    }
    if let (Some(path), DONE) = (&arguments.report, worst) {
        let whole = match reports.len() {
            1 => reports.remove(0),
            _ => serde_json::json!({ "runs": reports }),
        };
        files::write_whole(path, format!("{whole:#}\n").as_bytes())?;
    }
    Ok(worst)
}

/// How often a file is run either way, in turn: the first run finds cold caches.
const ROUNDS: usize = 2;

/// The file's run that leaves nothing out, and how it compares with the usual one: the fastest of each, every run from a
/// fresh start.
fn compared(document: &Document, observer: &dyn Observer) -> Result<(RunReport, Option<Thorough>)> {
    let mut runs: [Option<RunReport>; 2] = [None, None];
    for _ in 0..ROUNDS {
        for (fastest, thorough) in runs.iter_mut().zip([false, true]) {
            let session = crate::nodes::session();
            let mut session = if thorough { session.leaving_nothing_out() } else { session };
            let report = session.run(&document.graph, observer)?;
            if fastest.as_ref().is_none_or(|fastest| report.seconds < fastest.seconds) {
                *fastest = Some(report);
            }
        }
    }
    match runs {
        [Some(usual), Some(thorough)] => {
            let comparison = Thorough::compare(&usual, &thorough);
            Ok((thorough, Some(comparison)))
        }
        _ => Err(Error::run("the file was not run")),
    }
}
