//! Bytes of an HDF5 file as the crate hdf5-reader takes them: fractal heaps are given to it as one row of equal blocks.
//!
//! A fractal heap holds the links of a group with many members, side by side in direct blocks. From half a MiB on, its root has blocks
//! of blocks (indirect blocks), too, and in those version 0.12 of the crate looks for an object at its place in the whole heap, not in
//! its block. So the crate gets another header of such a heap, whose root has one row of direct blocks, all as large as the largest.
//! They lie behind the end of the file, and hold the heap's own blocks, whose checksums were compared. A heap whose blocks are filtered
//! stays as it is, and so does one that would take far more memory than the file has bytes: the crate reads the direct blocks of its root.
//! Source: HDF5 File Format Specification 3.0, III.G, Fractal Heap.

use super::source::Source;
use hdf5_reader::checksum::jenkins_lookup3;
use hdf5_reader::error::{Error, Result};
use hdf5_reader::fractal_heap::FractalHeap;
use hdf5_reader::io::Cursor;
use hdf5_reader::storage::StorageBuffer;
use hdf5_reader::superblock::Superblock;
use hdf5_reader::{RangeRequestStorage, Storage};
use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Signatures of a heap's header, of its indirect and of its direct blocks.
const HEADER: &[u8] = b"FRHP";
const INDIRECT: &[u8] = b"FHIB";
const DIRECT: &[u8] = b"FHDB";
/// Most bytes of a header that the crate reads.
const HEADER_BYTES: u64 = 256;
/// Place of the flags in the header.
const FLAGS: usize = 9;
/// Flag of a heap whose direct blocks have checksums.
const HAS_CHECKSUMS: u8 = 2;
const CHECKSUM_BYTES: usize = 4;
/// Most rows of an indirect block: from the second on each has blocks of twice the size.
const MAX_ROWS: u32 = 64;
/// Most bytes that are read and kept for all heaps of a file, for one of the file: those of each block twice, and holes between them.
const MAX_HEAP_BYTES_PER_FILE_BYTE: u64 = 4;

/// Most bytes of a reading that comes from blocks of the file that are kept, as a group of a few arrays takes a hundred of a few dozen bytes;
/// bytes of these blocks, and most of them.
const SMALL: usize = 1 << 11;
const BLOCK_BYTES: u64 = 1 << 14;
const MAX_BLOCKS: usize = 64;

/// A file of which heaps are read as one row of blocks, and small readings come from blocks of the file: up to 1 MiB of these are kept.
pub(super) struct HeapStorage {
    file: RangeRequestStorage,
    source: Arc<Source>,
    /// Numbers of blocks and their bytes, each at its number modulo their count.
    blocks: Mutex<Vec<(u64, Vec<u8>)>>,
    superblock: Superblock,
    heaps: Mutex<Heaps>,
}

/// Heaps with indirect blocks below their roots.
struct Heaps {
    /// By the address of the header.
    headers: HashMap<u64, HeaderBytes>,
    /// Rows of blocks behind the end of the file, in the order of their addresses.
    rows: Vec<HeapRow>,
    /// Bytes that may yet be read and kept.
    bytes_left: u64,
}

/// Bytes that are read at the place of a header.
enum HeaderBytes {
    Replaced(Arc<Vec<u8>>),
    /// The bytes of the file: the heap cannot be one row.
    Own,
    /// Nothing: a block of the heap is not what its header says.
    Damaged,
}

/// A heap as one row of blocks.
struct HeapRow {
    /// Address of the root; the blocks follow.
    begin: u64,
    bytes: Arc<Vec<u8>>,
}

impl HeapRow {
    fn end(&self) -> u64 {
        self.begin + self.bytes.len() as u64
    }
}

impl Storage for HeapStorage {
    fn len(&self) -> u64 {
        self.file.len()
    }

    fn read_range(&self, at: u64, len: usize) -> Result<StorageBuffer> {
        if at >= self.len() {
            let heaps = self.heaps();
            let row = heaps.rows.partition_point(|row| row.end() <= at);
            if let Some(row) = heaps.rows.get(row).filter(|row| row.begin <= at) {
                return StorageBuffer::from_shared_owner(row.bytes.clone(), (at - row.begin) as usize, len);
            }
        }
        let bytes = self.bytes(at, len)?;
        let is_header = bytes.starts_with(HEADER) && len as u64 == HEADER_BYTES.min(self.len() - at);
        if is_header { self.replaced_header(at, bytes) } else { Ok(bytes) }
    }
}

impl HeapStorage {
    /// Bytes of a file. Errors: it is no HDF5.
    pub fn new(source: Arc<Source>) -> Result<HeapStorage> {
        let len = source.len();
        let own = source.clone();
        let failed = |error: voltet_core::Error| Error::Other(error.to_string());
        let file = RangeRequestStorage::new(len, move |at, len| own.read(at, len as u64).map_err(failed));
        let blocks = Mutex::new(vec![(u64::MAX, Vec::new()); MAX_BLOCKS]);
        let superblock = Superblock::parse_from_storage(&file)?;
        let bytes_left = len.saturating_mul(MAX_HEAP_BYTES_PER_FILE_BYTE);
        let heaps = Heaps { headers: HashMap::new(), rows: Vec::new(), bytes_left };
        Ok(HeapStorage { file, source, blocks, superblock, heaps: Mutex::new(heaps) })
    }

    /// Bytes of the file; few that lie in one block are copied out of it, and it is kept.
    fn bytes(&self, at: u64, len: usize) -> Result<StorageBuffer> {
        let (number, begin) = (at / BLOCK_BYTES, (at % BLOCK_BYTES) as usize);
        let block_len = BLOCK_BYTES.min(self.len().saturating_sub(number * BLOCK_BYTES)) as usize;
        if len > SMALL || begin + len > block_len {
            return self.file.read_range(at, len);
        }
        let mut blocks = self.blocks.lock().unwrap_or_else(PoisonError::into_inner);
        let (own, bytes) = &mut blocks[number as usize % MAX_BLOCKS];
        if *own != number {
            *own = u64::MAX;
            bytes.resize(block_len, 0);
            let read = self.source.read_at(number * BLOCK_BYTES, bytes);
            read.map_err(|error| Error::Other(error.to_string()))?;
            *own = number;
        }
        Ok(StorageBuffer::from_vec(bytes[begin..begin + len].to_vec()))
    }

    fn heaps(&self) -> MutexGuard<'_, Heaps> {
        self.heaps.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Bytes that are read in place of those of a header.
    fn replaced_header(&self, address: u64, bytes: StorageBuffer) -> Result<StorageBuffer> {
        let mut heaps = self.heaps();
        if !heaps.headers.contains_key(&address) {
            // The crate says what is wrong with a header, and reads all other heaps.
            let Some(mut heap) = Nested::of_header(self, address, &bytes, heaps.bytes_left) else {
                return Ok(bytes);
            };
            let begin = heaps.rows.last().map_or(self.len(), HeapRow::end).next_multiple_of(8);
            let header = match heap.as_one_row(begin, &bytes) {
                Ok((header, bytes)) => {
                    heaps.rows.push(HeapRow { begin, bytes: Arc::new(bytes) });
                    HeaderBytes::Replaced(Arc::new(header))
                }
                Err(header) => header,
            };
            heaps.bytes_left = heap.bytes_left;
            heaps.headers.insert(address, header);
        }
        match &heaps.headers[&address] {
            HeaderBytes::Replaced(header) => StorageBuffer::from_shared_owner(header.clone(), 0, bytes.len()),
            HeaderBytes::Own => Ok(bytes),
            HeaderBytes::Damaged => {
                Err(Error::InvalidData(format!("the fractal heap at byte {address} is damaged")))
            }
        }
    }
}

/// Part of a heap, or what is read of its header without that.
type HeapResult<T> = std::result::Result<T, HeaderBytes>;

/// A direct block: its place in the heap, its bytes.
type DirectBlock = (u64, Vec<u8>);

/// A heap with indirect blocks below its root.
struct Nested<'a> {
    file: &'a RangeRequestStorage,
    superblock: &'a Superblock,
    heap: FractalHeap,
    /// Address of the header in the file, as its blocks name it.
    address: u64,
    /// Bytes of a block's head that say where in the heap it lies.
    place_bytes: usize,
    /// Rows of direct blocks; those after them are indirect.
    direct_rows: u32,
    /// Bytes that may yet be read and kept.
    bytes_left: u64,
}

impl Nested<'_> {
    /// The heap of a header; `None` where that is damaged, or no block below the root is indirect.
    fn of_header<'a>(
        storage: &'a HeapStorage,
        address: u64,
        header: &[u8],
        bytes_left: u64,
    ) -> Option<Nested<'a>> {
        let HeapStorage { file, superblock, .. } = storage;
        let mut cursor = Cursor::new(header);
        let heap = FractalHeap::parse(&mut cursor, superblock.offset_size, superblock.length_size).ok()?;
        let sizes = [heap.starting_block_size, heap.max_direct_block_size, heap.table_width.into()];
        let is_known = sizes.iter().all(|size| size.is_power_of_two()) && heap.io_filters_len == 0;
        let direct_rows = sizes[1].checked_div(sizes[0]).filter(|&ratio| is_known && ratio > 0)?.ilog2() + 2;
        let rows = u32::from(heap.current_rows_in_root_indirect);
        let place_bytes = usize::from(heap.max_heap_size).div_ceil(8);
        let address = address.checked_sub(superblock.base_address)?;
        let smallest = heap.starting_block_size;
        let nested = Nested { file, superblock, heap, address, place_bytes, direct_rows, bytes_left };
        let has_room =
            smallest > (nested.head_bytes() + CHECKSUM_BYTES) as u64 && place_bytes <= size_of::<u64>();
        (direct_rows < rows && rows <= MAX_ROWS && has_room).then_some(nested)
    }

    /// Bytes of the head of an indirect or direct block, without its checksum.
    fn head_bytes(&self) -> usize {
        5 + usize::from(self.superblock.offset_size) + self.place_bytes
    }

    /// Counts bytes that are read or kept.
    fn count(&mut self, bytes: u64) -> HeapResult<usize> {
        self.bytes_left = self.bytes_left.checked_sub(bytes).ok_or(HeaderBytes::Own)?;
        usize::try_from(bytes).map_err(|_| HeaderBytes::Own)
    }

    /// Header and bytes of the heap as one row of blocks whose root is at an address.
    fn as_one_row(&mut self, begin: u64, header: &[u8]) -> HeapResult<(Vec<u8>, Vec<u8>)> {
        let mut found = Vec::new();
        let rows = u32::from(self.heap.current_rows_in_root_indirect);
        self.direct_blocks(self.heap.root_block_address, 0, rows, &mut found)?;
        let size = self.heap.max_direct_block_size;
        // Blocks of the row into which blocks of the heap fall; the others are holes.
        let mut columns: Vec<u64> = found.iter().map(|(place, _)| place / size).collect();
        columns.dedup();
        let last = columns.last().ok_or(HeaderBytes::Own)?;
        let width = u16::try_from(last + 1).map_err(|_| HeaderBytes::Own)?;
        let (head, offset_size) = (self.head_bytes(), usize::from(self.superblock.offset_size));
        let root_bytes = (head + usize::from(width) * offset_size).next_multiple_of(8);
        let blocks_bytes = size.checked_mul(columns.len() as u64).ok_or(HeaderBytes::Own)?;
        let total = self.count(blocks_bytes.saturating_add(root_bytes as u64))?;
        let root = begin.checked_sub(self.superblock.base_address).ok_or(HeaderBytes::Own)?;
        // An address of all ones is none.
        if offset_size < 8 && root.saturating_add(total as u64) >= (1 << (8 * offset_size)) - 1 {
            return Err(HeaderBytes::Own);
        }
        let mut bytes = vec![0; total];
        // It is less than the total.
        let block_bytes = size as usize;
        bytes[..4].copy_from_slice(INDIRECT);
        bytes[head..head + usize::from(width) * offset_size].fill(0xff);
        for (number, &column) in columns.iter().enumerate() {
            let place = root_bytes + number * block_bytes;
            // Where the heap has no block, too.
            bytes[place..place + 4].copy_from_slice(DIRECT);
            let entry = head + column as usize * offset_size;
            let address = (root + place as u64).to_le_bytes();
            bytes[entry..entry + offset_size].copy_from_slice(&address[..offset_size]);
        }
        for (place, own) in found {
            let number = columns.partition_point(|&column| column < place / size);
            let place = root_bytes + number * block_bytes + (place % size) as usize;
            bytes[place + head..place + own.len()].copy_from_slice(&own[head..]);
        }
        Ok((self.header_of_row(header, width, root), bytes))
    }

    /// The header, with a root of one row at an address.
    fn header_of_row(&self, header: &[u8], width: u16, root: u64) -> Vec<u8> {
        let [offset, length] = [self.superblock.offset_size, self.superblock.length_size].map(usize::from);
        let mut header = header.to_vec();
        header[FLAGS] &= !HAS_CHECKSUMS;
        let mut at = 14 + 10 * length + 2 * offset;
        let mut put = |bytes: &[u8], skipped: usize| {
            header[at..at + bytes.len()].copy_from_slice(bytes);
            at += bytes.len() + skipped;
        };
        put(&width.to_le_bytes(), 0);
        let size = self.heap.max_direct_block_size.to_le_bytes();
        // The greatest size of a direct block, the bits of a place and the first row of the root stay.
        put(&size[..length], length + 4);
        put(&root.to_le_bytes()[..offset], 0);
        put(&1_u16.to_le_bytes(), 0);
        let sum = jenkins_lookup3(&header[..at]);
        header[at..at + CHECKSUM_BYTES].copy_from_slice(&sum.to_le_bytes());
        header
    }

    /// Adds the direct blocks below an indirect block with so many rows, which begins at a place in the heap.
    fn direct_blocks(
        &mut self,
        address: u64,
        begin: u64,
        rows: u32,
        found: &mut Vec<DirectBlock>,
    ) -> HeapResult<()> {
        let (width, smallest) = (u64::from(self.heap.table_width), self.heap.starting_block_size);
        let offset_size = self.superblock.offset_size;
        let head = self.head_bytes() as u64;
        let len = head + u64::from(rows) * width * u64::from(offset_size) + CHECKSUM_BYTES as u64;
        let bytes = self.block(address, begin, len, INDIRECT)?;
        let (checked, sum) = bytes.split_at(bytes.len() - CHECKSUM_BYTES);
        if jenkins_lookup3(checked).to_le_bytes() != *sum {
            return Err(HeaderBytes::Damaged);
        }
        let mut entries = Cursor::new(checked);
        entries.set_position(head);
        let mut place = begin;
        for row in 0..rows {
            let size = smallest.checked_mul(1 << row.saturating_sub(1)).ok_or(HeaderBytes::Own)?;
            for _ in 0..width {
                let address = entries.read_offset(offset_size).map_err(|_| HeaderBytes::Damaged)?;
                match row < self.direct_rows {
                    _ if Cursor::is_undefined_offset(address, offset_size) => {}
                    true => found.push((place, self.direct_block(address, place, size)?)),
                    false => {
                        // As many rows as make up its size.
                        let first_row = width.checked_mul(smallest).ok_or(HeaderBytes::Own)?;
                        let ratio =
                            Some(size / first_row).filter(|&ratio| ratio > 0).ok_or(HeaderBytes::Own)?;
                        self.direct_blocks(address, place, ratio.ilog2() + 1, found)?;
                    }
                }
                place = place.checked_add(size).ok_or(HeaderBytes::Own)?;
            }
        }
        Ok(())
    }

    /// Bytes of a direct block at a place in the heap.
    fn direct_block(&mut self, address: u64, place: u64, size: u64) -> HeapResult<Vec<u8>> {
        let mut bytes = self.block(address, place, size, DIRECT)?.to_vec();
        let head = self.head_bytes();
        if self.heap.flags & HAS_CHECKSUMS != 0 {
            let own = &mut bytes[head..head + CHECKSUM_BYTES];
            let sum = [own[0], own[1], own[2], own[3]];
            own.fill(0);
            if jenkins_lookup3(&bytes).to_le_bytes() != sum {
                return Err(HeaderBytes::Damaged);
            }
        }
        Ok(bytes)
    }

    /// Bytes of a block of this heap at a place in it: the block names both, so none is read for two.
    fn block(&mut self, address: u64, place: u64, len: u64, signature: &[u8]) -> HeapResult<StorageBuffer> {
        let len = self.count(len)?;
        let begin = address.checked_add(self.superblock.base_address).ok_or(HeaderBytes::Damaged)?;
        let bytes = self.file.read_range(begin, len).map_err(|_| HeaderBytes::Damaged)?;
        let (offset_size, version) = (usize::from(self.superblock.offset_size), 0);
        let heap = &self.address.to_le_bytes()[..offset_size];
        let head = [signature, &[version], heap, &place.to_le_bytes()[..self.place_bytes]].concat();
        if bytes.starts_with(&head) { Ok(bytes) } else { Err(HeaderBytes::Damaged) }
    }
}

#[cfg(test)]
mod tests {
    use super::super::hdf5::Group;
    use super::*;
    use std::io::Read;

    const ADDRESS: usize = size_of::<u64>();
    /// Bytes of the head of a block.
    const HEAD: usize = 17;
    /// No address.
    const NONE: [u8; ADDRESS] = [0xff; ADDRESS];
    /// Places in the header of the number of blocks a row, of the smallest and of the greatest size of a direct block, of the address of
    /// the root, and of the sum.
    const WIDTH: usize = 110;
    const SMALLEST: usize = 112;
    const GREATEST: usize = 120;
    const ROOT: usize = 132;
    const SUM: usize = 142;

    /// Bytes of links.h5: the group `links` with 900 names of 1,504 letters for the group `target` and one link to it by path, and the
    /// group `many` with 3,300 such names; the group `beside` with 20 groups and the array `array`.
    fn links() -> Vec<u8> {
        let mut bytes = Vec::new();
        let packed = &include_bytes!("../tests/files/links.h5.gz")[..];
        flate2::read::GzDecoder::new(packed).read_to_end(&mut bytes).unwrap();
        bytes
    }

    /// Writes a file and opens it in a way.
    fn opened<T>(bytes: &[u8], open: impl FnOnce(Arc<Source>) -> T) -> T {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("links.h5");
        std::fs::write(&path, bytes).unwrap();
        open(Source::open(&path).unwrap())
    }

    fn root(bytes: &[u8]) -> Group {
        opened(bytes, |source| Group::root(source).unwrap())
    }

    fn storage(bytes: &[u8]) -> HeapStorage {
        opened(bytes, |source| HeapStorage::new(source).unwrap())
    }

    fn number(bytes: &[u8], at: usize) -> usize {
        u64::from_le_bytes(*bytes[at..].first_chunk().unwrap()) as usize
    }

    fn put(bytes: &mut [u8], at: usize, value: usize, len: usize) {
        bytes[at..at + len].copy_from_slice(&value.to_le_bytes()[..len]);
    }

    /// Puts the sum of what stands before it.
    fn sign(bytes: &mut [u8], begin: usize, sum: usize) {
        let own = jenkins_lookup3(&bytes[begin..sum]);
        put(bytes, sum, own as usize, CHECKSUM_BYTES);
    }

    fn rows(bytes: &[u8], header: usize) -> usize {
        number(bytes, header + ROOT + ADDRESS) & 0xffff
    }

    /// Places of the headers of the groups `links` and `many`.
    fn headers(bytes: &[u8]) -> [usize; 2] {
        let all = bytes.windows(4).enumerate().filter(|(_, own)| *own == HEADER).map(|(at, _)| at);
        let mut all: Vec<usize> = all.filter(|&at| rows(bytes, at) > 9).collect();
        // The number of objects.
        all.sort_by_key(|&at| number(bytes, at + 70));
        all.try_into().unwrap()
    }

    /// Places in the file of the addresses of blocks in the root.
    fn entries(bytes: &[u8], header: usize) -> Vec<usize> {
        let begin = number(bytes, header + ROOT) + HEAD;
        let entries = (0..rows(bytes, header) * 4).map(|entry| begin + ADDRESS * entry);
        entries.filter(|&at| bytes[at..at + ADDRESS] != NONE).collect()
    }

    #[test]
    fn every_link_of_a_heap_with_nested_blocks_leads_to_its_object() {
        let bytes = links();
        for user_block in [0, 512] {
            let root = root(&[&vec![0; user_block], &bytes[..]].concat());
            let target = root.required_group("target").unwrap().identity();
            let many = (0..1000).chain(1200..3500).collect::<Vec<_>>();
            let few = (0..900).collect::<Vec<_>>();
            for (group, numbers, others) in [("many", many, None), ("links", few, Some("elsewhere"))] {
                let links = root.required_group(group).unwrap();
                let mut names = links.names().unwrap();
                names.sort();
                let written = numbers.iter().map(|number| format!("{number:04}{}", "x".repeat(1500)));
                assert!(names == written.chain(others.map(str::to_owned)).collect::<Vec<_>>());
                for name in names.iter().step_by(50).chain(names.last()) {
                    assert_eq!(links.required_group(name).unwrap().identity(), target, "{name:.4}");
                }
                assert!(links.group("0000").unwrap().is_none());
            }
        }
    }

    #[test]
    fn a_heap_without_sums_is_read_and_a_hole_is_no_object() {
        let mut bytes = links();
        let [few, many] = headers(&bytes);
        bytes[few + FLAGS] &= !HAS_CHECKSUMS;
        sign(&mut bytes, few, few + SUM);
        let first = number(&bytes, entries(&bytes, few)[0]);
        bytes[first + HEAD] ^= 1;
        assert_eq!(root(&bytes).required_group("links").unwrap().names().unwrap().len(), 901);
        let storage = storage(&bytes);
        let heap = FractalHeap::parse_at_storage(&storage, many as u64, 8, 8).unwrap();
        assert_eq!(heap.current_rows_in_root_indirect, 1);
        let entries = storage.read_range(heap.root_block_address + 17, 8 * usize::from(heap.table_width));
        let hole = entries.unwrap().chunks_exact(8).position(|own| own == NONE).unwrap();
        assert!(storage.heaps().rows[0].bytes.len() < usize::from(heap.table_width) << 16);
        let mut id = [0; 7];
        put(&mut id, 1, (hole << 16) + 100, 4);
        put(&mut id, 5, 10, 2);
        assert!(matches!(heap.get_object_storage(&id, &storage, 8, 8), Err(Error::UndefinedAddress)));
    }

    #[test]
    fn groups_are_found_beside_an_array_that_cannot_be_opened() {
        let mut bytes = links();
        let names = |bytes: &[u8]| -> Vec<String> {
            let groups = root(bytes).required_group("beside").unwrap().groups().unwrap();
            groups.iter().map(|group| group.name().to_owned()).collect()
        };
        let whole = names(&bytes);
        assert_eq!(whole.len(), 20);
        // The heap of the array's attributes has identifiers of 8 bytes, those of links of 7.
        let is_of_attributes = |own: &[u8]| own.starts_with(HEADER) && own[5] == 8;
        let heap = bytes.windows(6).position(is_of_attributes).unwrap();
        bytes[heap + 30] ^= 1;
        assert!(root(&bytes).required_group("beside").unwrap().array("array").is_err());
        assert_eq!(names(&bytes), whole);
    }

    #[test]
    fn a_damaged_block_of_a_heap_is_an_error() {
        let bytes = links();
        let check = |damaged: &[u8]| {
            let error = root(damaged).required_group("links").unwrap().names().unwrap_err().to_string();
            assert!(error.contains("/links") && error.contains("fractal heap"), "{error}");
        };
        let [few, many] = headers(&bytes);
        let (block, entries) = (number(&bytes, few + ROOT), entries(&bytes, few));
        let last = entries[entries.len() - 1];
        for own in [block, number(&bytes, entries[0]), number(&bytes, last)] {
            for at in [own, own + 4, own + 30] {
                let mut damaged = bytes.clone();
                damaged[at] ^= 1;
                check(&damaged);
            }
        }
        // Its root once more, one block twice, a block of another heap.
        let other = self::entries(&bytes, many)[0];
        for (at, own) in
            [(last, block), (entries[1], number(&bytes, entries[0])), (entries[0], number(&bytes, other))]
        {
            let mut damaged = bytes.clone();
            put(&mut damaged, at, own, ADDRESS);
            sign(&mut damaged, block, block + HEAD + ADDRESS * 4 * rows(&bytes, few));
            check(&damaged);
        }
    }

    /// The file with another root of the first heap: rows of one block each, of which the first is there, as large as it says.
    fn crafted(smallest: usize, greatest: usize, rows: usize) -> Vec<u8> {
        let mut bytes = links();
        let [header, _] = headers(&bytes);
        let (begin, sum) = (bytes.len(), bytes.len() + HEAD + ADDRESS * rows);
        let head = bytes[number(&bytes, header + ROOT)..][..HEAD].to_vec();
        bytes.extend(head);
        bytes.resize(sum, 0xff);
        bytes.resize(sum + CHECKSUM_BYTES, 0);
        put(&mut bytes, begin + HEAD, sum + CHECKSUM_BYTES, ADDRESS);
        sign(&mut bytes, begin, sum);
        for (at, value, len) in [
            (WIDTH, 1, 2),
            (SMALLEST, smallest, ADDRESS),
            (GREATEST, greatest, ADDRESS),
            (ROOT, begin, ADDRESS),
            (ROOT + ADDRESS, rows, 2),
        ] {
            put(&mut bytes, header + at, value, len);
        }
        sign(&mut bytes, header, header + SUM);
        let mut block = [DIRECT, &bytes[begin + 4..begin + HEAD]].concat();
        block.resize(smallest.max(HEAD + CHECKSUM_BYTES), 0);
        let sum = jenkins_lookup3(&block) as usize;
        put(&mut block, HEAD, sum, CHECKSUM_BYTES);
        bytes.extend(block);
        bytes
    }

    #[test]
    fn sizes_in_a_header_take_no_memory_that_the_file_does_not_have() {
        let [header, _] = headers(&links());
        for (smallest, greatest, rows, is_read) in [
            (512, 1 << 16, 10, true),
            (512, 1 << 50, 44, false),
            (512, 1 << 36, 30, false),
            (1, 1 << 16, 19, false),
            (512, 1 << 16, 65, false),
        ] {
            let crafted = crafted(smallest, greatest, rows);
            let storage = storage(&crafted);
            let own = storage.read_range(header as u64, 256).unwrap();
            assert_eq!(*own != crafted[header..header + 256], is_read);
            assert_eq!(storage.heaps().rows.len(), usize::from(is_read));
            assert!(root(&crafted).required_group("links").unwrap().names().is_err());
        }
    }

    #[test]
    fn heaps_share_what_may_be_read_and_none_is_read_twice() {
        let mut bytes = links();
        let [few, many] = headers(&bytes);
        let whole = storage(&bytes);
        let left = |storage: &HeapStorage| storage.heaps().bytes_left;
        let replaced = |storage: &HeapStorage, at: usize| {
            let before = left(storage);
            let own = storage.read_range(at as u64, 256).map(|own| *own != bytes[at..at + 256]);
            (own.ok(), before - left(storage))
        };
        assert_eq!(left(&whole), 4 * bytes.len() as u64);
        let (own, taken) = replaced(&whole, few);
        assert!(own == Some(true) && taken > 2 * 900 * 1500 && taken < bytes.len() as u64);
        assert_eq!(replaced(&whole, few), (Some(true), 0));
        whole.heaps().bytes_left = 2 * 900 * 1500;
        let (own, taken) = replaced(&whole, many);
        assert!(own == Some(false) && taken > 900 * 1500);
        assert_eq!(replaced(&whole, many), (Some(false), 0));
        let last = entries(&bytes, few).pop().unwrap();
        let block = number(&bytes, last);
        bytes[block] ^= 1;
        let damaged = storage(&bytes);
        let read = || (damaged.read_range(few as u64, 256).is_err(), left(&damaged));
        assert_eq!(read(), read());
        assert!(read().0);
    }
}
