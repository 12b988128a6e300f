//! The bytes of an array found in its file, their number compared with what headers promise, before anything is decoded.

use super::base64::Base64Text;
use super::codec::Codec;
use super::numbers::{ByteOrder, NumberType, convert};
use super::source::Source;
use super::stored::{Encoding, Meter, Stored};
use voltet_core::{Error, Result};

/// The bytes of an array, found and counted.
pub(super) enum Decodable {
    /// Text, not yet parsed.
    Text(Vec<u8>),
    /// Values side by side.
    Plain(Payload),
    /// Compressed blocks of `size` bytes, the last one of `last` bytes; `places` in the payload.
    Blocks { payload: Payload, codec: Codec, size: u64, last: u64, places: Vec<(u64, u32)> },
    /// Made by a function.
    Computed(Vec<f64>),
}

/// Bytes of a block, bytes of the last one, place and compressed length of each.
type BlockTable = (u64, u64, Vec<(u64, u32)>);

/// Bytes in the file or in memory.
pub(super) enum Payload {
    File { at: u64, len: u64 },
    Memory(Vec<u8>),
}

impl Payload {
    pub fn len(&self) -> u64 {
        match self {
            Payload::File { len, .. } => *len,
            Payload::Memory(bytes) => bytes.len() as u64,
        }
    }

    /// `len` bytes from `at` on; `buffer` holds them if they come from the file.
    pub fn get<'a>(
        &'a self,
        source: &Source,
        at: u64,
        len: usize,
        buffer: &'a mut Vec<u8>,
    ) -> Result<&'a [u8]> {
        match self {
            Payload::File { at: start, .. } => {
                buffer.resize(len, 0);
                source.read_at(start + at, buffer)?;
                Ok(buffer)
            }
            Payload::Memory(bytes) => Ok(&bytes[at as usize..at as usize + len]),
        }
    }
}

impl Stored {
    /// Finds the bytes and checks that they lie in the file.
    pub(super) fn find(&self, meter: &Meter) -> Result<Decodable> {
        let source = &*self.source;
        match &self.encoding {
            Encoding::Computed(compute) => Ok(Decodable::Computed(compute(meter)?)),
            Encoding::Text(parts) => {
                let mut text = Vec::new();
                for part in parts {
                    text.extend(source.read(part.start, part.end - part.start)?);
                    text.push(b' ');
                }
                Ok(Decodable::Text(text))
            }
            // An empty array may have no bytes at all, not even a length.
            _ if self.promised()? == Some(0) => Ok(Decodable::Plain(Payload::Memory(Vec::new()))),
            Encoding::Bytes(at) => {
                let len = self.promised()?.and_then(|count| self.number_type.byte_count(count)).unwrap_or(0);
                source.check(*at, len)?;
                Ok(Decodable::Plain(Payload::File { at: *at, len }))
            }
            &Encoding::Xml { at, end, base64, wide, codec } => {
                let width = if wide { 8 } else { 4 };
                if base64 {
                    let mut text = Base64Text::new(source, at, end);
                    let Some(codec) = codec else {
                        let separate = text.begins_with_padded_run(width)?;
                        let head = text.clone().run(width)?;
                        let len = word(&head, 0, wide, self.order);
                        self.check_len(len)?;
                        if separate {
                            text.run(width)?;
                            return Ok(Decodable::Plain(Payload::Memory(text.run(len)?)));
                        }
                        let mut bytes = text.run(len.saturating_add(width))?;
                        bytes.drain(..width as usize);
                        return Ok(Decodable::Plain(Payload::Memory(bytes)));
                    };
                    let head = text.clone().run(width * 3)?;
                    let block_count = word(&head, 0, wide, self.order);
                    let table_len = block_count.saturating_add(3).saturating_mul(width);
                    let table = text.run(table_len)?;
                    let (size, last, places) = self.places(&table, wide, codec)?;
                    let len = places.last().map_or(0, |&(at, len)| at + u64::from(len));
                    Ok(Decodable::Blocks {
                        payload: Payload::Memory(text.run(len)?),
                        codec,
                        size,
                        last,
                        places,
                    })
                } else {
                    let head_len = width * if codec.is_some() { 3 } else { 1 };
                    let head = source.read(at, head_len)?;
                    let first = word(&head, 0, wide, self.order);
                    let Some(codec) = codec else {
                        self.check_len(first)?;
                        source.check(at + width, first)?;
                        return Ok(Decodable::Plain(Payload::File { at: at + width, len: first }));
                    };
                    let table_len = first.saturating_add(3).saturating_mul(width);
                    let table = source.read(at, table_len)?;
                    let (size, last, places) = self.places(&table, wide, codec)?;
                    let len = places.last().map_or(0, |&(at, len)| at + u64::from(len));
                    source.check(at + table_len, len)?;
                    Ok(Decodable::Blocks {
                        payload: Payload::File { at: at + table_len, len },
                        codec,
                        size,
                        last,
                        places,
                    })
                }
            }
        }
    }

    /// That a stated length in bytes is the one promised.
    fn check_len(&self, len: u64) -> Result<()> {
        match self.promised()?.and_then(|count| self.number_type.byte_count(count)) {
            Some(promised) if promised != len => Err(Error::run("the array has the wrong size")
                .got(format_args!("{len} bytes"))
                .expected(format_args!(
                    "{promised} bytes ({} tuples of {} components of {})",
                    self.tuple_count.unwrap_or(0),
                    self.component_count,
                    self.number_type.name()
                ))),
            _ => Ok(()),
        }
    }

    /// Reads a block table: bytes of a block, bytes of the last one, place and compressed length of each.
    fn places(&self, table: &[u8], wide: bool, codec: Codec) -> Result<BlockTable> {
        let at = |index| word(table, index, wide, self.order);
        let (block_count, size, last) = (at(0), at(1), at(2));
        // A last block of length 0 means that all blocks are full.
        let last = if last == 0 { size } else { last };
        let wrong = |found: String| Error::run("the table of compressed blocks is damaged").got(found);
        if last > size {
            return Err(wrong(format!("a last block of {last} bytes among blocks of {size}")));
        }
        let mut places = Vec::with_capacity(block_count as usize);
        let mut begin = 0;
        for index in 0..block_count {
            let len = at(3 + index as usize);
            let full = if index + 1 == block_count { last } else { size };
            let short = u32::try_from(len).ok().filter(|_| full <= codec.greatest_size(len));
            let Some(short) = short else {
                return Err(wrong(format!("block {index} of {len} bytes that is to hold {full} bytes")));
            };
            places.push((begin, short));
            begin += len;
        }
        let total =
            if block_count == 0 { Some(0) } else { size.checked_mul(block_count - 1).map(|n| n + last) };
        match total {
            Some(total) => self.check_len(total)?,
            None => return Err(wrong(format!("{block_count} blocks of {size} bytes"))),
        }
        if usize::try_from(size).is_err() {
            return Err(wrong(format!("blocks of {size} bytes")));
        }
        Ok((size, last, places))
    }
}

/// The header word number `index`.
fn word(bytes: &[u8], index: usize, wide: bool, order: ByteOrder) -> u64 {
    let mut value = [0];
    let (number_type, size) = if wide { (NumberType::U64, 8) } else { (NumberType::U32, 4) };
    // The words are unsigned, so every one is in range.
    let _ = convert(number_type, order, &bytes[index * size..], &mut value);
    value[0]
}
