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
