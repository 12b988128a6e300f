//! The block codecs of the VTK XML formats.
//!
//! A compressed array is a row of blocks that are compressed alone, so blocks are decompressed in parallel. The
//! size of a block is known beforehand: each codec fills a buffer of exactly that size and nothing beyond.

use super::xz;
use voltet_core::{Error, Result};

/// How the blocks of an array are compressed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Codec {
    Zlib,
    Lz4,
    Lzma,
}

impl Codec {
    /// The codec that the attribute `compressor` names.
    pub fn from_name(name: &str) -> Result<Option<Codec>> {
        match name {
            "" => Ok(None),
            "vtkZLibDataCompressor" => Ok(Some(Codec::Zlib)),
            "vtkLZ4DataCompressor" => Ok(Some(Codec::Lz4)),
            "vtkLZMADataCompressor" => Ok(Some(Codec::Lzma)),
            _ => Err(Error::run("the compressor is not known")
                .found(format_args!("'{name}'"))
                .accepted("vtkZLibDataCompressor, vtkLZ4DataCompressor or vtkLZMADataCompressor")),
        }
    }

    /// The name shown to people.
    pub fn name(self) -> &'static str {
        match self {
            Codec::Zlib => "zlib",
            Codec::Lz4 => "lz4",
            Codec::Lzma => "lzma",
        }
    }

    /// The most bytes that `compressed` bytes can become: what a header promises beyond it is a lie.
    ///
    /// Deflate: 258 bytes from 2 bits, 1032 : 1. LZ4: 255 bytes from one. LZMA: a match of 273 bytes takes at
    /// least about 0.3 bits, 7,100 : 1 measured on zeros; 8,192 here.
    pub fn greatest_size(self, compressed: u64) -> u64 {
        let ratio = match self {
            Codec::Zlib => 1032,
            Codec::Lz4 => 255,
            Codec::Lzma => 8192,
        };
        compressed.saturating_mul(ratio)
    }
}

/// Decompresses blocks; one a thread, reused from block to block.
pub(super) struct Decompressor {
    codec: Codec,
    zlib: flate2::Decompress,
}

impl Decompressor {
    /// A decompressor of one codec.
    pub fn new(codec: Codec) -> Self {
        Decompressor { codec, zlib: flate2::Decompress::new(true) }
    }

    /// Decompresses `from` into `to`, which it must fill exactly.
    pub fn decompress(&mut self, from: &[u8], to: &mut [u8]) -> Result<()> {
        let damaged = |reason: String| {
            Error::run(format!("a compressed block is damaged ({}: {reason})", self.codec.name()))
        };
        let count = match self.codec {
            Codec::Zlib => {
                self.zlib.reset(true);
                let status = self
                    .zlib
                    .decompress(from, to, flate2::FlushDecompress::Finish)
                    .map_err(|error| damaged(error.to_string()))?;
                if status != flate2::Status::StreamEnd {
                    return Err(damaged("the block does not end where it should".into()));
                }
                self.zlib.total_out() as usize
            }
            Codec::Lz4 => {
                lz4_flex::block::decompress_into(from, to).map_err(|error| damaged(error.to_string()))?
            }
            Codec::Lzma => xz::decompress(from, to).map_err(|reason| damaged(reason.to_owned()))?,
        };
        if count != to.len() {
            return Err(Error::run("a compressed block has the wrong size")
                .found(format_args!("{count} bytes"))
                .accepted(format_args!("{} bytes", to.len())));
        }
        Ok(())
    }
}
