//! Exit codes, and errors and warnings on standard error.

use crate::Document;
use crate::cli::present;
use crate::core::Error;
use crate::core::error::ErrorKind;

/// Exit code of success.
pub const DONE: u8 = 0;

/// Exit code of a run that failed or was cancelled.
const FAILED: u8 = 1;

/// Exit code of a wrong command line or pipeline file.
pub const WRONG: u8 = 2;

/// Shows an error, once, and returns its exit code. `text`: the pipeline file that it may point into.
pub fn show(error: &Error, text: Option<&str>) -> u8 {
    present::say(&present::error(error, text));
    code(error)
}

/// Exit code of an error.
pub fn code(error: &Error) -> u8 {
    match error.kind {
        ErrorKind::Usage => WRONG,
        _ => FAILED,
    }
}

/// Shows the graph's warnings, and those about data and plug-ins that have changed since the picture was drawn.
pub fn warn(document: &Document) {
    let changed = document.changed_data().into_iter().chain(document.changed_plugins());
    for warning in document.graph.warnings.iter().cloned().chain(changed) {
        let located = document.locate(warning);
        present::say(&present::warning(&located, Some(&document.text)));
    }
}
