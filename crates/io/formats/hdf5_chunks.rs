//! Chunks of an HDF5 array that are decoded straight to where they belong, rows of chunks side by side: those that a B-tree of version 1
//! lists, as most writers make them, with deflate, shuffle, or neither. Others are decoded by the crate hdf5-reader.
//!
//! Source: HDF5 File Format Specification 3.0 (The HDF Group), "Version 1 B-trees" and "Filter Pipeline Message".

use super::codec::Codec;
use super::source::Source;
use hdf5_reader::btree_v1::{BTreeV1Key, BTreeV1Node};
use hdf5_reader::messages::filter_pipeline::{FILTER_DEFLATE, FILTER_SHUFFLE};
use hdf5_reader::messages::{HdfMessage, layout::DataLayout};
use hdf5_reader::{Dataset, Hdf5File};
use std::collections::HashSet;
use std::ops::Range;
use voltet_core::Result;

/// Part of an array along one axis: the first number, how many, and the distance between them.
pub(super) type Extent = (u64, u64, u64);

/// Place and length of a chunk in the file.
#[derive(Clone, Copy)]
struct ChunkPlace(u64, u32);

/// Rows of chunks of an array of two axes; further axes count as the second, one alone as the first.
pub(super) struct ChunkRows {
    /// The chunks, those of a row side by side.
    chunks: Vec<ChunkPlace>,
    chunk: [usize; 2],
    pub columns: usize,
    /// Rows of the array before the first of its part.
    pub skipped: usize,
    value_size: usize,
    filters: Vec<u16>,
}

/// Memory that a thread keeps from chunk to chunk.
#[derive(Default)]
pub(super) struct ChunkBuffers {
    read: Vec<u8>,
    inflated: Vec<u8>,
    chunk: Vec<u8>,
    block: Vec<u8>,
    zlib: Option<flate2::Decompress>,
}

/// Entry of the index about a chunk.
struct ChunkKey {
    chunk_size: u32,
    filter_mask: u32,
    offsets: Vec<u64>,
}

/// Index of an array's chunks, of which those between two are read.
struct ChunkTree<'a> {
    file: &'a Hdf5File,
    dims: &'a [u32],
    /// Numbers of chunks along each axis.
    firsts: &'a [u64],
    lasts: &'a [u64],
    /// First axes by which branches are left out; of all but the last of them one number is chosen.
    first_axes: usize,
}

impl ChunkTree<'_> {
    /// Adds the chunks of a node below a level, and of its children; `None` where the index is damaged.
    fn collect(
        &self,
        at: u64,
        level: u8,
        known: &mut HashSet<u64>,
        found: &mut Vec<(ChunkKey, u64)>,
    ) -> Option<()> {
        let node = self.node(at).filter(|node| node.level < level && known.insert(at))?;
        let is_between = |offsets: &[u64], axis: usize| {
            let place = offsets[axis] / u64::from(self.dims[axis]);
            (self.firsts[axis]..=self.lasts[axis]).contains(&place)
        };
        let axes = self.first_axes;
        let places = |offsets: &[u64]| -> Vec<u64> {
            offsets.iter().zip(self.dims).take(axes).map(|(&offset, &n)| offset / u64::from(n)).collect()
        };
        for (keys, &child) in node.keys.windows(2).zip(&node.children) {
            let [
                BTreeV1Key::RawData { chunk_size, filter_mask, offsets },
                BTreeV1Key::RawData { offsets: next, .. },
            ] = keys
            else {
                return None;
            };
            if node.level == 0 {
                if (0..self.dims.len()).all(|axis| is_between(offsets, axis)) {
                    let (chunk_size, filter_mask) = (*chunk_size, *filter_mask);
                    found.push((ChunkKey { chunk_size, filter_mask, offsets: offsets.clone() }, child));
                }
            } else if places(offsets)[..] <= self.lasts[..axes] && places(next)[..] >= self.firsts[..axes] {
                self.collect(child, node.level, known, found)?;
            }
        }
        Some(())
    }

    fn node(&self, at: u64) -> Option<BTreeV1Node> {
        let (storage, superblock) = (self.file.storage(), self.file.superblock());
        let size = usize::from(superblock.offset_size);
        let head_len = 8 + 2 * size;
        let head = storage.read_range(at, head_len).ok()?;
        let count = usize::from(u16::from_le_bytes([*head.get(6)?, *head.get(7)?]));
        let key_len = 8 + 8 * (self.dims.len() + 1);
        let bytes = storage.read_range(at, head_len + (count + 1) * key_len + count * size).ok()?;
        let axes = Some(self.dims.len() as u32);
        let mut cursor = hdf5_reader::io::Cursor::new(&bytes);
        BTreeV1Node::parse(&mut cursor, superblock.offset_size, superblock.length_size, axes).ok()
    }
}

impl ChunkRows {
    /// The chunks of a part of an array; `None` where they are of another kind, or not all there.
    pub fn find(file: &Hdf5File, dataset: &Dataset, part: &[Extent], value_size: usize) -> Option<ChunkRows> {
        let header = file.get_or_parse_header(dataset.address()).ok()?;
        let (mut layout, mut filters) = (None, Vec::new());
        for message in &header.messages {
            match message {
                HdfMessage::DataLayout(own) => layout = Some(&own.layout),
                HdfMessage::FilterPipeline(own) => filters = own.filters.iter().map(|own| own.id).collect(),
                HdfMessage::ExternalFiles(_) => return None,
                _ => {}
            }
        }
        let DataLayout::Chunked { address, dims, chunk_indexing: None, .. } = layout? else { return None };
        let is_known = matches!(
            filters[..],
            [] | [FILTER_DEFLATE] | [FILTER_SHUFFLE] | [FILTER_SHUFFLE, FILTER_DEFLATE]
        );
        if !is_known || file.superblock().base_address != 0 || *address >= file.storage().len() {
            return None;
        }
        let shape = dataset.shape();
        let chunk: Vec<usize> = dims.iter().map(|&n| n as usize).collect();
        if shape.is_empty() || shape.len() != chunk.len() || shape.len() != part.len() || chunk.contains(&0) {
            return None;
        }
        // Axes of which one number is chosen, such as the step, and chunks have one.
        let is_single = |&axis: &usize| part[axis].1 == 1 && chunk[axis] == 1;
        let first = (0..shape.len() - 1).take_while(is_single).count();
        let (rows, count, stride) = part[first];
        let is_whole = |axis: usize| part[axis] == (0, shape[axis], 1);
        if count == 0 || count > 1 && stride != 1 || !(first + 1..shape.len()).all(is_whole) {
            return None;
        }
        if !(first + 2..shape.len()).all(|axis| chunk[axis] as u64 == shape[axis]) {
            return None;
        }
        let inner = chunk.iter().skip(first + 2).try_fold(1_usize, |product, &n| product.checked_mul(n))?;
        let columns = match shape.get(first + 1) {
            Some(&n) => usize::try_from(n).ok()?.checked_mul(inner)?,
            None => 1,
        };
        let own = [chunk[first], chunk.get(first + 1).map_or(Some(1), |n| n.checked_mul(inner))?];
        let chunk_bytes = own[0].checked_mul(own[1])?.checked_mul(value_size)?;
        // No block of rows is longer.
        usize::try_from(count).ok()?.checked_mul(columns)?.checked_mul(value_size)?;
        let bounds = |axis: usize| {
            let (begin, count, _) = part[axis];
            (begin / chunk[axis] as u64, (begin + count - 1) / chunk[axis] as u64)
        };
        let (firsts, lasts): (Vec<u64>, Vec<u64>) = (0..shape.len()).map(bounds).unzip();
        let tree = ChunkTree { file, dims, firsts: &firsts, lasts: &lasts, first_axes: first + 1 };
        let mut leaves = Vec::new();
        tree.collect(*address, u8::MAX, &mut HashSet::new(), &mut leaves)?;
        let width = columns.div_ceil(own[1]);
        let row_count = usize::try_from(lasts[first] - firsts[first]).ok()?.checked_add(1)?;
        if Some(leaves.len()) != row_count.checked_mul(width) {
            return None;
        }
        let mut chunks = vec![None; leaves.len()];
        for (ChunkKey { chunk_size, filter_mask, offsets }, address) in leaves {
            if address.checked_add(chunk_size.into())? > file.storage().len() {
                return None;
            }
            let row = (offsets.get(first)? / chunk[first] as u64).checked_sub(firsts[first])?;
            let column = match chunk.get(first + 1) {
                Some(&n) => offsets.get(first + 1)? / n as u64,
                None => 0,
            };
            let is_backed = match filters.contains(&FILTER_DEFLATE) {
                true => chunk_bytes as u64 <= Codec::Zlib.greatest_size(chunk_size.into()),
                false => chunk_size as usize == chunk_bytes,
            };
            let place =
                usize::try_from(row).ok()?.checked_mul(width)?.checked_add(usize::try_from(column).ok()?)?;
            *chunks.get_mut(place).filter(|_| is_backed && filter_mask == 0)? =
                Some(ChunkPlace(address, chunk_size));
        }
        Some(ChunkRows {
            chunks: chunks.into_iter().collect::<Option<_>>()?,
            chunk: own,
            columns,
            skipped: usize::try_from(rows % own[0] as u64).ok()?,
            value_size,
            filters,
        })
    }

    pub fn row_count(&self) -> usize {
        self.chunk[0]
    }

    /// Bytes of the file that hold a row of chunks.
    pub fn file_bytes(&self, row: usize) -> u64 {
        self.row(row).iter().map(|chunk| u64::from(chunk.1)).sum()
    }

    fn row(&self, row: usize) -> &[ChunkPlace] {
        let width = self.columns.div_ceil(self.chunk[1]);
        &self.chunks[row * width..(row + 1) * width]
    }

    /// Values of some lines of a row of chunks, the columns of each row of the array side by side.
    pub fn read<'b>(
        &self,
        source: &Source,
        row: usize,
        lines: Range<usize>,
        buffers: &'b mut ChunkBuffers,
    ) -> Result<&'b [u8]> {
        let columns = self.chunk[1];
        let (line, piece) = (self.columns * self.value_size, columns * self.value_size);
        if columns == self.columns {
            self.decode(source, self.row(row)[0], buffers)?;
            return Ok(&buffers.chunk[lines.start * line..lines.end * line]);
        }
        let mut block = std::mem::take(&mut buffers.block);
        block.resize(lines.len() * line, 0);
        for (column, &place) in self.row(row).iter().enumerate() {
            self.decode(source, place, buffers)?;
            let begin = column * piece;
            let own = piece.min(line - begin);
            let lines = block.chunks_exact_mut(line).zip(buffers.chunk.chunks_exact(piece).skip(lines.start));
            match own {
                8 => lines.for_each(|(to, from)| to[begin..begin + 8].copy_from_slice(&from[..8])),
                4 => lines.for_each(|(to, from)| to[begin..begin + 4].copy_from_slice(&from[..4])),
                _ => lines.for_each(|(to, from)| to[begin..begin + own].copy_from_slice(&from[..own])),
            }
        }
        buffers.block = block;
        Ok(&buffers.block)
    }

    fn decode(&self, source: &Source, place: ChunkPlace, buffers: &mut ChunkBuffers) -> Result<()> {
        let ChunkBuffers { read, inflated, chunk, zlib, .. } = buffers;
        let len = self.chunk[0] * self.chunk[1] * self.value_size;
        source.check(place.0, place.1.into())?;
        let is_shuffled = self.filters.contains(&FILTER_SHUFFLE) && self.value_size > 1;
        let last = if is_shuffled { &mut *inflated } else { &mut *chunk };
        last.resize(len, 0);
        if self.filters.contains(&FILTER_DEFLATE) {
            read.resize(place.1 as usize, 0);
            source.read_at(place.0, read)?;
            let inflate = Codec::Zlib.decompress(zlib, read, last);
            inflate.map_err(|error| error.got(format_args!("the chunk at byte {} of the file", place.0)))?;
        } else {
            source.read_at(place.0, last)?;
        }
        if is_shuffled {
            chunk.resize(len, 0);
            unshuffle(inflated, chunk, self.value_size);
        }
        Ok(())
    }
}

/// Puts the bytes of values side by side, of which all first ones come first.
fn unshuffle(from: &[u8], to: &mut [u8], value_size: usize) {
    fn of_size<const N: usize>(from: &[u8], to: &mut [u8]) {
        let count = from.len() / N;
        for (place, value) in to.as_chunks_mut::<N>().0.iter_mut().enumerate() {
            *value = std::array::from_fn(|byte| from[byte * count + place]);
        }
    }
    match value_size {
        2 => of_size::<2>(from, to),
        4 => of_size::<4>(from, to),
        _ => of_size::<8>(from, to),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Read;
    use std::sync::Arc;

    /// Bytes of a part by the chunks, of which a row at a time is decoded.
    fn decoded(chunks: &ChunkRows, source: &Source, len: usize) -> Vec<u8> {
        let (mut buffers, mut bytes) = (ChunkBuffers::default(), Vec::new());
        let line = chunks.columns * chunks.value_size;
        for row in 0..chunks.chunks.len() / chunks.columns.div_ceil(chunks.chunk[1]) {
            let skipped = if row == 0 { chunks.skipped } else { 0 };
            let lines = skipped..chunks.row_count();
            let middle = lines.start + lines.len() / 2;
            for own in [lines.start..middle, middle..lines.end] {
                bytes.extend_from_slice(chunks.read(source, row, own.clone(), &mut buffers).unwrap());
                // Of chunks side by side no more is put together.
                assert!(buffers.block.is_empty() || buffers.block.len() == own.len() * line);
            }
        }
        bytes.truncate(len);
        bytes
    }

    /// Bytes of a part as the crate gives them.
    fn by_crate(dataset: &Dataset, part: &[Extent], size: usize) -> Vec<u8> {
        let shape: Vec<usize> = dataset.shape().iter().map(|&n| n as usize).collect();
        let raw = dataset.read_raw_bytes().unwrap();
        let inside = |place: usize| {
            let mut rest = place;
            (0..shape.len()).rev().all(|axis| {
                let index = (rest % shape[axis]) as u64;
                rest /= shape[axis];
                (part[axis].0..part[axis].0 + part[axis].1).contains(&index)
            })
        };
        let values = raw.chunks_exact(size).enumerate().filter(|value| inside(value.0));
        values.flat_map(|value| value.1.iter().copied()).collect()
    }

    /// A packed file of samples in a folder.
    fn sample(packed: &[u8]) -> (tempfile::TempDir, Arc<Source>, Hdf5File) {
        let mut bytes = Vec::new();
        flate2::read::GzDecoder::new(packed).read_to_end(&mut bytes).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.h5");
        std::fs::write(&path, &bytes).unwrap();
        (folder, Source::open(&path).unwrap(), Hdf5File::from_vec(bytes).unwrap())
    }

    #[test]
    fn chunks_are_found_by_offsets_of_four_bytes() {
        let packed = include_bytes!("../tests/files/vtkhdf_short_offsets.vtkhdf.gz");
        let (_folder, source, file) = sample(packed);
        assert_eq!(file.superblock().offset_size, 4);
        let dataset = file.root_group().unwrap().group("VTKHDF").unwrap().dataset("Points").unwrap();
        let part: Vec<Extent> = dataset.shape().iter().map(|&n| (0, n, 1)).collect();
        let truth = by_crate(&dataset, &part, 8);
        let chunks = ChunkRows::find(&file, &dataset, &part, 8).unwrap();
        assert_eq!(chunks.chunks.len(), 4);
        assert!(decoded(&chunks, &source, truth.len()) == truth);
    }

    #[test]
    fn every_form_of_chunks_is_that_of_the_crate() {
        let (_folder, source, file) = sample(include_bytes!("../tests/files/chunks.h5.gz"));
        let root = file.root_group().unwrap();
        let names = root.member_names().unwrap().1;
        assert_eq!(names.len(), 13);
        for name in names {
            let dataset = root.dataset(&name).unwrap();
            let size = dataset.raw_element_size().unwrap();
            let all: Vec<Extent> = dataset.shape().iter().map(|&n| (0, n, 1)).collect();
            let rows = |first, count| [&[(first, count, 1)], &all[1..]].concat();
            let mut parts = vec![all.clone(), rows(3, 4.min(all[0].1 - 3)), rows(all[0].1 - 1, 1)];
            if name == "steps" {
                parts.extend((0..4).map(|step| rows(step, 1)));
                parts.push(vec![(2, 1, 1), (60, 70, 1)]);
            }
            for part in parts {
                let chunks = ChunkRows::find(&file, &dataset, &part, size);
                assert_eq!(chunks.is_none(), name.starts_with("other"), "{name} {part:?}");
                let Some(chunks) = chunks else { continue };
                let truth = by_crate(&dataset, &part, size);
                assert!(decoded(&chunks, &source, truth.len()) == truth, "{name} {part:?}");
            }
        }
        // A chunk that would end behind the file.
        let mut damaged = std::fs::read(source.path()).unwrap();
        for at in 0..damaged.len() - 28 {
            if damaged[at..].starts_with(b"TREE\x01\0") {
                damaged[at + 24..at + 28].fill(0xff);
            }
        }
        let damaged = Hdf5File::from_vec(damaged).unwrap();
        let dataset = damaged.root_group().unwrap().dataset("rows").unwrap();
        assert!(ChunkRows::find(&damaged, &dataset, &[(0, 301, 1), (0, 3, 1)], 8).is_none());
        // Every second row, and some columns of each row, are no run of values.
        let rows = root.dataset("rows").unwrap();
        for part in [[(0, 100, 2), (0, 3, 1)], [(0, 301, 1), (1, 2, 1)]] {
            assert!(ChunkRows::find(&file, &rows, &part, 8).is_none());
        }
    }
}
