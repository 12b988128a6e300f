//! Streams of XZ: each compressed block of an array of VTK's LZMA codec is one.
//!
//! Source: L. Collin, I. Pavlov, "The .xz file format", version 1.2.1. Data are packed by LZMA2 alone, without filters before it; their
//! checksum is CRC-32 (VTK), CRC-64 (Python and the program xz) or none.

use crc::{CRC_64_XZ, Crc, Table};
use lzma_rust2::Lzma2Reader;
use std::io::{Error, Read, Result};

/// CRC-64 by sixteen bytes at a time.
static CRC_64: Crc<u64, Table<16>> = Crc::<u64, Table<16>>::new(&CRC_64_XZ);

/// Beginning of a stream, and its end.
const MAGIC: (&[u8], &[u8]) = (b"\xFD7zXZ\0", b"YZ");

/// Decompresses a stream into `to`, checks its sums, and returns the bytes written. What is kept on the way grows with what comes out,
/// which `to` bounds, not with the dictionary that a header asks for. Bytes after the stream are passed over.
pub(super) fn decompress(stream: &[u8], to: &mut [u8]) -> Result<usize> {
    let mut rest = stream;
    let head = take(&mut rest, 12)?.strip_prefix(MAGIC.0).and_then(checked);
    let flags = head.ok_or_else(|| damaged("head"))?;
    let checksum = match *flags {
        [0, 0] => Checksum(0, |_| [0; 8]),
        [0, 1] => Checksum(4, |bytes| u64::from(crc32fast::hash(bytes)).to_le_bytes()),
        [0, 4] => Checksum(8, |bytes| CRC_64.checksum(bytes).to_le_bytes()),
        [0, kind] => {
            let message = format!("its checksum is of kind {kind}, not none (0), CRC-32 (1) or CRC-64 (4)");
            return Err(Error::other(message));
        }
        _ => return Err(damaged("head")),
    };
    let (mut count, mut blocks) = (0, Vec::new());
    while rest.first().is_some_and(|&size| size > 0) {
        let sizes = block(&mut rest, &checksum, &mut to[count..])?;
        count += sizes[1] as usize;
        blocks.push(sizes);
    }
    let begin = rest;
    take(&mut rest, 1)?;
    if number(&mut rest)? != blocks.len() as u64 {
        return Err(damaged("index"));
    }
    for size in blocks.as_flattened() {
        if number(&mut rest)? != *size {
            return Err(damaged("index"));
        }
    }
    skip_zeros(&mut rest, begin.len())?;
    take(&mut rest, 4)?;
    let index = &begin[..begin.len() - rest.len()];
    let (sum, foot) = take(&mut rest, 12)?.split_at(4);
    let footer = [&(index.len() as u32 / 4 - 1).to_le_bytes(), flags, MAGIC.1].concat();
    if checked(index).is_none() || foot != footer || sum != crc32fast::hash(&foot[..6]).to_le_bytes() {
        return Err(damaged("index"));
    }
    Ok(count)
}

/// Bytes of a checksum, and it from the bytes that it is of.
struct Checksum(usize, fn(&[u8]) -> [u8; 8]);

/// Decompresses a block into the beginning of `to`; gives its bytes but for padding, and those written, as the index has them.
fn block(rest: &mut &[u8], checksum: &Checksum, to: &mut [u8]) -> Result<[u64; 2]> {
    let begin = rest.len();
    let head =
        checked(take(rest, (usize::from(rest[0]) + 1) * 4)?).ok_or_else(|| damaged("head of a block"))?;
    let (flags, mut fields) = (head[1], &head[2..]);
    let sizes = [0x40, 0x80].map(|flag| (flags & flag > 0).then(|| number(&mut fields)).transpose());
    // One filter with one byte of properties, the size of its dictionary: two to this half power.
    let dictionary = match fields {
        &[0x21, 1, size @ ..=40, ..] if flags & 0x3F == 0 => (2 | u64::from(size & 1)) << (size / 2 + 11),
        _ => match ((flags & 3) + 1, number(&mut fields)?) {
            (1, 0x21) => return Err(damaged("head of a block")),
            (count, first) => {
                let message = format!("it has {count} filters, first number {first}, not LZMA2 (33) alone");
                return Err(Error::other(message));
            }
        },
    };
    // No more of the dictionary than what is written is looked at.
    let dictionary = dictionary.min(to.len() as u64).clamp(1 << 12, u64::from(u32::MAX)) as u32;
    let packed = rest.len();
    let (mut reader, mut count) = (Lzma2Reader::new(*rest, dictionary, None), 0);
    while count < to.len() {
        match reader.read(&mut to[count..])? {
            0 => break,
            more => count += more,
        }
    }
    if reader.read(&mut [0])? > 0 {
        return Err(Error::other("the stream holds more bytes than the array needs"));
    }
    *rest = reader.into_inner();
    let packed = (packed - rest.len()) as u64;
    let size = (begin - rest.len() + checksum.0) as u64;
    skip_zeros(rest, begin)?;
    let is_whole = take(rest, checksum.0)? == &checksum.1(&to[..count])[..checksum.0];
    let [own_packed, own_count] = sizes;
    if !is_whole
        || own_packed?.unwrap_or(packed) != packed
        || own_count?.unwrap_or(count as u64) != count as u64
    {
        return Err(damaged("checksum of a block"));
    }
    Ok([size, count as u64])
}

fn damaged(what: &str) -> Error {
    Error::other(format!("the {what} is damaged"))
}

/// The next bytes.
fn take<'a>(rest: &mut &'a [u8], count: usize) -> Result<&'a [u8]> {
    rest.split_off(..count).ok_or_else(|| Error::other("the stream ends early"))
}

/// Passes over zeros up to a multiple of four bytes from where `begin` bytes were left.
fn skip_zeros(rest: &mut &[u8], begin: usize) -> Result<()> {
    let count = (rest.len().wrapping_sub(begin)) % 4;
    if take(rest, count)?.iter().any(|&byte| byte != 0) { Err(damaged("padding")) } else { Ok(()) }
}

/// The bytes before their CRC-32, if that is right.
fn checked(bytes: &[u8]) -> Option<&[u8]> {
    let (bytes, sum) = bytes.split_last_chunk()?;
    (crc32fast::hash(bytes) == u32::from_le_bytes(*sum)).then_some(bytes)
}

/// The next number: seven bits a byte, the lowest first; the last byte has no eighth bit.
fn number(rest: &mut &[u8]) -> Result<u64> {
    let mut value = 0;
    for shift in (0..63).step_by(7) {
        let byte = take(rest, 1)?[0];
        value |= u64::from(byte & 0x7F) << shift;
        if byte < 0x80 {
            return Ok(value);
        }
    }
    Err(damaged("length"))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A thousand zeros and "abc": by liblzma with CRC-32, CRC-64, without a checksum, and by XZ Utils in two blocks.
    const STREAMS: [&[u8]; 4] = [
        b"\xFD\x37\x7A\x58\x5A\x00\x00\x01\x69\x22\xDE\x36\x02\x00\x21\x01\x16\x00\x00\x00\x74\x2F\xE5\xA3\xE0\x03\xEA\x00\x0F\x5D\x00\x00\x6F\xFD\xFF\xFF\xA3\xB7\x5A\x56\x61\x22\x30\x8E\xBC\x20\x00\x00\x5A\x07\x40\x46\x00\x01\x27\xEB\x07\x00\x00\x00\x24\x2F\x2F\x1B\x3E\x30\x0D\x8B\x02\x00\x00\x00\x00\x01\x59\x5A",
        b"\xFD\x37\x7A\x58\x5A\x00\x00\x04\xE6\xD6\xB4\x46\x02\x00\x21\x01\x16\x00\x00\x00\x74\x2F\xE5\xA3\xE0\x03\xEA\x00\x0F\x5D\x00\x00\x6F\xFD\xFF\xFF\xA3\xB7\x5A\x56\x61\x22\x30\x8E\xBC\x20\x00\x00\xDA\x00\x6A\xC0\xDA\x5E\xB5\x95\x00\x01\x2B\xEB\x07\x00\x00\x00\x5F\xEF\xED\x6C\xB1\xC4\x67\xFB\x02\x00\x00\x00\x00\x04\x59\x5A",
        b"\xFD\x37\x7A\x58\x5A\x00\x00\x00\xFF\x12\xD9\x41\x02\x00\x21\x01\x16\x00\x00\x00\x74\x2F\xE5\xA3\xE0\x03\xEA\x00\x0F\x5D\x00\x00\x6F\xFD\xFF\xFF\xA3\xB7\x5A\x56\x61\x22\x30\x8E\xBC\x20\x00\x00\x00\x01\x23\xEB\x07\x00\x00\x00\x32\x6D\xBE\x80\xA8\x00\x0A\xFC\x02\x00\x00\x00\x00\x00\x59\x5A",
        b"\xFD\x37\x7A\x58\x5A\x00\x00\x04\xE6\xD6\xB4\x46\x03\xC0\x12\xD8\x04\x21\x01\x16\x00\x00\x00\x00\x4E\x07\x1A\xE8\xE0\x02\x57\x00\x0A\x5D\x00\x00\x6F\xFD\xFF\xFF\x79\x00\xA0\xE3\x00\x00\x00\x00\x8E\x62\x09\x34\x8D\x27\x0F\x65\x03\xC0\x13\x93\x03\x21\x01\x16\x00\x00\x00\x00\xB3\xF8\xDA\x51\xE0\x01\x92\x00\x0B\x5D\x00\x00\x6F\xFD\xFA\xFA\xC0\x9D\x30\x6B\x98\xE0\x00\x00\x59\xD9\x92\x98\x52\xF0\x3D\x58\x00\x02\x2A\xD8\x04\x2B\x93\x03\xBD\x6A\x10\x95\xB1\xC4\x67\xFB\x02\x00\x00\x00\x00\x04\x59\x5A",
    ];

    /// Bytes of the third stream that are packed values.
    const PACKED: std::ops::Range<usize> = 24..47;

    #[test]
    fn a_stream_of_another_program_is_decompressed() {
        for (number, stream) in STREAMS.iter().enumerate() {
            // What follows the stream is not looked at.
            let stream = [*stream, b"xyz"].concat();
            let mut to = [1; 1003];
            assert_eq!(decompress(&stream, &mut to).ok(), Some(1003), "{number}");
            assert!(to[..1000].iter().all(|&b| b == 0) && to[1000..] == *b"abc", "{number}");
        }
    }

    #[test]
    fn a_stream_with_other_filters_or_checksums_is_refused() {
        let heads = [
            (b"\xFD7zXZ\0\x00\x0A\xE1\xFB\x0C\xA1".as_slice(), "checksum is of kind 10, not"),
            (
                b"\xFD7zXZ\0\x00\x04\xE6\xD6\xB4\x46\x02\x01\x03\x01\x03\x21\x01\x16\x97\x8F\x71\xFC",
                "has 2 filters, first number 3, not LZMA2 (33) alone",
            ),
        ];
        for (head, said) in heads {
            let error = decompress(head, &mut []).expect_err(said).to_string();
            assert!(error.contains(said), "{error}");
        }
    }

    #[test]
    fn no_changed_bit_and_no_cut_changes_the_values_unnoticed() {
        // One more bit of context than the coder was given decodes these bytes alike, in each block.
        for (stream, expected) in STREAMS.into_iter().zip([1, 1, 0, 2]) {
            let mut unnoticed = 0;
            for bit in 0..stream.len() * 8 {
                // Without a checksum changed values are values.
                if stream == STREAMS[2] && PACKED.contains(&(bit / 8)) {
                    continue;
                }
                let mut damaged = stream.to_vec();
                damaged[bit / 8] ^= 1 << (bit % 8);
                let mut to = [0; 1003];
                if decompress(&damaged, &mut to).is_ok() {
                    assert!(to[..1000] == [0; 1000] && to[1000..] == *b"abc", "bit {bit}");
                    unnoticed += 1;
                }
            }
            assert_eq!(unnoticed, expected);
            for len in 0..stream.len() {
                assert!(decompress(&stream[..len], &mut [0; 1003]).is_err(), "{len}");
            }
        }
    }

    #[test]
    fn a_stream_without_blocks_has_an_index_of_none() {
        // That of an empty file by XZ Utils, and one whose index counts a block.
        let empty = b"\xFD7zXZ\0\x00\x04\xE6\xD6\xB4\x46\x00\x00\x00\x00\x1C\xDF\x44\x21\x1F\xB6\xF3\x7D\x01\x00\x00\x00\x00\x04\x59\x5A";
        assert_eq!(decompress(empty, &mut []).ok(), Some(0));
        let mut wrong = empty.to_vec();
        wrong[13] = 1;
        let sum = crc32fast::hash(&wrong[12..16]).to_le_bytes();
        wrong[16..20].copy_from_slice(&sum);
        let error = decompress(&wrong, &mut []).expect_err("an index of one block").to_string();
        assert!(error.contains("index is damaged"), "{error}");
    }
}
