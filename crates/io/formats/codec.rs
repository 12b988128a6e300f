//! The block codecs and the base64 text of the VTK XML formats.
//!
//! A compressed array is a row of blocks that are compressed alone, so blocks are decompressed in parallel. The
//! size of a block is known beforehand: each codec fills a buffer of exactly that size and nothing beyond.
//!
//! An uncompressed array is one run of base64 text (a length header, then the values); some writers end the header with
//! padding and start anew. A compressed array is two runs: the block table, then all blocks. White space may stand
//! anywhere between the characters.

use super::source::Source;
use super::text::is_space;
use super::xz;
use voltet_core::{Error, Result, counted};

/// Compression of an array's blocks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Codec {
    Zlib,
    Lz4,
    Lzma,
}

/// The codecs in their order: value of the attribute `compressor`, name shown to people, and the most bytes that one byte can
/// become: what a header promises beyond it is a lie.
///
/// Deflate: 258 bytes from 2 bits. LZ4: 255 bytes from one. LZMA: a match of 273 bytes takes at least about 0.3 bits, 7,100 : 1
/// measured on zeros.
const CODECS: [(Codec, &str, &str, u64); 3] = [
    (Codec::Zlib, "vtkZLibDataCompressor", "zlib", 1032),
    (Codec::Lz4, "vtkLZ4DataCompressor", "lz4", 255),
    (Codec::Lzma, "vtkLZMADataCompressor", "lzma", 8192),
];

impl Codec {
    /// The codec that the attribute `compressor` names.
    pub fn from_name(name: &str) -> Result<Option<Codec>> {
        match CODECS.iter().find(|codec| codec.1 == name) {
            None if !name.is_empty() => Err(Error::run("the compressor is not known")
                .got(format_args!("'{name}'"))
                .expected("vtkZLibDataCompressor, vtkLZ4DataCompressor or vtkLZMADataCompressor")),
            codec => Ok(codec.map(|codec| codec.0)),
        }
    }

    /// The name shown to people.
    pub fn name(self) -> &'static str {
        CODECS[self as usize].2
    }

    /// The most bytes that `compressed` bytes can become.
    pub fn greatest_size(self, compressed: u64) -> u64 {
        compressed.saturating_mul(CODECS[self as usize].3)
    }

    /// Decompresses a block into `to`, which it must fill exactly. `zlib` is reused from block to block.
    pub fn decompress(self, zlib: &mut Option<flate2::Decompress>, from: &[u8], to: &mut [u8]) -> Result<()> {
        let damaged = |reason: &dyn std::fmt::Display| {
            Error::run(format!("a compressed block is damaged ({}: {reason})", self.name()))
        };
        let count = match self {
            Codec::Zlib => {
                let zlib = zlib.get_or_insert_with(|| flate2::Decompress::new(true));
                zlib.reset(true);
                let status = zlib.decompress(from, to, flate2::FlushDecompress::Finish);
                if status.map_err(|error| damaged(&error))? != flate2::Status::StreamEnd {
                    return Err(damaged(&"the block does not end where it should"));
                }
                zlib.total_out() as usize
            }
            Codec::Lz4 => lz4_flex::block::decompress_into(from, to).map_err(|error| damaged(&error))?,
            Codec::Lzma => xz::decompress(from, to).map_err(|error| damaged(&error))?,
        };
        if count != to.len() {
            return Err(Error::run("a compressed block has the wrong size")
                .got(counted(count, "byte"))
                .expected(counted(to.len(), "byte")));
        }
        Ok(())
    }
}

/// A position in base64 text.
#[derive(Clone)]
pub(super) struct Base64Text<'a> {
    pub source: &'a Source,
    pub at: u64,
    pub end: u64,
}

impl Base64Text<'_> {
    /// Decodes one run of `count` bytes: the characters that hold them and its padding.
    pub fn run(&mut self, count: u64) -> Result<Vec<u8>> {
        let most = (self.end - self.at) / 4 * 3 + 3;
        let ends_early = || {
            Error::run("the base64 text ends early")
                .got(format_args!("at most {most} bytes"))
                .expected(counted(count, "byte"))
        };
        let character_count = count.div_ceil(3).checked_mul(4).filter(|&n| n <= self.end - self.at);
        let character_count = character_count.ok_or_else(ends_early)? as usize;
        let text = self.characters(character_count)?;
        let mut bytes = if text.len() < character_count { Vec::new() } else { decode(&text)? };
        if (bytes.len() as u64) < count {
            return Err(ends_early());
        }
        bytes.truncate(count as usize);
        Ok(bytes)
    }

    /// True if the text begins with a run of exactly `count` bytes that ends with padding. A run of one byte more may have less of it.
    pub fn begins_with_padded_run(&self, count: u64) -> Result<bool> {
        let padding = (count.next_multiple_of(3) - count) as usize;
        let character_count = (count.div_ceil(3) * 4) as usize;
        let text = self.clone().characters(character_count)?;
        let found = text.iter().rev().take_while(|&&letter| letter == b'=').count();
        Ok(padding > 0 && text.len() == character_count && found == padding)
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
            buffer.split(|&byte| is_space(byte)).for_each(|run| text.extend_from_slice(run));
        }
        Ok(text)
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

#[cfg(test)]
mod tests {
    use super::*;

    /// A thousand zeros and "abc", compressed by XZ Utils.
    const STREAM: &[u8] = b"\xFD\x37\x7A\x58\x5A\x00\x00\x01\x69\x22\xDE\x36\x02\x00\x21\x01\x16\x00\x00\x00\x74\x2F\xE5\xA3\xE0\x03\xEA\x00\x0F\x5D\x00\x00\x6F\xFD\xFF\xFF\xA3\xB7\x5A\x56\x61\x22\x30\x8E\xBC\x20\x00\x00\x5A\x07\x40\x46\x00\x01\x27\xEB\x07\x00\x00\x00\x24\x2F\x2F\x1B\x3E\x30\x0D\x8B\x02\x00\x00\x00\x00\x01\x59\x5A";

    #[test]
    fn an_xz_stream_of_another_length_is_refused() {
        for len in [0, 10, 1002, 1004] {
            let error = Codec::Lzma.decompress(&mut None, STREAM, &mut vec![0; len]);
            let error = error.expect_err("another length").to_string();
            let said = if len < 1003 { "more bytes than the array needs" } else { "1003 bytes" };
            assert!(error.contains(said), "{error}");
        }
    }
}
