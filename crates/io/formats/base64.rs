//! Base64 text of the VTK XML formats, decoded in order from a part of a file.
//!
//! An uncompressed array is one run of text (a length header, then the values); some writers end the header with
//! padding and start anew. A compressed array is two runs: the block table, then all blocks. White space may stand
//! anywhere between the characters.

use super::source::Source;
use voltet_core::{Error, Result};

/// A position in base64 text.
#[derive(Clone)]
pub(super) struct Base64Text<'a> {
    source: &'a Source,
    at: u64,
    end: u64,
}

impl<'a> Base64Text<'a> {
    /// The text in the bytes `at .. end` of the file.
    pub fn new(source: &'a Source, at: u64, end: u64) -> Self {
        Base64Text { source, at, end }
    }

    /// The most bytes that the rest of the text can hold.
    pub fn greatest_size(&self) -> u64 {
        (self.end - self.at) / 4 * 3 + 3
    }

    /// Decodes one run of `count` bytes: the characters that hold them and its padding.
    pub fn run(&mut self, count: u64) -> Result<Vec<u8>> {
        let character_count = count.div_ceil(3).checked_mul(4).filter(|&n| n <= self.end - self.at);
        let Some(character_count) = character_count else { return Err(self.ends_early(count)) };
        let text = self.characters(character_count as usize)?;
        if (text.len() as u64) < character_count {
            return Err(self.ends_early(count));
        }
        let mut bytes = decode(&text)?;
        if (bytes.len() as u64) < count {
            return Err(self.ends_early(count));
        }
        bytes.truncate(count as usize);
        Ok(bytes)
    }

    /// True if the text begins with a run of exactly `count` bytes that ends with padding.
    pub fn begins_with_padded_run(&self, count: u64) -> Result<bool> {
        let character_count = (count.div_ceil(3) * 4) as usize;
        let text = self.clone().characters(character_count)?;
        Ok(!count.is_multiple_of(3) && text.len() == character_count && text.ends_with(b"="))
    }

    /// The next `count` characters that are not white space, or as many as there are.
    fn characters(&mut self, count: usize) -> Result<Vec<u8>> {
        const STEP: u64 = 1 << 20;
        let mut text = Vec::with_capacity(count);
        let mut buffer = Vec::new();
        while text.len() < count && self.at < self.end {
            let wanted = ((count - text.len()) as u64).min(STEP).min(self.end - self.at);
            buffer.resize(wanted as usize, 0);
            self.source.read_at(self.at, &mut buffer)?;
            self.at += wanted;
            text.extend(buffer.iter().copied().filter(|b| !b.is_ascii_whitespace()));
        }
        Ok(text)
    }

    fn ends_early(&self, count: u64) -> Error {
        Error::run("the base64 text ends early")
            .got(format_args!("at most {} bytes", self.greatest_size()))
            .expected(format_args!("{count} bytes"))
    }
}

/// Decodes text without white space.
fn decode(text: &[u8]) -> Result<Vec<u8>> {
    base64_simd::STANDARD.decode_to_vec(text).map_err(|_| {
        let wrong = text.iter().find(|b| !b.is_ascii_alphanumeric() && !b"+/=".contains(b));
        let error =
            Error::run("the base64 text is damaged").expected("A-Z, a-z, 0-9, +, / and padding at the end");
        match wrong {
            Some(byte) => error.got(format_args!("'{}'", byte.escape_ascii())),
            None => error,
        }
    })
}
