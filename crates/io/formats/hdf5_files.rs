//! Files in HDF5 as the crate hdf5-reader opens them, and those that external links lead to.
//!
//! The crate keeps of each object what its header says, for as long as the file is open, 35 to 60 kB for a VTKHDF block of two arrays. So a
//! file is opened anew after [`MAX_OPENED`] objects; groups are known by their paths, and arrays that are read later by group and name. Groups
//! among many are found again by their addresses, not by the names of all ([`hdf5_views`]).

use super::hdf5_heaps::HeapStorage;
use super::hdf5_views::{self, Views};
use super::hdf5_virtual;
use super::source::Source;
use super::xml::{beside, open_named};
use hdf5_reader::group::Group;
use hdf5_reader::{Hdf5File, OpenOptions, Storage};
use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};
use voltet_core::{Error, Result};

/// Most bytes that deflate makes of one.
pub(super) const DEFLATE: u64 = 1032;
/// Decoded chunks that are kept, in bytes, and their number.
const CHUNK_CACHE: usize = 16 << 20;
const CHUNKS: usize = 512;
/// Most files that external links of one file lead to.
const MAX_FILES: usize = 4096;
/// Groups and arrays that are listed or opened until the file is opened anew: the crate keeps 2 to 6 kB of each as long as it is open.
const MAX_OPENED: usize = if cfg!(test) { 4 } else { 50_000 };
/// Views that are open at a time: what the crate keeps of a few stays in the processor's cache.
const MAX_VIEWS: usize = 8;
/// Decoded chunks that are kept for each view.
const CHUNKS_OF_VIEW: usize = 64;

/// A file as the crate has opened it.
#[derive(Clone)]
pub(super) struct OpenFile {
    pub source: Arc<Source>,
    pub file: Hdf5File,
    storage: Arc<HeapStorage>,
    pub views: Arc<Views>,
}

/// A file, which is the first, and those that links led to.
#[derive(Default)]
pub(super) struct Files {
    open: Mutex<Vec<OpenFile>>,
    /// Number of times that a link was followed.
    pub followed: AtomicUsize,
}

impl Files {
    pub fn open(&self) -> MutexGuard<'_, Vec<OpenFile>> {
        self.open.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// A file and those that its links lead to.
pub(super) struct File {
    pub source: Arc<Source>,
    pub files: Arc<Files>,
    opened: Mutex<ObjectCache>,
}

/// Objects that were opened since the file was.
#[derive(Default)]
pub(super) struct ObjectCache {
    /// Groups by their paths; empty for the root.
    pub groups: HashMap<String, Group>,
    /// Paths of groups among many, with their identities, which stay when the files are opened anew.
    pub among_many: HashMap<String, (usize, u64)>,
    /// Files as they were opened for one of these each.
    pub views: Vec<OpenFile>,
    /// Number of groups and arrays that were listed or opened.
    pub count: usize,
    /// Most that were listed together: the file is not opened anew before each of them was looked at.
    pub listed: usize,
}

/// External links of the files of one folder.
struct Links {
    by: PathBuf,
    files: Weak<Files>,
}

impl hdf5_reader::ExternalLinkResolver for Links {
    fn resolve_external_link(&self, name: &str) -> hdf5_reader::error::Result<Option<Hdf5File>> {
        let failed = |error: Error| hdf5_reader::error::Error::Other(error.to_string());
        let Some(files) = self.files.upgrade() else { return Ok(None) };
        files.followed.fetch_add(1, Ordering::Relaxed);
        let path = beside(&self.by, name);
        let known = files.open().iter().find(|open| open.source.path() == path).cloned();
        if let Some(open) = known {
            return Ok(Some(open.file));
        }
        let count = files.open().len();
        if count > MAX_FILES {
            return Err(failed(Error::run("the external links lead to too many files")));
        }
        let named = |error: Error| failed(Error::run("an external link cannot be followed").got(error));
        let source = open_named(&self.by, &path, count).map_err(named)?;
        let open = OpenFile::open(source, &files).map_err(named)?;
        files.open().push(open.clone());
        Ok(Some(open.file))
    }
}

impl OpenFile {
    fn open(source: Arc<Source>, files: &Arc<Files>) -> Result<OpenFile> {
        let open = |storage: Arc<HeapStorage>| {
            let file = OpenFile::of_storage(&source, storage.clone(), CHUNKS, files)?;
            Ok(OpenFile { source: source.clone(), file, storage, views: Arc::default() })
        };
        HeapStorage::new(source.clone())
            .and_then(|storage| open(Arc::new(storage)))
            .map_err(|error| damaged("/", &error))
    }

    /// Opens a file by its bytes with limits that follow from its length.
    fn of_storage(
        source: &Source,
        storage: Arc<dyn Storage>,
        chunks: usize,
        files: &Arc<Files>,
    ) -> hdf5_reader::error::Result<Hdf5File> {
        let limit = usize::try_from(source.len().saturating_mul(DEFLATE)).unwrap_or(usize::MAX);
        let links = Links { by: source.path().to_owned(), files: Arc::downgrade(files) };
        let options = OpenOptions::default()
            .with_max_chunk_bytes(limit)
            .with_max_read_bytes(limit)
            .with_max_object_header_bytes(usize::try_from(source.len()).unwrap_or(usize::MAX))
            .with_chunk_cache_bytes(CHUNK_CACHE)
            .with_chunk_cache_slots(chunks)
            .with_external_link_resolver(Arc::new(links));
        Hdf5File::from_storage_with_options(storage, options)
    }

    fn number(&self) -> usize {
        Arc::as_ptr(&self.source).addr()
    }
}

impl File {
    pub fn open(source: Arc<Source>) -> Result<Arc<File>> {
        let files = Arc::<Files>::default();
        let open = OpenFile::open(source.clone(), &files)?;
        files.open().push(open);
        Ok(Arc::new(File { source, files, opened: Mutex::default() }))
    }

    /// The error about an object, or about a virtual dataset in it.
    pub fn damaged(&self, path: &str, error: &hdf5_reader::error::Error) -> Error {
        // Where links led to other files, that of the object is not known.
        let files = self.files.open();
        let only = (files.len() == 1).then(|| files[0].file.storage());
        hdf5_virtual::refusal(only, path, error).unwrap_or_else(|| damaged(path, error))
    }

    /// Nothing, where an error says that there is no such thing.
    pub fn optional<T>(&self, path: &str, found: hdf5_reader::error::Result<T>) -> Result<Option<T>> {
        use hdf5_reader::error::Error as Failure;
        match found {
            Ok(found) => Ok(Some(found)),
            Err(Failure::GroupNotFound(_) | Failure::DatasetNotFound(_) | Failure::AttributeNotFound(_)) => {
                Ok(None)
            }
            Err(error) => Err(self.damaged(path, &error)),
        }
    }

    /// Cache of opened objects; opens all files anew where the crate keeps many.
    pub fn opened(&self) -> Result<MutexGuard<'_, ObjectCache>> {
        let mut opened = self.opened.lock().unwrap_or_else(PoisonError::into_inner);
        if opened.count > MAX_OPENED + opened.listed {
            for open in self.files.open().iter_mut() {
                let file = OpenFile::of_storage(&open.source, open.storage.clone(), CHUNKS, &self.files);
                open.file = file.map_err(|error| damaged("/", &error))?;
            }
            let among_many = std::mem::take(&mut opened.among_many);
            *opened = ObjectCache { among_many, ..ObjectCache::default() };
        }
        Ok(opened)
    }

    /// The file, or the view of it, whose bytes these are.
    pub fn owner(&self, opened: &ObjectCache, storage: &dyn Storage) -> Option<OpenFile> {
        let files = self.files.open();
        let mut all = files.iter().chain(opened.views.iter().rev());
        all.find(|open| std::ptr::addr_eq(open.file.storage(), storage)).cloned()
    }

    pub fn numbered(&self, number: usize) -> Option<OpenFile> {
        self.files.open().iter().find(|open| open.number() == number).cloned()
    }

    /// A number of a group's file and its address there, the same by whatever path.
    pub fn identity(&self, opened: &ObjectCache, group: &Group) -> (usize, u64) {
        let owner = self.owner(opened, group.storage());
        (owner.map_or(0, |open| open.number()), group.address())
    }

    /// A group as it is in its file: the root of a view links to one group more.
    pub fn whole(&self, opened: &ObjectCache, group: Group) -> Group {
        let (number, address) = self.identity(opened, &group);
        let root = self.numbered(number).and_then(|open| open.file.root_group().ok());
        root.filter(|root| root.address() == address).unwrap_or(group)
    }

    /// The group at a path that was found before; as deep in calls as the path, of which there is a limit.
    pub fn group(&self, opened: &mut ObjectCache, path: &str) -> Result<Group> {
        if let Some(group) = opened.groups.get(path) {
            return Ok(group.clone());
        }
        let group = match (self.in_view(opened, path).transpose(), path.rsplit_once('/')) {
            (Some(group), _) => group,
            (None, Some((above, name))) => self.group(opened, above)?.group(name),
            (None, None) => self.files.open()[0].file.clone().root_group(),
        };
        let group = self.whole(opened, group.map_err(|error| damaged(path, &error))?);
        opened.count += 1;
        opened.groups.insert(path.to_owned(), group.clone());
        Ok(group)
    }

    /// The group among many at a path, in a view of its file; `None` for others, and where the file has no views.
    fn in_view(&self, opened: &mut ObjectCache, path: &str) -> hdf5_reader::error::Result<Option<Group>> {
        let Some(&(number, address)) = opened.among_many.get(path) else { return Ok(None) };
        let Some(open) = self.numbered(number) else { return Ok(None) };
        let links = || {
            let before = self.files.followed.load(Ordering::Relaxed);
            let links = open.file.root_group().ok().and_then(|root| hdf5_views::links(&root));
            // A view has no links of the root to other files.
            links.filter(|_| self.files.followed.load(Ordering::Relaxed) == before)
        };
        let view = open.views.view(&open.storage, open.file.superblock(), address, links);
        let Some(view) = view else { return Ok(None) };
        if opened.views.len() == MAX_VIEWS {
            (opened.views, opened.groups) = Default::default();
        }
        let file = OpenFile::of_storage(&open.source, view, CHUNKS_OF_VIEW, &self.files)?;
        let group = file.root_group()?.group(hdf5_views::LINK)?;
        opened.views.push(OpenFile { file, ..open });
        Ok(Some(group))
    }
}

/// Registered filters that the crate does not have, by their numbers (The HDF Group, "Registered Filter Plugins").
const FILTERS: [(&str, &str); 7] = [
    ("32000", "LZF"),
    ("32001", "Blosc"),
    ("32004", "LZ4"),
    ("32008", "Bitshuffle"),
    ("32013", "ZFP"),
    ("32015", "Zstandard"),
    ("32026", "Blosc2"),
];

pub(super) fn damaged(path: &str, mut error: &hdf5_reader::error::Error) -> Error {
    use hdf5_reader::error::Error as Failure;
    let failed = Error::run("the HDF5 object cannot be read").got(error).at_item(path);
    while let Failure::Context { source, .. } = error {
        error = source;
    }
    let Failure::UnsupportedFilter(filter) = error else { return failed };
    let name = FILTERS.iter().find(|known| filter.ends_with(known.0)).map_or("unknown", |known| known.1);
    failed.got(format_args!("{filter} ({name})")).expected(
        "gzip, shuffle, Fletcher-32, szip, n-bit or scale-offset: `h5repack -f GZIP=4 FILE NEW` packs it so where HDF5 has the filter",
    )
}

#[cfg(test)]
mod tests {
    use super::super::hdf5::Group;
    use super::*;
    use std::io::Read;
    use std::path::Path;

    fn unpacked(packed: &[u8]) -> Vec<u8> {
        let mut bytes = Vec::new();
        flate2::read::GzDecoder::new(packed).read_to_end(&mut bytes).unwrap();
        bytes
    }

    fn root(folder: &Path, name: &str, bytes: &[u8]) -> Group {
        let path = folder.join(name);
        std::fs::write(&path, bytes).unwrap();
        Group::root(Source::open(&path).unwrap()).unwrap()
    }

    const LINKED: &[u8] = include_bytes!("../tests/files/vtkhdf_linked.vtkhdf.gz");
    const BLOCKS: [(&str, &[u8]); 2] = [
        ("rotor", include_bytes!("../tests/files/vtkhdf_linked_rotor.vtkhdf.gz")),
        ("casing", include_bytes!("../tests/files/vtkhdf_linked_casing.vtkhdf.gz")),
    ];
    const NESTED: &[u8] = include_bytes!("../tests/files/vtkhdf_bad_tree.vtkhdf.gz");
    const ARRAYS: &[u8] = include_bytes!("../tests/files/chunks.h5.gz");

    /// Paths and numbers of the arrays of a block.
    fn arrays(block: &Group) -> Vec<(String, Vec<f64>)> {
        let groups = [block.clone(), block.required_group("PointData").unwrap()];
        let arrays = groups.iter().flat_map(|group| group.arrays().unwrap());
        arrays.map(|array| (array.name().to_owned(), array.numbers().unwrap())).collect()
    }

    #[test]
    fn threads_read_linked_files_that_are_opened_anew_again_and_again() {
        const USER_BLOCK: usize = 512;
        let [plain, shifted] = [(); 2].map(|()| tempfile::tempdir().unwrap());
        let truth = BLOCKS.map(|(name, packed)| {
            let (file, mut bytes) = (format!("vtkhdf_linked_{name}.vtkhdf"), unpacked(packed));
            let truth = arrays(&root(plain.path(), &file, &bytes).required_group("VTKHDF").unwrap());
            // The same behind bytes that belong to others; the address of its beginning stands in the superblock of version 0.
            bytes[24..32].copy_from_slice(&(USER_BLOCK as u64).to_le_bytes());
            std::fs::write(shifted.path().join(file), [&[7; USER_BLOCK][..], &bytes].concat()).unwrap();
            truth
        });
        assert_eq!(truth.each_ref().map(Vec::len), [9; 2]);
        let root = root(shifted.path(), "linked.vtkhdf", &unpacked(LINKED));
        std::thread::scope(|scope| {
            for _ in 0..4 {
                scope.spawn(|| {
                    for ((name, _), truth) in BLOCKS.iter().zip(&truth) {
                        let tree = root.required_group("VTKHDF").unwrap();
                        assert_eq!(&arrays(&tree.required_group(name).unwrap()), truth);
                    }
                });
            }
        });
    }

    #[test]
    fn groups_in_one_another_are_followed_to_a_limit() {
        let folder = tempfile::tempdir().unwrap();
        let mut group = root(folder.path(), "nested.h5", &unpacked(NESTED)).required_group("VTKHDF").unwrap();
        group = group.required_group("Assembly").unwrap();
        let refused = ["a", "b"].into_iter().cycle().take(200).try_for_each(|name| {
            group = group.required_group(name)?;
            Ok::<(), Error>(())
        });
        let error = refused.unwrap_err().to_string();
        assert!(error.contains("too deep") && error.contains("at most 128"), "{error}");
        assert!(group.path().ends_with("/b/a/b"), "{}", group.path());
    }

    #[test]
    fn names_that_are_paths_or_there_twice_are_damaged() {
        let folder = tempfile::tempdir().unwrap();
        for name in [b"r/ws", b"line"] {
            let mut bytes = unpacked(ARRAYS);
            let place = bytes.windows(6).position(|own| own == b"\0rows\0").unwrap();
            bytes[place + 1..place + 5].copy_from_slice(name);
            let root = root(folder.path(), "names.h5", &bytes);
            for error in [root.groups().err(), root.arrays().err(), root.names().err()] {
                let error = error.unwrap().to_string();
                assert!(error.contains(std::str::from_utf8(name).unwrap()), "{error}");
            }
        }
    }
}
