//! The .xz container of one LZMA2 stream, checked before it is decoded.
//!
//! lzma-rs decodes LZMA2; its own container reader allocates from unchecked lengths, so the container is read
//! here. Source: The .xz File Format, version 1.2.1 (tukaani.org), sections 2.1, 3.1 and 5.3.1; chunk headers of
//! LZMA2 as in XZ Utils' lzma2_decoder.c.

use std::io::Write;

/// Decompresses the .xz stream `from` into `to` and returns the bytes written.
pub(super) fn decompress(from: &[u8], to: &mut [u8]) -> Result<usize, &'static str> {
    const STREAM_HEADER: usize = 12;
    if from.len() < STREAM_HEADER || !from.starts_with(b"\xFD7zXZ\0") {
        return Err("not an xz stream");
    }
    let check = from[7];
    let block = &from[STREAM_HEADER..];
    let header_size = match block.first() {
        None | Some(0) => return if to.is_empty() { Ok(0) } else { Err("the xz stream holds no block") },
        Some(&size) => (usize::from(size) + 1) * 4,
    };
    let header = block.get(..header_size).ok_or("the xz stream ends early")?;
    let (fields, header_crc) = header.split_at(header_size - 4);
    if crc32(fields).to_le_bytes() != header_crc {
        return Err("the check sum of the xz block header does not match");
    }
    let flags = fields[1];
    let mut rest = &fields[2..];
    for bit in [0x40, 0x80] {
        if flags & bit != 0 {
            rest = skip_multibyte(rest)?;
        }
    }
    if flags & 3 != 0 || rest.len() < 3 || rest[0] != 0x21 || rest[1] != 1 {
        return Err("the xz stream uses a filter other than LZMA2");
    }
    let data = &block[header_size..];
    let (packed, unpacked) = chunks(data)?;
    if unpacked != to.len() {
        return Err("the xz stream does not hold as many bytes as the array needs");
    }
    let mut sink = Sink { to, count: 0 };
    lzma_rs::lzma2_decompress(&mut &data[..packed], &mut sink).map_err(|_| "the LZMA2 data is damaged")?;
    let count = sink.count;
    if check == 1 {
        let stored = data.get(packed.next_multiple_of(4)..).and_then(|rest| rest.first_chunk::<4>());
        if stored != Some(&crc32(&to[..count]).to_le_bytes()) {
            return Err("the check sum of the xz block does not match");
        }
    }
    Ok(count)
}

/// Walks the chunk headers of LZMA2: packed length with the end marker, and unpacked length.
fn chunks(data: &[u8]) -> Result<(usize, usize), &'static str> {
    const ENDS_EARLY: &str = "the LZMA2 data ends early";
    let (mut at, mut unpacked) = (0, 0);
    let word = |at: usize| -> Result<usize, &'static str> {
        let bytes = data.get(at..at + 2).ok_or(ENDS_EARLY)?;
        Ok(usize::from(bytes[0]) << 8 | usize::from(bytes[1]))
    };
    loop {
        let control = *data.get(at).ok_or(ENDS_EARLY)?;
        if at == 0 && !matches!(control, 0 | 1 | 0xE0..) {
            return Err("the LZMA2 data begins without its dictionary");
        }
        match control {
            0 => return Ok((at + 1, unpacked)),
            1 | 2 => {
                let size = word(at + 1)? + 1;
                unpacked += size;
                at += 3 + size;
            }
            3..0x80 => return Err("the LZMA2 data is damaged"),
            _ => {
                unpacked += (usize::from(control & 0x1F) << 16 | word(at + 1)?) + 1;
                at += 5 + usize::from(control >= 0xC0) + word(at + 3)? + 1;
            }
        }
        if at > data.len() {
            return Err(ENDS_EARLY);
        }
    }
}

/// Skips a number of up to nine bytes, seven bits each.
fn skip_multibyte(bytes: &[u8]) -> Result<&[u8], &'static str> {
    match bytes.iter().take(9).position(|byte| byte & 0x80 == 0) {
        Some(last) => Ok(&bytes[last + 1..]),
        None => Err("the xz block header is damaged"),
    }
}

fn crc32(bytes: &[u8]) -> u32 {
    let mut crc = flate2::Crc::new();
    crc.update(bytes);
    crc.sum()
}

/// Writes into a slice and refuses what does not fit.
struct Sink<'a> {
    to: &'a mut [u8],
    count: usize,
}

impl Write for Sink<'_> {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        let space = &mut self.to[self.count..];
        if bytes.len() > space.len() {
            return Err(std::io::ErrorKind::WriteZero.into());
        }
        space[..bytes.len()].copy_from_slice(bytes);
        self.count += bytes.len();
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A thousand zeros and "abc", compressed by XZ Utils.
    const STREAM: &[u8] = b"\xFD\x37\x7A\x58\x5A\x00\x00\x01\x69\x22\xDE\x36\x02\x00\x21\x01\x16\x00\x00\x00\x74\x2F\xE5\xA3\xE0\x03\xEA\x00\x0F\x5D\x00\x00\x6F\xFD\xFF\xFF\xA3\xB7\x5A\x56\x61\x22\x30\x8E\xBC\x20\x00\x00\x5A\x07\x40\x46\x00\x01\x27\xEB\x07\x00\x00\x00\x24\x2F\x2F\x1B\x3E\x30\x0D\x8B\x02\x00\x00\x00\x00\x01\x59\x5A";

    #[test]
    fn a_stream_of_another_program_is_decoded() {
        let mut to = [1; 1003];
        assert_eq!(decompress(STREAM, &mut to), Ok(1003));
        assert!(to[..1000].iter().all(|&b| b == 0) && to[1000..] == *b"abc");
    }

    #[test]
    fn a_stream_of_another_length_is_refused_before_it_is_decoded() {
        for len in [0, 10, 1002, 1004] {
            let error = decompress(STREAM, &mut vec![0; len]).unwrap_err();
            assert_eq!(error, "the xz stream does not hold as many bytes as the array needs");
        }
    }

    #[test]
    fn no_changed_bit_changes_the_values_unnoticed() {
        // The index and the footer behind the block's check sum are not read.
        let end = STREAM.len() - 28;
        for bit in (6 * 8..8 * 8).chain(12 * 8..end * 8) {
            let mut damaged = STREAM.to_vec();
            damaged[bit / 8] ^= 1 << (bit % 8);
            let mut to = [0; 1003];
            if decompress(&damaged, &mut to).is_ok() {
                // The flags may name another check sum, which is not computed here; and some states of the coder
                // decode these bytes alike.
                assert!(bit < 12 * 8 || (to[..1000] == [0; 1000] && to[1000..] == *b"abc"), "bit {bit}");
            }
        }
    }
}
