//! How a command ends: what is shown of errors and warnings, and the exit code.

use crate::Document;
use crate::cli::present;
use crate::core::Error;
use crate::core::error::ErrorKind;

/// Nothing went wrong.
pub const DONE: u8 = 0;

/// The command or a pipeline file is wrong.
pub const WRONG: u8 = 2;

/// Shows an error, once, and gives its exit code. `text`: the pipeline file that it may point into.
pub fn show(error: &Error, text: Option<&str>) -> u8 {
    present::say(&present::error(error, text));
    code(error)
}

/// The exit code that an error means.
pub fn code(error: &Error) -> u8 {
    match error.kind {
        ErrorKind::Usage => WRONG,
        ErrorKind::Run | ErrorKind::Cancelled => 1,
    }
}

/// Shows the graph's own warnings, and what is no longer as a picture says.
pub fn warn(document: &Document) {
    let changed = document.changed_data().into_iter().chain(document.changed_plugins());
    for warning in document.graph.warnings.iter().cloned().chain(changed) {
        let located = document.locate(warning);
        present::say(&present::warning(&located, Some(&document.text)));
    }
}
