//! Bytes of an HDF5 file as the crate hdf5-reader takes them: fractal heaps are given to it as one row of equal blocks.
//!
//! A fractal heap holds the links of a group with many members, side by side in direct blocks. From half a MiB on, its root has blocks
//! of blocks (indirect blocks), too, and in those version 0.12 of the crate looks for an object at its place in the whole heap, not in
//! its block. So the crate gets another header of such a heap, whose root has one row of direct blocks, all as large as the largest.
//! They lie behind the end of the file, and hold the heap's own blocks, whose checksums were compared.
//! Source: HDF5 File Format Specification 3.0, III.G, Fractal Heap.

use super::source::Source;
use hdf5_reader::checksum::jenkins_lookup3;
use hdf5_reader::error::{Error, Result};
use hdf5_reader::fractal_heap::FractalHeap;
use hdf5_reader::io::Cursor;
use hdf5_reader::storage::StorageBuffer;
use hdf5_reader::superblock::Superblock;
use hdf5_reader::{RangeRequestStorage, Storage};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Signatures of a heap's header, of its indirect and of its direct blocks.
const HEADER: &[u8] = b"FRHP";
const INDIRECT: &[u8] = b"FHIB";
const DIRECT: &[u8] = b"FHDB";
/// Place of the flags in the header.
const FLAGS: usize = 9;
/// Flag of a heap whose direct blocks have checksums.
const HAS_CHECKSUMS: u8 = 2;
const CHECKSUM_BYTES: usize = 4;
/// Most rows of an indirect block: from the second on each has blocks of twice the size.
const MAX_ROWS: u32 = 64;
/// Most bytes of a heap for one of the file.
const MAX_HOLES: u64 = 4;

/// A file of which heaps are read as one row of blocks.
pub(super) struct HeapStorage {
    file: RangeRequestStorage,
    /// `None`: it is damaged.
    superblock: Option<Superblock>,
    heaps: Mutex<Vec<Arc<HeapRow>>>,
}

/// A heap as one row of blocks.
struct HeapRow {
    header_address: u64,
    /// Bytes that are read at the place of the header.
    header: Arc<Vec<u8>>,
    /// Place of the root and of the blocks, behind the end of the file.
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
        if at >= self.len()
            && let Some(heap) = self.heaps().iter().find(|heap| (heap.begin..heap.end()).contains(&at))
        {
            return StorageBuffer::from_shared_owner(heap.bytes.clone(), (at - heap.begin) as usize, len);
        }
        let bytes = self.file.read_range(at, len)?;
        if bytes.starts_with(HEADER) { self.header(at, bytes) } else { Ok(bytes) }
    }
}

impl HeapStorage {
    /// Bytes of a file.
    pub fn new(source: Arc<Source>) -> HeapStorage {
        let len = source.len();
        let read = move |at: u64, len: usize| {
            source.read(at, len as u64).map_err(|error| Error::Other(error.to_string()))
        };
        let file = RangeRequestStorage::new(len, read);
        let superblock = Superblock::parse_from_storage(&file).ok();
        HeapStorage { file, superblock, heaps: Mutex::default() }
    }

    fn heaps(&self) -> MutexGuard<'_, Vec<Arc<HeapRow>>> {
        self.heaps.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Bytes that are read in place of those of a header.
    fn header(&self, address: u64, bytes: StorageBuffer) -> Result<StorageBuffer> {
        let mut heaps = self.heaps();
        let known =
            heaps.iter().find(|heap| heap.header_address == address && heap.header.len() == bytes.len());
        if let Some(heap) = known {
            return StorageBuffer::from_shared_owner(heap.header.clone(), 0, bytes.len());
        }
        let parsed = self.superblock.as_ref().and_then(|own| Nested::of_header(&self.file, own, &bytes));
        // The crate says what is wrong with a header, and reads all other heaps.
        let Some(nested) = parsed else { return Ok(bytes) };
        let begin = heaps.last().map_or(self.len(), |heap| heap.end()).next_multiple_of(8);
        let Some((header, bytes)) = nested.row(begin, &bytes) else {
            return Err(Error::InvalidData(format!("the fractal heap at byte {address} is damaged")));
        };
        let (header, bytes) = (Arc::new(header), Arc::new(bytes));
        heaps.push(Arc::new(HeapRow { header_address: address, header: header.clone(), begin, bytes }));
        let len = header.len();
        StorageBuffer::from_shared_owner(header, 0, len)
    }
}

/// A direct block: its place in the heap, its address, its size.
type DirectBlock = (u64, u64, u64);

/// A heap with indirect blocks below its root.
struct Nested<'a> {
    file: &'a RangeRequestStorage,
    superblock: &'a Superblock,
    heap: FractalHeap,
    /// Bytes of a block's head that say where in the heap it lies.
    place_bytes: usize,
    /// Rows of direct blocks; those after them are indirect.
    direct_rows: u32,
}

impl Nested<'_> {
    /// The heap of a header; `None` where that is damaged, or no block below the root is indirect.
    fn of_header<'a>(
        file: &'a RangeRequestStorage,
        superblock: &'a Superblock,
        header: &[u8],
    ) -> Option<Nested<'a>> {
        let mut cursor = Cursor::new(header);
        let heap = FractalHeap::parse(&mut cursor, superblock.offset_size, superblock.length_size).ok()?;
        let sizes = [heap.starting_block_size, heap.max_direct_block_size, heap.table_width.into()];
        let is_known = sizes.iter().all(|size| size.is_power_of_two()) && heap.io_filters_len == 0;
        let direct_rows = sizes[1].checked_div(sizes[0]).filter(|&ratio| is_known && ratio > 0)?.ilog2() + 2;
        let rows = u32::from(heap.current_rows_in_root_indirect);
        let place_bytes = usize::from(heap.max_heap_size).div_ceil(8);
        let nested = Nested { file, superblock, heap, place_bytes, direct_rows };
        (direct_rows < rows && rows <= MAX_ROWS).then_some(nested)
    }

    /// Bytes of the head of an indirect or direct block, without its checksum.
    fn head_bytes(&self) -> usize {
        5 + usize::from(self.superblock.offset_size) + self.place_bytes
    }

    /// Greatest end of a heap: no two of its blocks are one, and a heap that was emptied in part has holes.
    fn greatest_end(&self) -> u64 {
        self.file.len().saturating_mul(MAX_HOLES)
    }

    /// Header and bytes of the heap as one row of blocks that begins at an address; `None` where it is damaged.
    fn row(&self, begin: u64, header: &[u8]) -> Option<(Vec<u8>, Vec<u8>)> {
        let mut blocks = Vec::new();
        let rows = u32::from(self.heap.current_rows_in_root_indirect);
        self.direct_blocks(self.heap.root_block_address, 0, rows, &mut blocks)?;
        let size = self.heap.max_direct_block_size;
        let end = blocks.last().map(|&(place, _, size)| place + size)?;
        let width = u16::try_from(end.div_ceil(size)).ok().filter(|_| end <= self.greatest_end())?;
        let offset_size = usize::from(self.superblock.offset_size);
        let root_bytes = (self.head_bytes() + usize::from(width) * offset_size).next_multiple_of(8);
        let total = root_bytes.checked_add(usize::from(width).checked_mul(usize::try_from(size).ok()?)?)?;
        let root = begin.checked_sub(self.superblock.base_address)?;
        // An address of all ones is none.
        if offset_size < 8 && root.checked_add(total as u64)? >= (1 << (8 * offset_size)) - 1 {
            return None;
        }
        let mut bytes = vec![0; total];
        bytes[..4].copy_from_slice(INDIRECT);
        for block in 0..usize::from(width) {
            let place = root_bytes + block * size as usize;
            // Where the heap has no block, too.
            bytes[place..place + 4].copy_from_slice(DIRECT);
            let entry = self.head_bytes() + block * offset_size;
            let address = (root + place as u64).to_le_bytes();
            bytes[entry..entry + offset_size].copy_from_slice(&address[..offset_size]);
        }
        for (place, address, size) in blocks {
            let own = self.direct_block(address, size)?;
            let place = root_bytes + usize::try_from(place).ok()?;
            let head = self.head_bytes();
            bytes.get_mut(place + head..place + own.len())?.copy_from_slice(&own[head..]);
        }
        Some((self.header_of_row(header, width, root), bytes))
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
    fn direct_blocks(&self, address: u64, begin: u64, rows: u32, found: &mut Vec<DirectBlock>) -> Option<()> {
        let width = u64::from(self.heap.table_width);
        let offset_size = self.superblock.offset_size;
        let entries_bytes = usize::try_from(u64::from(rows) * width * u64::from(offset_size)).ok()?;
        let bytes = self.block(address, self.head_bytes() + entries_bytes + CHECKSUM_BYTES, INDIRECT)?;
        let (checked, sum) = bytes.split_at_checked(bytes.len() - CHECKSUM_BYTES)?;
        if jenkins_lookup3(checked).to_le_bytes() != *sum {
            return None;
        }
        let mut entries = Cursor::new(checked);
        entries.set_position(self.head_bytes() as u64);
        let mut place = begin;
        for row in 0..rows {
            let size = self.heap.starting_block_size.checked_mul(1 << row.saturating_sub(1))?;
            for _ in 0..width {
                let address = entries.read_offset(offset_size).ok()?;
                let is_there = !Cursor::is_undefined_offset(address, offset_size);
                if is_there && place >= self.greatest_end() {
                    return None;
                }
                match row < self.direct_rows {
                    true if is_there => found.push((place, address, size)),
                    false if is_there => {
                        // As many rows as make up its size.
                        let first_row = width.checked_mul(self.heap.starting_block_size)?;
                        let rows = size.checked_div(first_row).filter(|&ratio| ratio > 0)?.ilog2() + 1;
                        self.direct_blocks(address, place, rows, found)?;
                    }
                    _ => {}
                }
                place = place.checked_add(size)?;
            }
        }
        Some(())
    }

    /// Bytes of a direct block.
    fn direct_block(&self, address: u64, size: u64) -> Option<Vec<u8>> {
        let mut bytes = self.block(address, usize::try_from(size).ok()?, DIRECT)?.to_vec();
        let head = self.head_bytes();
        if self.heap.flags & HAS_CHECKSUMS != 0 {
            let own = bytes.get_mut(head..head + CHECKSUM_BYTES)?;
            let sum = [own[0], own[1], own[2], own[3]];
            own.fill(0);
            if jenkins_lookup3(&bytes).to_le_bytes() != sum {
                return None;
            }
        }
        (bytes.len() > head).then_some(bytes)
    }

    /// Bytes of a block with this signature.
    fn block(&self, address: u64, len: usize, signature: &[u8]) -> Option<StorageBuffer> {
        let address = address.checked_add(self.superblock.base_address)?;
        let bytes = self.file.read_range(address, len).ok()?;
        // Its version is 0.
        (bytes.starts_with(signature) && bytes.get(4) == Some(&0)).then_some(bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::super::hdf5::{File, Group};
    use super::*;
    use std::io::Read;

    /// Bytes of links.h5: the group `links` with 900 names of 1,504 letters for the group `target`, and one link to it by path.
    fn links() -> Vec<u8> {
        let mut bytes = Vec::new();
        let packed = &include_bytes!("../tests/files/links.h5.gz")[..];
        flate2::read::GzDecoder::new(packed).read_to_end(&mut bytes).unwrap();
        bytes
    }

    fn root(bytes: &[u8]) -> voltet_core::Result<Group> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("links.h5");
        std::fs::write(&path, bytes).unwrap();
        File::open(Source::open(&path)?)?.root()
    }

    /// Place of the heap's root, and of the addresses of blocks in it.
    fn root_block(bytes: &[u8]) -> (usize, Vec<usize>) {
        let block = bytes.windows(4).rposition(|own| own == INDIRECT).unwrap();
        let entries = (0..16 * 4).map(|entry| block + 17 + 8 * entry);
        (block, entries.filter(|&at| bytes[at..at + 8] != [0xff; 8]).collect())
    }

    fn address(bytes: &[u8], at: usize) -> usize {
        u64::from_le_bytes(*bytes[at..].first_chunk().unwrap()) as usize
    }

    #[test]
    fn every_link_of_a_heap_with_nested_blocks_leads_to_its_object() {
        let bytes = links();
        let is_nested = |&&at: &&usize| bytes[address(&bytes, at)..].starts_with(INDIRECT);
        assert!(root_block(&bytes).1.iter().filter(is_nested).count() > 2);
        for user_block in [0, 512] {
            let root = root(&[&vec![0; user_block], &bytes[..]].concat()).unwrap();
            let target = root.required_group("target").unwrap().identity();
            let links = root.required_group("links").unwrap();
            let mut names = links.names().unwrap();
            names.sort();
            let written = (0..900).map(|number| format!("{number:04}{}", "x".repeat(1500)));
            assert!(names == written.chain(["elsewhere".to_owned()]).collect::<Vec<_>>());
            for name in &names {
                assert_eq!(links.required_group(name).unwrap().identity(), target, "{name:.4}");
            }
            assert!(links.group("0000").unwrap().is_none());
        }
    }

    #[test]
    fn a_damaged_block_of_a_heap_is_an_error() {
        let bytes = links();
        let check = |damaged: &[u8]| {
            let links = root(damaged).unwrap().required_group("links").unwrap();
            let error = links.names().unwrap_err().to_string();
            assert!(error.contains("/links") && error.contains("fractal heap"), "{error}");
        };
        let (block, entries) = root_block(&bytes);
        for own in entries.iter().map(|&at| address(&bytes, at)).chain([block]) {
            for at in [own, own + 4, own + 30] {
                let mut damaged = bytes.clone();
                damaged[at] ^= 1;
                check(&damaged);
            }
        }
        // The root has itself below it.
        let mut damaged = bytes.clone();
        let last = entries[entries.len() - 1];
        damaged[last..last + 8].copy_from_slice(&(block as u64).to_le_bytes());
        let sum = block + 17 + 8 * 16 * 4;
        let own = jenkins_lookup3(&damaged[block..sum]);
        damaged[sum..sum + CHECKSUM_BYTES].copy_from_slice(&own.to_le_bytes());
        check(&damaged);
    }
}
