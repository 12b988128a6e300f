//! The commands, one file each: a function that gives the exit code, or the error that ends it.

mod check;
mod explain;
mod findings;
mod info;
mod nodes;
mod run;
mod stability;
mod study;
mod time;

use crate::Document;
use crate::arguments::{Arguments, Command};
use crate::core::error::ErrorKind;
use crate::core::graph::Registry;
use crate::core::{Error, Result};
use crate::present;
use std::path::PathBuf;
use std::process::ExitCode;

/// Nothing went wrong.
pub const DONE: u8 = 0;

/// Carries out the command, shows its error if there is one, and gives the exit code.
pub fn dispatch(arguments: &Arguments, registry: Result<Registry>) -> ExitCode {
    let outcome = registry.and_then(|registry| carry_out(&arguments.command, &registry));
    ExitCode::from(outcome.unwrap_or_else(|error| show(&error, None)))
}

fn carry_out(command: &Command, registry: &Registry) -> Result<u8> {
    match command {
        Command::Run(arguments) => run::run(arguments, registry),
        Command::Check(arguments) => check::check(arguments, registry),
        Command::Explain(arguments) => explain::explain(arguments, registry),
        Command::Nodes(arguments) => nodes::nodes(arguments, registry),
        Command::Info(arguments) => info::info(arguments, registry),
        Command::Stability(arguments) => stability::stability(arguments),
        Command::Study(arguments) => study::study(arguments, registry),
        Command::Time(arguments) => time::time(arguments, registry),
    }
}

/// Shows an error, once, and gives its exit code. `text`: the pipeline file that it may point into.
pub fn show(error: &Error, text: Option<&str>) -> u8 {
    eprintln!("{}", present::error(error, text));
    code(error)
}

/// The exit code that an error means.
fn code(error: &Error) -> u8 {
    match error.kind {
        ErrorKind::Usage => 2,
        ErrorKind::Run | ErrorKind::Cancelled => 1,
    }
}

/// Opens every file, showing each error; `None` with the exit code where any is wrong.
pub fn open_all(files: &[PathBuf], options: &[String], registry: &Registry) -> (Vec<Document>, u8) {
    let mut documents = Vec::new();
    let mut worst = DONE;
    for path in files {
        match open(path, options, registry) {
            Ok(document) => documents.push(document),
            Err((error, text)) => worst = worst.max(show(&error, text.as_deref())),
        }
    }
    (documents, worst)
}

/// Opens one file; an error comes with the text that it may point into.
pub fn open(
    path: &std::path::Path,
    options: &[String],
    registry: &Registry,
) -> std::result::Result<Document, (Error, Option<String>)> {
    let text = crate::read_text(path).map_err(|error| (error, None))?;
    Document::from_text(path, text.clone(), options, registry).map_err(|error| (error, Some(text)))
}

/// Shows the graph's own warnings.
pub fn warn(document: &Document) {
    for warning in &document.graph.warnings {
        let located = document.locate(warning.clone());
        eprintln!("{}", present::warning(&located, Some(&document.text)));
    }
}
