//! `voltet run`: runs pipeline files headless.

use super::{DONE, code, open_all, registry, show, warn};
use crate::arguments::Run;
use crate::present::{Bar, json, summary};
use voltet::core::Result;
use voltet::core::error::ErrorKind;
use voltet::nodes::files;

pub fn run(arguments: &Run) -> Result<u8> {
    // Every file is checked before the first one runs.
    let (documents, wrong) = open_all(&arguments.files, &arguments.set.options, &registry()?);
    if wrong != DONE {
        return Ok(wrong);
    }
    if let Some(path) = &arguments.report {
        files::refuse_unwritable(path)?;
    }
    let bar = Bar::new(arguments.quiet);
    let mut session = voltet::nodes::session();
    let mut worst = DONE;
    let mut reports = Vec::new();
    for document in &documents {
        if !arguments.quiet {
            warn(document);
        }
        let outcome = session.run(&document.graph, &bar);
        bar.clear();
        match outcome {
            Ok(report) => {
                if !arguments.quiet {
                    print!("{}", summary(document, &report));
                }
                reports.push(json(document, &report));
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
