//! HDF5: groups, attributes and arrays of a file, for the formats that lie in it.
//!
//! An array that lies in one part becomes [`Encoding::Bytes`] and is read in parallel straight from the file; chunks
//! (deflate, shuffle) are decoded when the array is asked for. External links are followed beside the file that names them.
//! Source: HDF5 File Format Specification 3.0 (The HDF Group), read by the crate hdf5-reader. Limits are set before anything
//! is read: a chunk or an array may be no larger than deflate can make of the whole file.

use super::contents::{Encoding, Gather, Stored};
use super::hdf5_chunks::ChunkRows;
pub(super) use super::hdf5_chunks::Extent;
use super::hdf5_heaps::HeapStorage;
use super::numbers::{ByteOrder, NumberType};
use super::source::Source;
use super::xml::{beside, open_named};
use hdf5_reader::messages::{HdfMessage, layout::DataLayout};
use hdf5_reader::{
    Datatype, Hdf5File, OpenOptions, SliceInfo, SliceInfoElem, Storage, StringSize, VarLenKind,
};
use std::ops::Range;
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};
use voltet_core::{Error, Result};

/// Most bytes that deflate makes of one.
const DEFLATE: u64 = 1032;
/// Decoded chunks that are kept, in bytes.
const CHUNK_CACHE: usize = 16 << 20;
/// Most files that external links of one file lead to.
const MAX_FILES: usize = 4096;
/// Most groups in one that are found by their names.
const FEW_GROUPS: usize = 16;

/// Files that links led to.
#[derive(Default)]
struct LinkedFiles {
    files: Mutex<Vec<(Arc<Source>, Hdf5File)>>,
    /// Number of times that a link was followed.
    followed: AtomicUsize,
}

impl LinkedFiles {
    fn files(&self) -> MutexGuard<'_, Vec<(Arc<Source>, Hdf5File)>> {
        self.files.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// An open file and those that its links lead to.
pub(super) struct File {
    source: Arc<Source>,
    file: Hdf5File,
    linked: Arc<LinkedFiles>,
}

/// External links of the files of one folder.
struct Links {
    by: PathBuf,
    linked: Weak<LinkedFiles>,
}

impl hdf5_reader::ExternalLinkResolver for Links {
    fn resolve_external_link(&self, name: &str) -> hdf5_reader::error::Result<Option<Hdf5File>> {
        let failed = |error: Error| hdf5_reader::error::Error::Other(error.to_string());
        let Some(linked) = self.linked.upgrade() else { return Ok(None) };
        linked.followed.fetch_add(1, Ordering::Relaxed);
        let path = beside(&self.by, name);
        let known = linked.files().iter().find(|(source, _)| source.path() == path).cloned();
        if let Some((_, file)) = known {
            return Ok(Some(file));
        }
        let count = linked.files().len();
        if count >= MAX_FILES {
            return Err(failed(Error::run("the external links lead to too many files")));
        }
        let named = |error: Error| failed(Error::run("an external link cannot be followed").got(error));
        let source = open_named(&self.by, &path, count).map_err(named)?;
        let file = open_file(&source, &linked).map_err(named)?;
        linked.files().push((source, file.clone()));
        Ok(Some(file))
    }
}

/// Opens a file with limits that follow from its length.
fn open_file(source: &Arc<Source>, linked: &Arc<LinkedFiles>) -> Result<Hdf5File> {
    let limit = usize::try_from(source.len().saturating_mul(DEFLATE)).unwrap_or(usize::MAX);
    let links = Links { by: source.path().to_owned(), linked: Arc::downgrade(linked) };
    let options = OpenOptions::default()
        .with_max_chunk_bytes(limit)
        .with_max_read_bytes(limit)
        .with_max_object_header_bytes(usize::try_from(source.len()).unwrap_or(usize::MAX))
        .with_chunk_cache_bytes(CHUNK_CACHE)
        .with_external_link_resolver(Arc::new(links));
    HeapStorage::new(source.clone())
        .and_then(|storage| Hdf5File::from_storage_with_options(Arc::new(storage), options))
        .map_err(|error| damaged("/", &error))
}

/// The error about an object.
fn damaged(path: &str, error: &hdf5_reader::error::Error) -> Error {
    Error::run("the HDF5 object cannot be read").got(error).at_item(path)
}

/// Nothing, where an error says that there is no such thing.
fn optional<T>(path: &str, found: hdf5_reader::error::Result<T>) -> Result<Option<T>> {
    use hdf5_reader::error::Error as Failure;
    match found {
        Ok(found) => Ok(Some(found)),
        Err(Failure::GroupNotFound(_) | Failure::DatasetNotFound(_) | Failure::AttributeNotFound(_)) => {
            Ok(None)
        }
        Err(error) => Err(damaged(path, &error)),
    }
}

impl File {
    /// Opens a file.
    pub fn open(source: Arc<Source>) -> Result<Arc<File>> {
        let linked = Arc::<LinkedFiles>::default();
        let file = open_file(&source, &linked)?;
        Ok(Arc::new(File { source, file, linked }))
    }

    /// The root group.
    pub fn root(self: &Arc<File>) -> Result<Group> {
        let group = self.file.root_group().map_err(|error| damaged("/", &error))?;
        Ok(Group { file: self.clone(), group, path: String::new() })
    }

    /// The file whose bytes these are: this one, or one that links lead to.
    fn owner(&self, storage: &dyn Storage) -> Option<(Arc<Source>, Hdf5File)> {
        let is_same = |file: &Hdf5File| std::ptr::addr_eq(file.storage(), storage);
        if is_same(&self.file) {
            return Some((self.source.clone(), self.file.clone()));
        }
        self.linked.files().iter().find(|(_, file)| is_same(file)).cloned()
    }
}

/// A group of a file.
#[derive(Clone)]
pub(super) struct Group {
    file: Arc<File>,
    group: hdf5_reader::group::Group,
    /// Path in the file, empty for the root.
    path: String,
}

impl Group {
    /// Path from the root, for messages.
    pub fn path(&self) -> &str {
        if self.path.is_empty() { "/" } else { &self.path }
    }

    /// The file.
    pub fn source(&self) -> &Arc<Source> {
        &self.file.source
    }

    /// Bytes of the file and of those that its links led to.
    pub fn file_bytes(&self) -> u64 {
        let linked = self.file.linked.files();
        linked.iter().map(|(source, _)| source.len()).fold(self.file.source.len(), u64::saturating_add)
    }

    /// Files that links led to.
    pub fn linked_files(&self) -> Vec<PathBuf> {
        let linked = self.file.linked.files();
        linked.iter().map(|(source, _)| source.path().to_owned()).collect()
    }

    /// A number that is the same for the same group by whatever path.
    pub fn identity(&self) -> (usize, u64) {
        (std::ptr::from_ref(self.group.storage()).addr(), self.group.address())
    }

    fn below(&self, name: &str) -> String {
        format!("{}/{name}", self.path)
    }

    /// The group of that name, if there is one.
    pub fn group(&self, name: &str) -> Result<Option<Group>> {
        let path = self.below(name);
        let group = optional(&path, self.group.group(name))?;
        Ok(group.map(|group| Group { file: self.file.clone(), group, path }))
    }

    /// The group of that name. Errors: there is none.
    pub fn required_group(&self, name: &str) -> Result<Group> {
        self.group(name)?.ok_or_else(|| self.lacks("group", name))
    }

    /// The groups in this one, in the order of their names or of their making, whichever the file keeps.
    pub fn groups(&self) -> Result<Vec<Group>> {
        let (names, _) = self.group.member_names().map_err(|error| damaged(self.path(), &error))?;
        // Many are opened together: finding one by name costs as much as listing a few hundred. This opens the arrays too, some of which
        // may be of types that are not read.
        if names.len() > FEW_GROUPS
            && let Ok(groups) = self.group.groups()
        {
            let named = |group: hdf5_reader::group::Group| {
                let path = self.below(group.name());
                Group { file: self.file.clone(), group, path }
            };
            return Ok(groups.into_iter().map(named).collect());
        }
        names.iter().map(|name| self.required_group(name)).collect()
    }

    /// The arrays in this group.
    pub fn arrays(&self) -> Result<Vec<Array>> {
        let (_, names) = self.group.member_names().map_err(|error| damaged(self.path(), &error))?;
        names.iter().map(|name| self.required_array(name)).collect()
    }

    /// The name of this group in that above it.
    pub fn name(&self) -> &str {
        self.path.rsplit('/').next().unwrap_or("")
    }

    /// The names of groups and arrays.
    pub fn names(&self) -> Result<Vec<String>> {
        let names = self.group.member_names().map_err(|error| damaged(self.path(), &error))?;
        Ok(names.0.into_iter().chain(names.1).collect())
    }

    /// The array of that name, if there is one.
    pub fn array(&self, name: &str) -> Result<Option<Array>> {
        let path = self.below(name);
        let followed = || self.file.linked.followed.load(Ordering::Relaxed);
        let before = followed();
        let Some(dataset) = optional(&path, self.group.dataset(name))? else { return Ok(None) };
        let owner = match followed() == before {
            true => self.file.owner(self.group.storage()),
            // An array that is itself linked lies in a file that is not known here.
            false => None,
        };
        let (source, len) = match &owner {
            Some((source, _)) => (source.clone(), source.len()),
            None => (self.file.source.clone(), self.file_bytes()),
        };
        let file = owner.map(|(_, file)| file);
        let place = file.as_ref().map(|file| place(file, &dataset)).transpose();
        let place = place.map_err(|error| damaged(&path, &error))?.flatten();
        Ok(Some(Array { source, file, len, dataset: Arc::new(dataset), place, path }))
    }

    /// The array of that name. Errors: there is none.
    pub fn required_array(&self, name: &str) -> Result<Array> {
        self.array(name)?.ok_or_else(|| self.lacks("dataset", name))
    }

    fn lacks(&self, what: &str, name: &str) -> Error {
        Error::run(format!("the file lacks the HDF5 {what} '{}'", self.below(name)))
    }

    /// An attribute of text, if there is one.
    pub fn text(&self, name: &str) -> Result<Option<String>> {
        let found = optional(self.path(), self.group.attribute(name))?;
        let text = found.map(|attribute| attribute.read_strings()).transpose();
        let text = text.map_err(|error| damaged(&self.below(name), &error))?;
        Ok(text.and_then(|texts| texts.into_iter().next()).map(|text| trimmed(&text)))
    }

    /// An attribute of numbers, if there is one.
    pub fn numbers(&self, name: &str) -> Result<Option<Vec<f64>>> {
        let Some(attribute) = optional(self.path(), self.group.attribute(name))? else { return Ok(None) };
        let (number_type, order) = number_type(&attribute.datatype).ok_or_else(|| {
            Error::run("an HDF5 attribute is of the wrong type").expected("numbers").at_item(self.below(name))
        })?;
        let size = number_type.size().unwrap_or(1);
        let mut values = vec![0.0; attribute.raw_data.len() / size];
        // Every number is a 64-bit float, if rounded.
        let _ = super::numbers::convert(number_type, order, &attribute.raw_data, &mut values);
        Ok(Some(values))
    }

    /// An attribute of so many numbers, or what stands in for it.
    pub fn vector<const N: usize>(&self, name: &str, otherwise: Option<[f64; N]>) -> Result<[f64; N]> {
        let wrong = |found: usize| {
            let error = Error::run("an HDF5 attribute has the wrong length").got(found).expected(N);
            error.at_item(self.below(name))
        };
        match (self.numbers(name)?, otherwise) {
            (Some(numbers), _) => numbers.try_into().map_err(|numbers: Vec<f64>| wrong(numbers.len())),
            (None, Some(otherwise)) => Ok(otherwise),
            (None, None) => {
                Err(Error::run(format!("the file lacks the HDF5 attribute '{}'", self.below(name))))
            }
        }
    }
}

/// Text without the padding that writers put after it.
fn trimmed(text: &str) -> String {
    text.trim_end_matches('\0').trim().to_owned()
}

/// Type and order of numbers; `None` for text, references and records.
fn number_type(datatype: &Datatype) -> Option<(NumberType, ByteOrder)> {
    use NumberType::{F32, F64, I8, I16, I32, I64, U8, U16, U32, U64};
    let order = |order: hdf5_reader::ByteOrder| match order {
        hdf5_reader::ByteOrder::LittleEndian => ByteOrder::Little,
        hdf5_reader::ByteOrder::BigEndian => ByteOrder::Big,
    };
    match datatype {
        Datatype::FixedPoint { size, signed, byte_order } => {
            let types = if *signed { [I8, I16, I32, I64] } else { [U8, U16, U32, U64] };
            let index = [1, 2, 4, 8].iter().position(|known| known == size)?;
            Some((types[index], order(*byte_order)))
        }
        Datatype::FloatingPoint { size: 4, byte_order } => Some((F32, order(*byte_order))),
        Datatype::FloatingPoint { size: 8, byte_order } => Some((F64, order(*byte_order))),
        Datatype::Enum { base, .. } => number_type(base),
        _ => None,
    }
}

/// Place of the bytes in the file, of an array that lies there in one part.
fn place(file: &Hdf5File, dataset: &hdf5_reader::Dataset) -> hdf5_reader::error::Result<Option<u64>> {
    let header = file.get_or_parse_header(dataset.address())?;
    let address = header.messages.iter().find_map(|message| match message {
        HdfMessage::DataLayout(layout) => match layout.layout {
            DataLayout::Contiguous { address, .. } => Some(address),
            _ => None,
        },
        _ => None,
    });
    let is_external = header.messages.iter().any(|message| matches!(message, HdfMessage::ExternalFiles(_)));
    // An address of all ones means that nothing was written.
    let address = address.filter(|address| !is_external && *address < file.storage().len());
    Ok(address.and_then(|address| address.checked_add(file.superblock().base_address)))
}

/// An array (a dataset, in the words of HDF5) of a file.
#[derive(Clone)]
pub(super) struct Array {
    source: Arc<Source>,
    /// The file that it lies in, if that is known.
    file: Option<Hdf5File>,
    /// Most bytes of the file, or of the files, that it can lie in.
    len: u64,
    dataset: Arc<hdf5_reader::Dataset>,
    /// Beginning of its bytes, where they lie side by side.
    place: Option<u64>,
    path: String,
}

/// Bytes of a number, in the order of the file.
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(transparent)]
struct Bytes<const N: usize>([u8; N]);

impl<const N: usize> hdf5_reader::H5Type for Bytes<N> {
    fn hdf5_type() -> Datatype {
        Datatype::Opaque { size: N as u32, tag: String::new() }
    }

    fn from_bytes(bytes: &[u8], _: &Datatype) -> hdf5_reader::error::Result<Self> {
        bytes.first_chunk().copied().map(Bytes).ok_or_else(|| {
            hdf5_reader::error::Error::InvalidData(format!("expected {N} bytes, got {}", bytes.len()))
        })
    }

    fn element_size(_: &Datatype) -> usize {
        N
    }

    fn decode_vec(raw: &[u8], _: &Datatype, count: usize) -> Option<hdf5_reader::error::Result<Vec<Self>>> {
        let raw = raw.get(..count.checked_mul(N)?)?;
        Some(Ok(raw.as_chunks::<N>().0.iter().copied().map(Bytes).collect()))
    }

    fn native_copy_compatible(datatype: &Datatype) -> bool {
        hdf5_reader::dtype_element_size(datatype).is_ok_and(|size| size == N)
    }
}

impl Array {
    /// Name in its group.
    pub fn name(&self) -> &str {
        self.path.rsplit('/').next().unwrap_or("")
    }

    /// Path from the root of its file.
    pub fn path(&self) -> &str {
        &self.path
    }

    /// Numbers along each axis; empty for a single number.
    pub fn shape(&self) -> &[u64] {
        self.dataset.shape()
    }

    /// True if it holds text.
    pub fn is_text(&self) -> bool {
        matches!(
            self.dataset.dtype(),
            Datatype::String { .. } | Datatype::VarLen { kind: VarLenKind::String, .. }
        )
    }

    /// True if it holds numbers of a type that is read.
    pub fn has_numbers(&self) -> bool {
        number_type(self.dataset.dtype()).is_some()
    }

    /// An attribute of text, if there is one. Errors: it is damaged, or no text.
    pub fn text_attribute(&self, name: &str) -> Result<Option<String>> {
        let found = optional(&self.path, self.dataset.attribute(name))?;
        let text = found.map(|attribute| attribute.read_strings()).transpose();
        let text = text.map_err(|error| damaged(&format!("{}/{name}", self.path), &error))?;
        Ok(text.and_then(|texts| texts.into_iter().next()).map(|text| trimmed(&text)))
    }

    fn wrong(&self, what: &str) -> Error {
        Error::run(what).at_item(&self.path)
    }

    /// All of it as an array of tuples.
    pub fn stored(&self, name: &str, component_count: usize) -> Result<Stored> {
        let all: Vec<Extent> = self.shape().iter().map(|&n| (0, n, 1)).collect();
        self.part(name, &all, component_count)
    }

    /// Rows (numbers along the first axis) as an array of tuples.
    pub fn rows(&self, name: &str, rows: Range<u64>, component_count: usize) -> Result<Stored> {
        let mut part: Vec<Extent> = self.shape().iter().map(|&n| (0, n, 1)).collect();
        let first = part.first_mut().ok_or_else(|| self.wrong("the dataset is a single number"))?;
        *first = (rows.start, rows.end.saturating_sub(rows.start), 1);
        self.part(name, &part, component_count)
    }

    /// A box of it as an array of tuples.
    pub fn part(&self, name: &str, part: &[Extent], component_count: usize) -> Result<Stored> {
        let shape = self.shape();
        let fits = |(&(first, count, stride), &n): (&Extent, &u64)| {
            let last = count.checked_sub(1).and_then(|steps| steps.checked_mul(stride)?.checked_add(first));
            stride > 0 && last.is_none_or(|last| last < n) && (count == 0 || last.is_some())
        };
        if part.len() != shape.len() || !part.iter().zip(shape).all(fits) {
            let ends: Vec<u64> = part.iter().map(|axis| axis.0.saturating_add(axis.1)).collect();
            return Err(self
                .wrong("the dataset is too small")
                .got(format_args!("{shape:?}"))
                .expected(format_args!("at least {ends:?}")));
        }
        let count = part.iter().try_fold(1_u64, |product, axis| product.checked_mul(axis.1));
        let count = count.ok_or_else(|| self.wrong("the dataset cannot be that large"))?;
        if component_count == 0 || !count.is_multiple_of(component_count as u64) {
            let error = self.wrong("the dataset has the wrong number of values").got(count);
            return Err(error.expected(format_args!("a multiple of {component_count}")));
        }
        let (number_type, order) = number_type(self.dataset.dtype()).ok_or_else(|| {
            self.wrong("the dataset is of the wrong type")
                .expected("whole numbers of 8 to 64 bits, or floats of 32 or 64")
        })?;
        let encoding = match self.place.zip(offset(shape, part)) {
            Some((place, offset)) => {
                let bytes = number_type.byte_count(offset).and_then(|bytes| bytes.checked_add(place));
                Encoding::Bytes(bytes.ok_or_else(|| self.wrong("the dataset lies beyond the file"))?)
            }
            None => {
                let gather = self.gather(part, number_type, count)?;
                match self.file.clone().zip(number_type.size()) {
                    Some((file, size)) => {
                        let (dataset, part) = (self.dataset.clone(), part.to_vec());
                        Encoding::Chunked(
                            Arc::new(move || ChunkRows::find(&file, &dataset, &part, size)),
                            gather,
                        )
                    }
                    None => Encoding::Gathered(gather),
                }
            }
        };
        Ok(Stored {
            source: self.source.clone(),
            name: name.to_owned(),
            number_type,
            order,
            component_count,
            tuple_count: Some(count / component_count as u64),
            encoding,
        })
    }

    /// Reads a box of chunks.
    fn gather(&self, part: &[Extent], number_type: NumberType, count: u64) -> Result<Gather> {
        let bytes = number_type.byte_count(count).unwrap_or(u64::MAX);
        if bytes > self.len.saturating_mul(DEFLATE) {
            let error =
                self.wrong("the dataset is larger than the file can hold").got(format_args!("{bytes} bytes"));
            return Err(error.expected(format_args!("what {} bytes become at most", self.len)));
        }
        let slice = |&(first, count, stride): &Extent| SliceInfoElem::Slice {
            start: first,
            end: if count == 0 { first } else { first + (count - 1) * stride + 1 },
            step: stride,
        };
        let (array, selection) = (self.clone(), SliceInfo { selections: part.iter().map(slice).collect() });
        Ok(Arc::new(move || {
            let read = match number_type.size() {
                Some(1) => array.bytes::<1>(&selection),
                Some(2) => array.bytes::<2>(&selection),
                Some(4) => array.bytes::<4>(&selection),
                _ => array.bytes::<8>(&selection),
            };
            read.map_err(|error| damaged(&array.path, &error))
        }))
    }

    fn bytes<const N: usize>(&self, selection: &SliceInfo) -> hdf5_reader::error::Result<Vec<u8>> {
        let values = self.dataset.read_slice_parallel::<Bytes<N>>(selection)?;
        if !values.is_standard_layout() {
            return Ok(values.iter().flat_map(|value| value.0).collect());
        }
        let (values, first) = values.into_raw_vec_and_offset();
        let mut bytes: Vec<u8> = bytemuck::cast_vec(values);
        bytes.drain(..first.unwrap_or(0) * N);
        Ok(bytes)
    }

    /// All numbers of a small array.
    pub fn numbers<T: super::numbers::Target>(&self) -> Result<Vec<T>> {
        let meter = super::contents::Meter::new(&voltet_core::progress::NoProgress, 1);
        self.stored(&self.path, 1)?.load(&meter)
    }

    /// True if it holds single bytes of text, as netCDF writes characters.
    fn has_letters(&self) -> bool {
        matches!(self.dataset.dtype(), Datatype::String { size: StringSize::Fixed(1), .. })
    }

    /// Texts: those of an array of texts, or the rows of one of characters, each up to its first empty one.
    pub fn rows_of_text(&self) -> Result<Vec<String>> {
        if self.is_text() && !self.has_letters() {
            let texts = self.dataset.read_strings().map_err(|error| damaged(&self.path, &error))?;
            return Ok(texts.iter().map(|text| trimmed(text)).collect());
        }
        let len = self.shape().last().map_or(1, |&len| len.max(1) as usize);
        Ok(self.letters()?.chunks(len).map(super::netcdf::text).collect())
    }

    /// The text of an array of texts, or of single characters.
    pub fn text(&self) -> Result<String> {
        if self.is_text() && !self.has_letters() {
            let texts = self.dataset.read_strings().map_err(|error| damaged(&self.path, &error))?;
            return Ok(trimmed(&texts.concat()));
        }
        Ok(trimmed(&String::from_utf8_lossy(&self.letters()?)))
    }

    /// Bytes of text, one for each number or character, whatever its sign.
    pub fn letters(&self) -> Result<Vec<u8>> {
        if !self.has_letters() {
            return Ok(self.numbers::<i64>()?.into_iter().map(|letter| letter as u8).collect());
        }
        let all: Vec<Extent> = self.shape().iter().map(|&n| (0, n, 1)).collect();
        let count = all.iter().try_fold(1_u64, |product, axis| product.checked_mul(axis.1));
        let count = count.ok_or_else(|| self.wrong("the dataset cannot be that large"))?;
        (self.gather(&all, NumberType::U8, count)?)()
    }
}

/// Place of the first number of a box whose numbers lie side by side in the array; `None` where they do not.
fn offset(shape: &[u64], part: &[Extent]) -> Option<u64> {
    let whole_after = part.iter().zip(shape).rposition(|(axis, &n)| axis.1 != n).unwrap_or(0);
    let is_row = |(index, &(_, count, stride)): (usize, &Extent)| {
        if index < whole_after { count == 1 } else { stride == 1 || count <= 1 }
    };
    if !part.iter().enumerate().all(is_row) {
        return None;
    }
    let place = |offset: u64, (axis, &n): (&Extent, &u64)| offset.checked_mul(n)?.checked_add(axis.0);
    part.iter().zip(shape).try_fold(0, place)
}
