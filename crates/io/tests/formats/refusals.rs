//! Errors of damaged files, by the words that they must have.

use std::path::Path;
use voltet_core::progress::NoProgress;
use voltet_io::formats::{Request, read};

/// Checks that a file is refused with an error of these words.
#[track_caller]
pub fn refused(path: &Path, request: &Request, words: &[impl AsRef<str>]) {
    let error = read(path, request, &NoProgress).map(|_| "a grid").unwrap_err();
    says(&error.to_string(), words);
}

/// Checks that a message has these words.
#[track_caller]
pub fn says(message: &str, words: &[impl AsRef<str>]) {
    let words = words.iter().map(AsRef::as_ref);
    let missing: Vec<&str> = words.filter(|word| !message.contains(*word)).collect();
    assert!(missing.is_empty(), "{missing:?} not in: {message}");
}
