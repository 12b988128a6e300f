//! Texts that a plug-in declares: their limits and checks.

use crate::ffi::{ValidationError, text};
use std::ffi::c_char;

/// Longest name, word or unit (bytes).
pub(crate) const MAX_NAME_BYTES: usize = 64;

/// Longest summary, help or version (bytes).
pub(crate) const MAX_TEXT_BYTES: usize = 1024;

/// Largest number of parameters of a filter, and of words of a choice.
pub(crate) const MAX_PARAMETERS: u32 = 64;

/// A text of one line; `None` for a null pointer.
pub(crate) fn line(
    what: &str,
    address: *const c_char,
    most: usize,
) -> Result<Option<String>, ValidationError> {
    let text = text(address, most).map_err(|wrong| format!("{what} {wrong}"))?;
    match text {
        Some(text) if text.chars().any(char::is_control) => {
            Err(format!("{what} has control characters: {text:?}"))
        }
        text => Ok(text),
    }
}

/// A text that is neither absent nor empty.
pub(crate) fn required(what: &str, text: Option<String>) -> Result<String, ValidationError> {
    match text {
        None => Err(format!("{what} is a null pointer")),
        Some(text) if text.trim().is_empty() => Err(format!("{what} is empty")),
        Some(text) => Ok(text),
    }
}

/// A name that a pipeline file can spell without quotes.
pub(crate) fn identifier(what: &str, address: *const c_char) -> Result<String, ValidationError> {
    let name = required(what, line(what, address, MAX_NAME_BYTES)?)?;
    let fits = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-' || c == '_';
    match name.starts_with(|c: char| c.is_ascii_lowercase()) && name.chars().all(fits) {
        true => Ok(name),
        false => Err(format!(
            "{what} is '{name}', and may have lower-case letters, digits, '-' and '_' after a letter"
        )),
    }
}

/// A text that lives as long as the program.
pub(crate) fn leak(text: String) -> &'static str {
    text.leak()
}
