//! Numbers as text, parsed in parallel.

use super::numbers::{NumberType, Target, parse};
use rayon::prelude::*;
use voltet_core::Result;

/// Bytes of text that one task parses.
const PART: usize = 1 << 18;

/// The words of a text, in order.
pub(super) fn words(text: &[u8]) -> impl Iterator<Item = &[u8]> {
    text.split(|b| b.is_ascii_whitespace()).filter(|word| !word.is_empty())
}

/// All numbers of a text.
pub(super) fn numbers<T: Target>(number_type: NumberType, text: &[u8]) -> Result<Vec<T>> {
    let parts: Vec<Vec<T>> = parts(text)
        .into_par_iter()
        .map(|part| words(part).map(|word| parse(number_type, word)).collect())
        .collect::<Result<_>>()?;
    Ok(match <[Vec<T>; 1]>::try_from(parts) {
        Ok([only]) => only,
        Err(parts) => parts.concat(),
    })
}

/// Cuts a text at white space into parts of about [`PART`] bytes.
fn parts(mut text: &[u8]) -> Vec<&[u8]> {
    let mut parts = Vec::new();
    while text.len() > PART {
        let cut = text[PART..].iter().position(u8::is_ascii_whitespace).map_or(text.len(), |at| PART + at);
        let (part, rest) = text.split_at(cut);
        parts.push(part);
        text = rest;
    }
    parts.push(text);
    parts
}
