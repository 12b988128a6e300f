//! Arrays decoded into memory.
//!
//! [`Stored::load`] finds an array's bytes, compares their number with what the headers promise, and only then allocates
//! and decodes, in parallel, block by block straight into the destination.

use super::codec::{Base64Text, Codec, Decompressor};
use super::contents::{Encoding, Meter, Stored};
use super::numbers::{self, ByteOrder, NumberType, Target, convert};
use super::source::Source;
use bytemuck::Pod;
use rayon::prelude::*;
use voltet_core::{Error, Result};

/// Values that one task decodes from data that is not cut into blocks: 2 MB of 64-bit values.
const PART: usize = 1 << 18;

/// Looks at a part of an array: the number of all values, that of the part's first, and the part.
type See<'a, T> = dyn Fn(usize, usize, &[T]) -> Result<()> + Sync + 'a;

impl Stored {
    /// Reads all values. Allocates once their number is known to lie in the file.
    pub fn load<T: Target>(&self, meter: &Meter) -> Result<Vec<T>> {
        let inner = || -> Result<Vec<T>> {
            let values = match self.find(meter)? {
                Decodable::Text(text) => {
                    let values = numbers::numbers(self.number_type, &text)?;
                    meter.advance(text.len() as u64)?;
                    values
                }
                Decodable::Computed(values) => T::all_from(values),
                found => {
                    let mut values = vec![T::default(); self.count(&found)?];
                    let found = self.whole_values(found, meter)?;
                    values
                        .par_chunks_mut(self.part_len(&found))
                        .enumerate()
                        .try_for_each_init(Buffers::default, |buffers, (part, to)| {
                            self.decode_range(&found, part, buffers, to, meter)
                        })?;
                    return Ok(values);
                }
            };
            self.check_count(values.len() as u64)?;
            Ok(values)
        };
        inner().map_err(|error| error.at_item(&self.name))
    }

    /// Reads all values as tuples of type `D`, which hold the array's components.
    pub fn load_tuples<T: Target + Pod, D: Pod>(&self, meter: &Meter) -> Result<Vec<D>> {
        let copied = |(_, values): (_, Vec<T>)| bytemuck::cast_slice(&values).to_vec();
        Ok(bytemuck::try_cast_vec(self.load(meter)?).unwrap_or_else(copied))
    }

    /// Number of values in the bytes found, which is the number promised.
    fn count(&self, found: &Decodable) -> Result<usize> {
        let byte_count = match found {
            Decodable::Plain(payload) => payload.len(),
            Decodable::Blocks { size, last, places, .. } => match places.len() as u64 {
                0 => 0,
                count => (count - 1) * size + last,
            },
            // Counted when they are there.
            Decodable::Text(_) | Decodable::Computed(_) => 0,
        };
        let promised = self.promised()?;
        let count = match (self.number_type.size(), promised) {
            (Some(size), _) if byte_count.is_multiple_of(size as u64) => byte_count / size as u64,
            (None, Some(promised)) if promised.div_ceil(8) == byte_count => promised,
            _ => {
                return Err(Error::run("the array has the wrong size")
                    .got(format_args!("{byte_count} bytes"))
                    .expected(match promised.and_then(|count| self.number_type.byte_count(count)) {
                        Some(bytes) => format!("{bytes} bytes of {}", self.number_type.name()),
                        None => format!("whole values of {}", self.number_type.name()),
                    }));
            }
        };
        self.check_count(count)?;
        Ok(count as usize)
    }

    fn check_count(&self, count: u64) -> Result<()> {
        match self.promised()? {
            Some(promised) if promised != count => {
                Err(Error::run("the array has the wrong number of values").got(count).expected(format_args!(
                    "{promised} ({} tuples of {} components)",
                    self.tuple_count.unwrap_or(0),
                    self.component_count
                )))
            }
            _ => Ok(()),
        }
    }

    /// Shows all values to `see`, part by part and in parallel, without keeping them.
    pub fn visit<T: Target>(&self, meter: &Meter, see: &See<T>) -> Result<()> {
        let in_array = |error: Error| error.at_item(&self.name);
        if matches!(self.encoding, Encoding::Text(_) | Encoding::Computed(_)) {
            let values = self.load(meter)?;
            return see(values.len(), 0, &values).map_err(in_array);
        }
        let inner = || -> Result<()> {
            let found = self.find(meter)?;
            let count = self.count(&found)?;
            let found = self.whole_values(found, meter)?;
            let part_len = self.part_len(&found);
            (0..count.div_ceil(part_len)).into_par_iter().try_for_each_init(
                || (Buffers::default(), Vec::new()),
                |(buffers, values), part| {
                    let first = part * part_len;
                    values.resize((count - first).min(part_len), T::default());
                    self.decode_range(&found, part, buffers, values, meter)?;
                    see(count, first, values)
                },
            )
        };
        inner().map_err(in_array)
    }

    /// Puts the bytes side by side where values lie across the blocks.
    fn whole_values(&self, found: Decodable, meter: &Meter) -> Result<Decodable> {
        let Decodable::Blocks { size, last, places, .. } = &found else { return Ok(found) };
        if self.number_type.size().is_some_and(|value_size| size.is_multiple_of(value_size as u64)) {
            return Ok(found);
        }
        let total = (places.len().saturating_sub(1)) * *size as usize + *last as usize;
        let mut bytes = vec![0; if places.is_empty() { 0 } else { total }];
        bytes
            .par_chunks_mut((*size as usize).max(1))
            .enumerate()
            .try_for_each_init(Buffers::default, |buffers, (index, to)| {
                self.block(&found, index, buffers, to, meter)
            })?;
        Ok(Decodable::Plain(Payload::Memory(bytes)))
    }

    /// Values of a part that one task decodes.
    fn part_len(&self, found: &Decodable) -> usize {
        match (found, self.number_type.size()) {
            (Decodable::Blocks { size, .. }, Some(value_size)) => (*size as usize / value_size).max(1),
            _ => PART,
        }
    }

    /// Decodes one part.
    fn decode_range<T: Target>(
        &self,
        found: &Decodable,
        part: usize,
        buffers: &mut Buffers,
        to: &mut [T],
        meter: &Meter,
    ) -> Result<()> {
        let first = part * self.part_len(found);
        let convert_to = |bytes: &[u8], to: &mut [T]| {
            convert(self.number_type, self.order, bytes, to).map_err(|index| {
                Error::run(format!("value {} of the array is out of range", first + index))
                    .expected(T::ACCEPTED)
            })
        };
        match found {
            Decodable::Plain(payload) => {
                // A part is a multiple of 8 values, so parts of bit arrays begin with a byte.
                let (at, end) = match self.number_type.size() {
                    Some(size) => (first * size, (first + to.len()) * size),
                    None => (first / 8, (first + to.len()).div_ceil(8)),
                };
                convert_to(payload.get(&self.source, at as u64, end - at, &mut buffers.read)?, to)?;
                meter.advance((end - at) as u64)
            }
            _ => {
                let len = to.len() * self.number_type.size().unwrap_or(1);
                let mut bytes = std::mem::take(&mut buffers.decompressed);
                bytes.resize(len, 0);
                self.block(found, part, buffers, &mut bytes, meter)?;
                convert_to(&bytes, to)?;
                buffers.decompressed = bytes;
                Ok(())
            }
        }
    }

    /// Decompresses block `index` into `to`, which has its size.
    fn block(
        &self,
        found: &Decodable,
        index: usize,
        buffers: &mut Buffers,
        to: &mut [u8],
        meter: &Meter,
    ) -> Result<()> {
        let Decodable::Blocks { payload, codec, places, .. } = found else { return Ok(()) };
        let (at, len) = places[index];
        let decompressor = buffers.decompressor.get_or_insert_with(|| Decompressor::new(*codec));
        let bytes = payload.get(&self.source, at, len as usize, &mut buffers.read)?;
        decompressor
            .decompress(bytes, to)
            .map_err(|error| error.got(format_args!("block {index} of {}", places.len())))?;
        meter.advance(u64::from(len))
    }
}

/// Memory that a thread keeps from part to part.
#[derive(Default)]
struct Buffers {
    read: Vec<u8>,
    decompressed: Vec<u8>,
    decompressor: Option<Decompressor>,
}

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
    /// Bytes of the file, which must hold them.
    fn in_file(source: &Source, at: u64, len: u64) -> Result<Payload> {
        source.check(at, len)?;
        Ok(Payload::File { at, len })
    }

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
                Payload::in_file(source, *at, len).map(Decodable::Plain)
            }
            &Encoding::Xml { at, end, base64, wide, codec } => {
                let width = if wide { 8 } else { 4 };
                let mut text = base64.then(|| Base64Text::new(source, at, end));
                let head_len = width * if codec.is_some() { 3 } else { 1 };
                let head = match &text {
                    Some(text) => text.clone().run(head_len)?,
                    None => source.read(at, head_len)?,
                };
                let first = word(&head, 0, wide, self.order);
                let Some(codec) = codec else {
                    self.check_len(first)?;
                    return Ok(Decodable::Plain(match text {
                        None => Payload::in_file(source, at + width, first)?,
                        Some(mut text) if text.begins_with_padded_run(width)? => {
                            text.run(width)?;
                            Payload::Memory(text.run(first)?)
                        }
                        Some(mut text) => {
                            let mut bytes = text.run(first.saturating_add(width))?;
                            bytes.drain(..width as usize);
                            Payload::Memory(bytes)
                        }
                    }));
                };
                let table_len = first.saturating_add(3).saturating_mul(width);
                let table = match &mut text {
                    Some(text) => text.run(table_len)?,
                    None => source.read(at, table_len)?,
                };
                let (size, last, places) = self.places(&table, wide, codec)?;
                let len = places.last().map_or(0, |&(at, len)| at + u64::from(len));
                let payload = match &mut text {
                    Some(text) => Payload::Memory(text.run(len)?),
                    None => Payload::in_file(source, at + table_len, len)?,
                };
                Ok(Decodable::Blocks { payload, codec, size, last, places })
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
