//! Arrays decoded into memory.
//!
//! [`Stored::load`] finds an array's bytes, compares their number with what the headers promise, and only then allocates
//! and decodes, in parallel, block by block straight into the destination.

use super::codec::{Base64Text, Codec};
use super::contents::{Compute, Encoding, Meter, Stored, tuples};
use super::hdf5_chunks::{ChunkBuffers, ChunkRows};
use super::large_pages::zeros;
use super::numbers::{ByteOrder, NumberType, Target, convert};
use super::source::Source;
use super::text::{TextRange, is_space};
use bytemuck::Pod;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::Arc;
use voltet_core::parallel::all_or_first;
use voltet_core::{Error, Result, counted};

/// Values that one task decodes from data that is not cut into blocks: what they take is in the cache until they are converted.
const PART: usize = 1 << 15;

/// Change of each part of the values while it is in the cache.
type Change<'a, T> = dyn Fn(&mut [T]) + Sync + 'a;

impl Stored {
    /// Reads all values. Allocates once their number is known to lie in the file.
    pub fn load<T: Target>(&self, meter: &Meter) -> Result<Vec<T>> {
        self.load_changed(meter, |_| ())
    }

    /// Reads all values and changes them, part by part while these are in the cache.
    pub fn load_changed<T: Target>(&self, meter: &Meter, change: impl Fn(&mut [T]) + Sync) -> Result<Vec<T>> {
        let found = self.find(meter).and_then(|found| self.load_found(found, meter, &change));
        found.map_err(|error| error.at_item(&self.name))
    }

    /// Number of the values if all parts of them are good, by the place of a part's first value, the number of all, and the part; of plain
    /// values and of blocks none is kept. `None`: some part is not good.
    pub fn count_if_all<T: Target>(
        &self,
        meter: &Meter,
        is_good: &(dyn Fn(usize, usize, &[T]) -> bool + Sync),
    ) -> Result<Option<usize>> {
        let counted = || {
            let found = self.find(meter)?;
            let Some((count, part_len)) = self.parts(&found)? else {
                let values: Vec<T> = self.load_found(found, meter, &|_: &mut [T]| ())?;
                let is_part_good = |(part, own)| is_good(part * PART, values.len(), own);
                return Ok(values.par_chunks(PART).enumerate().all(is_part_good).then_some(values.len()));
            };
            let is_part_good = |(buffers, values): &mut (Buffers, Vec<T>), first: usize| {
                values.resize(part_len.min(count - first), T::default());
                self.decode_part(&found, first, values, buffers, meter)?;
                Ok(is_good(first, count, values))
            };
            let firsts = (0..count.div_ceil(part_len)).into_par_iter().map(|part| part * part_len);
            let results = firsts.map_init(Default::default, is_part_good);
            // The first error or part that is not good ends it, first in the file whatever the threads.
            let ended = results.find_map_first(|result: Result<bool>| match result {
                Ok(true) => None,
                ended => Some(ended),
            });
            ended.unwrap_or(Ok(true)).map(|all| all.then_some(count))
        };
        counted().map_err(|error: Error| error.at_item(&self.name))
    }

    /// Number of the values, and of those of a part that is decoded by itself; `None` where they are not decoded so.
    fn parts(&self, found: &Decodable) -> Result<Option<(usize, usize)>> {
        let promised = self.promised()?;
        Ok(match found {
            Decodable::Plain(payload) => Some((self.count(payload.len(), promised)?, PART)),
            &Decodable::Blocks { size, total, .. } => {
                let value_size = self.number_type.size().filter(|&value| size.is_multiple_of(value as u64));
                match value_size {
                    Some(value) => Some((self.count(total, promised)?, (size as usize / value).max(1))),
                    None => None,
                }
            }
            _ => None,
        })
    }

    fn load_found<T: Target>(&self, found: Decodable, meter: &Meter, change: &Change<T>) -> Result<Vec<T>> {
        let promised = self.promised()?;
        if let Some((count, part_len)) = self.parts(&found)? {
            let mut values = zeros(count);
            let of_part = |buffers: &mut Buffers, (part, to): (usize, &mut [T])| {
                self.decode_part(&found, part * part_len, to, buffers, meter).map(|()| change(to))
            };
            all_or_first(values.par_chunks_mut(part_len).enumerate().map_init(Buffers::default, of_part))?;
            return Ok(values);
        }
        let mut values = match found {
            Decodable::Text(parts) => {
                // A value takes a letter and a space.
                let most = parts.iter().map(|part| part.len() / 2 + 1).sum::<u64>();
                let mut values = Vec::with_capacity(promised.unwrap_or(0).min(most) as usize);
                for part in &parts {
                    part.numbers(self.number_type, is_space, &mut values, |bytes| meter.advance(bytes))?;
                }
                values
            }
            Decodable::Computed(values) => T::all_from(values),
            Decodable::Chunks(chunks) => {
                let mut values = zeros(self.count(0, promised)?);
                self.decode_chunks(&chunks, &mut values, meter)?;
                values
            }
            // Values lie across the blocks, whose bytes are put side by side.
            blocks @ Decodable::Blocks { size, total, .. } => {
                let mut bytes: Vec<u8> = zeros(total as usize);
                let parts = bytes.chunks_mut((size as usize).max(1)).enumerate();
                let mut buffers = Buffers::default();
                for (index, to) in parts {
                    self.block(&blocks, index, &mut buffers, to, meter)?;
                }
                return self.load_found(Decodable::Plain(Payload::Memory(bytes)), meter, change);
            }
            Decodable::Plain(_) => Vec::new(),
        };
        match promised {
            Some(promised) if promised != values.len() as u64 => {
                let tuples = tuples(self.tuple_count.unwrap_or(0), self.component_count);
                Err(Error::run("the array has the wrong number of values")
                    .got(values.len())
                    .expected(format_args!("{promised} ({tuples})")))
            }
            _ => {
                values.par_chunks_mut(PART).for_each(change);
                Ok(values)
            }
        }
    }

    /// Reads all values as tuples of type `D`, which hold the array's components.
    pub fn load_tuples<T: Target, D: Pod>(&self, meter: &Meter) -> Result<Vec<D>> {
        let copied = |(_, values): (_, Vec<T>)| bytemuck::cast_slice(&values).to_vec();
        Ok(bytemuck::try_cast_vec(self.load(meter)?).unwrap_or_else(copied))
    }

    /// Number of values in the bytes found. Where one is promised, [`Stored::find`] has compared the bytes with it.
    fn count(&self, byte_count: u64, promised: Option<u64>) -> Result<usize> {
        match (promised, self.number_type.size()) {
            (Some(promised), _) => Ok(promised as usize),
            (None, Some(size)) if byte_count.is_multiple_of(size as u64) => Ok(byte_count as usize / size),
            _ => Err(Error::run("the array has the wrong size")
                .got(counted(byte_count, "byte"))
                .expected(format_args!("whole values of {}", self.number_type.name()))),
        }
    }

    /// Decodes the values of a part from its first on; those of blocks are one block.
    fn decode_part<T: Target>(
        &self,
        found: &Decodable,
        first: usize,
        to: &mut [T],
        buffers: &mut Buffers,
        meter: &Meter,
    ) -> Result<()> {
        let is_same = T::OWN == self.number_type && self.order == ByteOrder::NATIVE;
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
                match payload {
                    Payload::File { at: start, .. } if is_same => {
                        self.source.read_at(start + at as u64, bytemuck::cast_slice_mut(to))?;
                    }
                    _ => {
                        convert_to(payload.get(&self.source, at as u64, end - at, &mut buffers.read)?, to)?;
                    }
                }
                meter.advance((end - at) as u64)
            }
            Decodable::Blocks { size, .. } => {
                let value_size = self.number_type.size().unwrap_or(1);
                let index = first * value_size / (*size as usize).max(1);
                if is_same {
                    return self.block(found, index, buffers, bytemuck::cast_slice_mut(to), meter);
                }
                let mut bytes = std::mem::take(&mut buffers.decompressed);
                bytes.resize(to.len() * value_size, 0);
                self.block(found, index, buffers, &mut bytes, meter)?;
                convert_to(&bytes, to)?;
                buffers.decompressed = bytes;
                Ok(())
            }
            // Others have no parts.
            _ => Ok(()),
        }
    }

    /// Three arrays of one number each as vectors.
    pub fn joined(name: &str, planes: [Stored; 3]) -> Stored {
        let (source, tuple_count) = (planes[0].source.clone(), planes[0].tuple_count.unwrap_or(0));
        let compute: Compute = Arc::new(move |meter| join(&planes, meter));
        Stored::of_f64(&source, name, 3, tuple_count, Encoding::Computed(compute))
    }

    fn decode_chunks<T: Target>(&self, chunks: &ChunkRows, values: &mut [T], meter: &Meter) -> Result<()> {
        let (mut rest, mut parts) = (values, Vec::new());
        let mut skipped = chunks.skipped;
        while !rest.is_empty() {
            let len = rest.len().min((chunks.row_count() - skipped) * chunks.columns);
            let (part, after) = rest.split_at_mut(len);
            parts.push((parts.len(), skipped, part));
            (rest, skipped) = (after, 0);
        }
        let of_part = |buffers: &mut ChunkBuffers, (row, skipped, to): (usize, usize, &mut [T])| {
            let lines = skipped..skipped + to.len().div_ceil(chunks.columns);
            let bytes = chunks.read(&self.source, row, lines, buffers)?;
            convert(self.number_type, self.order, bytes, to).map_err(|index| {
                let error = Error::run(format!("value {index} of a row of chunks is out of range"));
                error.expected(T::ACCEPTED)
            })?;
            meter.advance(chunks.file_bytes(row))
        };
        all_or_first(parts.into_par_iter().map_init(ChunkBuffers::default, of_part)).map(drop)
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
        let bytes = payload.get(&self.source, at, len as usize, &mut buffers.read)?;
        codec
            .decompress(&mut buffers.zlib, bytes, to)
            .map_err(|error| error.got(format_args!("block {index} of {}", places.len())))?;
        meter.advance(u64::from(len))
    }
}

/// Values of arrays of the same length as tuples, each with one of every array.
pub(super) fn join<T: Target>(planes: &[Stored], meter: &Meter) -> Result<Vec<T>> {
    let n = planes.len();
    let found: Vec<Decodable> = planes
        .iter()
        .map(|plane| plane.find(meter).map_err(|error| error.at_item(&plane.name)))
        .collect::<Result<_>>()?;
    let misfit = || Error::run("the components of an array have different lengths");
    let counts = planes.iter().zip(&found).map(|(plane, found)| {
        // Plain parts begin anywhere.
        let is_plain = matches!(found, Decodable::Plain(_));
        Ok(plane
            .parts(found)
            .map_err(|error| error.at_item(&plane.name))?
            .filter(|_| is_plain)
            .map(|own| own.0))
    });
    let counts: Option<Vec<usize>> = counts.collect::<Result<_>>()?;
    let Some(counts) = counts else {
        let load = |(plane, found): (&Stored, Decodable)| {
            plane.load_found(found, meter, &|_: &mut [T]| ()).map_err(|error| error.at_item(&plane.name))
        };
        let columns: Vec<Vec<T>> = planes.iter().zip(found).map(load).collect::<Result<_>>()?;
        let count = columns.first().map_or(0, Vec::len);
        if columns.iter().any(|column| column.len() != count) {
            return Err(misfit());
        }
        let mut joined = zeros(count * n);
        joined.par_chunks_mut(PART * n).enumerate().for_each(|(part, to)| {
            for (component, column) in columns.iter().enumerate() {
                put(&column[part * PART..], to, component, n);
            }
        });
        return Ok(joined);
    };
    let count = counts.first().copied().unwrap_or(0);
    if counts.iter().any(|own| *own != count) {
        return Err(misfit());
    }
    let mut joined = zeros(count * n);
    let of_part = |(buffers, column): &mut (Buffers, Vec<T>), (part, to): (usize, &mut [T])| {
        for (component, (plane, found)) in planes.iter().zip(&found).enumerate() {
            column.resize(to.len() / n, T::default());
            plane
                .decode_part(found, part * PART, column, buffers, meter)
                .map_err(|error| error.at_item(&plane.name))?;
            put(column, to, component, n);
        }
        Ok(())
    };
    all_or_first(joined.par_chunks_mut((PART * n).max(1)).enumerate().map_init(Default::default, of_part))?;
    Ok(joined)
}

fn put<T: Copy>(from: &[T], tuples: &mut [T], component: usize, n: usize) {
    tuples.iter_mut().skip(component).step_by(n).zip(from).for_each(|(to, &from)| *to = from);
}

/// Memory that a thread keeps from part to part.
#[derive(Default)]
struct Buffers {
    read: Vec<u8>,
    decompressed: Vec<u8>,
    zlib: Option<flate2::Decompress>,
}

/// The bytes of an array, found and counted.
pub(super) enum Decodable {
    /// Text, not yet parsed.
    Text(Vec<TextRange>),
    /// Values side by side.
    Plain(Payload),
    /// Compressed blocks of `size` bytes each, `total` in all; `places` in the payload.
    Blocks { payload: Payload, codec: Codec, size: u64, total: u64, places: Vec<(u64, u32)> },
    /// Chunks of HDF5.
    Chunks(ChunkRows),
    /// Made by a function.
    Computed(Vec<f64>),
}

/// Bytes of a block, bytes of all, place and compressed length of each.
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
                for part in parts {
                    source.check(part.start, part.end.saturating_sub(part.start))?;
                }
                let range = |part: &Range<u64>| TextRange::new(&self.source, part.clone());
                Ok(Decodable::Text(parts.iter().map(range).collect()))
            }
            // An empty array may have no bytes at all, not even a length.
            _ if self.promised()? == Some(0) => Ok(Decodable::Plain(Payload::Memory(Vec::new()))),
            Encoding::Gathered(gather) | Encoding::Chunked(_, gather) => {
                if let Encoding::Chunked(find, _) = &self.encoding
                    && let Some(chunks) = find()
                {
                    return Ok(Decodable::Chunks(chunks));
                }
                let bytes = gather()?;
                self.check_len(bytes.len() as u64)?;
                Ok(Decodable::Plain(Payload::Memory(bytes)))
            }
            Encoding::Bytes(at) => {
                let len = self.promised()?.and_then(|count| self.number_type.byte_count(count)).unwrap_or(0);
                Payload::in_file(source, *at, len).map(Decodable::Plain)
            }
            &Encoding::Xml { at, end, base64, wide, codec } => {
                let width = if wide { 8 } else { 4 };
                let mut text = base64.then_some(Base64Text { source, at, end });
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
                let (size, total, places) = self.places(&table, wide, codec)?;
                let len = places.last().map_or(0, |&(at, len)| at + u64::from(len));
                let payload = match &mut text {
                    Some(text) => Payload::Memory(text.run(len)?),
                    None => Payload::in_file(source, at + table_len, len)?,
                };
                Ok(Decodable::Blocks { payload, codec, size, total, places })
            }
        }
    }

    /// Number of the values as headers tell it, those before the data included; `None` where only the data itself tells, or where it is
    /// more than the file can hold.
    pub(super) fn value_count(&self) -> Option<u64> {
        if self.tuple_count.is_some() {
            return self.promised().ok()?;
        }
        let &Encoding::Xml { at, end, base64, wide, codec } = &self.encoding else { return None };
        let (source, width) = (&*self.source, if wide { 8 } else { 4 });
        let head_len = width * if codec.is_some() { 3 } else { 1 };
        let head = match base64 {
            true => Base64Text { source, at, end }.run(head_len),
            false => source.read(at, head_len),
        };
        let head = head.ok()?;
        let word = |index| word(&head, index, wide, self.order);
        let (bytes, held) = (end.saturating_sub(at), codec.map_or(1, |codec| codec.greatest_size(1)));
        let stated = match codec {
            None => word(0),
            // All blocks but the last are full.
            Some(_) => match word(2) {
                0 => word(0).checked_mul(word(1))?,
                last => word(0).saturating_sub(1).checked_mul(word(1))?.checked_add(last)?,
            },
        };
        let size = self.number_type.size()? as u64;
        (stated <= bytes.saturating_mul(held)).then_some(stated / size)
    }

    /// That a stated length in bytes is the one promised.
    fn check_len(&self, len: u64) -> Result<()> {
        match self.promised()?.and_then(|count| self.number_type.byte_count(count)) {
            Some(promised) if promised != len => Err(Error::run("the array has the wrong size")
                .got(counted(len, "byte"))
                .expected(format_args!(
                    "{} ({} of {})",
                    counted(promised, "byte"),
                    tuples(self.tuple_count.unwrap_or(0), self.component_count),
                    self.number_type.name()
                ))),
            _ => Ok(()),
        }
    }

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
        let all_but_last = size.checked_mul(block_count.saturating_sub(1));
        let total = all_but_last.and_then(|n| if block_count == 0 { Some(0) } else { n.checked_add(last) });
        let total = total.ok_or_else(|| wrong(format!("{block_count} blocks of {size} bytes")))?;
        self.check_len(total)?;
        if usize::try_from(size).is_err() {
            return Err(wrong(format!("blocks of {size} bytes")));
        }
        Ok((size, total, places))
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
