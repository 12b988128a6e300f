//! HDF5: groups, attributes and arrays of a file, for the formats that lie in it.
//!
//! An array that lies in one part becomes [`Encoding::Bytes`] and is read in parallel straight from the file; chunks
//! (deflate, shuffle) are decoded when the array is asked for. External links are followed beside the file that names them.
//! Source: HDF5 File Format Specification 3.0 (The HDF Group), read by the crate hdf5-reader. Limits are set before anything
//! is read: a chunk or an array may be no larger than deflate can make of the whole file.

use super::contents::{Encoding, Gather, Stored};
use super::hdf5_chunks::ChunkRows;
pub(super) use super::hdf5_chunks::Extent;
use super::hdf5_files::{DEFLATE, File, ObjectCache, damaged};
use super::numbers::{ByteOrder, NumberType};
use super::source::Source;
use hdf5_reader::messages::{HdfMessage, layout::DataLayout};
use hdf5_reader::{Datatype, Hdf5File, SliceInfo, SliceInfoElem, StringSize, VarLenKind};
use std::collections::HashSet;
use std::ops::Range;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use voltet_core::{Error, Result};

/// Most groups in one that are found by their names.
const FEW_GROUPS: usize = 16;
/// Most groups in one that are found by their names again when the file was opened anew.
const MANY_GROUPS: usize = if cfg!(test) { 16 } else { 4096 };
/// Most groups in one another.
const MAX_DEPTH: usize = 128;

#[derive(Clone)]
pub(super) struct Group {
    pub file: Arc<File>,
    /// Path in the file, empty for the root.
    path: String,
    /// Number of the file and address in it.
    identity: (usize, u64),
}

impl Group {
    pub fn root(source: Arc<Source>) -> Result<Group> {
        let file = File::open(source)?;
        let mut opened = file.opened()?;
        let root = file.group(&mut opened, "")?;
        let identity = file.identity(&opened, &root);
        drop(opened);
        Ok(Group { file, path: String::new(), identity })
    }

    /// A group in this one, or one that a link in it leads to. Errors: they stand too deep in one another.
    fn child(&self, opened: &mut ObjectCache, name: &str, group: hdf5_reader::group::Group) -> Result<Group> {
        let path = self.below(name);
        if path.matches('/').count() > MAX_DEPTH {
            let error = Error::run("the HDF5 groups stand too deep in one another").at_item(path);
            return Err(error.expected(format_args!("at most {MAX_DEPTH} steps")));
        }
        let identity = self.file.identity(opened, &group);
        let group = self.file.whole(opened, group);
        opened.groups.insert(path.clone(), group);
        Ok(Group { file: self.file.clone(), path, identity })
    }

    /// Path from the root, for messages.
    pub fn path(&self) -> &str {
        if self.path.is_empty() { "/" } else { &self.path }
    }

    pub fn source(&self) -> &Arc<Source> {
        &self.file.source
    }

    /// Bytes of the file and of those that its links led to.
    pub fn file_bytes(&self) -> u64 {
        self.file.files.open().iter().map(|open| open.source.len()).fold(0, u64::saturating_add)
    }

    /// Files that links led to.
    pub fn linked_files(&self) -> Vec<PathBuf> {
        self.file.files.open().iter().skip(1).map(|open| open.source.path().to_owned()).collect()
    }

    /// A number that is the same for the same group by whatever path.
    pub fn identity(&self) -> (usize, u64) {
        self.identity
    }

    fn below(&self, name: &str) -> String {
        format!("{}/{name}", self.path)
    }

    pub fn group(&self, name: &str) -> Result<Option<Group>> {
        let path = self.below(name);
        let mut opened = self.file.opened()?;
        let group = self.file.optional(&path, self.file.group(&mut opened, &self.path)?.group(name))?;
        opened.count += usize::from(group.is_some());
        group.map(|group| self.child(&mut opened, name, group)).transpose()
    }

    /// The group of that name. Errors: there is none.
    pub fn required_group(&self, name: &str) -> Result<Group> {
        self.group(name)?.ok_or_else(|| self.lacks("group", name))
    }

    /// The groups in this one, in the order of their names or of their making, whichever the file keeps.
    pub fn groups(&self) -> Result<Vec<Group>> {
        let mut opened = self.file.opened()?;
        let (names, arrays) = self.member_names(&mut opened)?;
        // Many are opened together: finding one by name costs as much as listing a few hundred. This opens the arrays too, some of which
        // may be of types that are not read.
        if names.len() > arrays.len().max(FEW_GROUPS)
            && let Ok(groups) = self.file.group(&mut opened, &self.path)?.groups()
        {
            let mut child = |group: hdf5_reader::group::Group| {
                let name = group.name().to_owned();
                self.child(&mut opened, &name, group)
            };
            let groups = groups.into_iter().map(&mut child).collect::<Result<Vec<Group>>>()?;
            if groups.len() > MANY_GROUPS
                && let Some(open) = self.file.numbered(self.identity.0)
            {
                open.views.list(self.identity.1);
                let by_path = groups.iter().map(|group| (group.path.clone(), group.identity));
                opened.among_many.extend(by_path);
            }
            return Ok(groups);
        }
        drop(opened);
        names.iter().map(|name| self.required_group(name)).collect()
    }

    pub fn arrays(&self) -> Result<Vec<Array>> {
        let names = self.member_names(&mut *self.file.opened()?)?.1;
        names.iter().map(|name| self.required_array(name)).collect()
    }

    pub fn name(&self) -> &str {
        self.path.rsplit('/').next().unwrap_or("")
    }

    pub fn names(&self) -> Result<Vec<String>> {
        let (groups, arrays) = self.member_names(&mut *self.file.opened()?)?;
        Ok(groups.into_iter().chain(arrays).collect())
    }

    /// The names of groups and of arrays. Errors: two are the same, or one is a path.
    fn member_names(&self, opened: &mut ObjectCache) -> Result<(Vec<String>, Vec<String>)> {
        let names = self.file.group(opened, &self.path)?.member_names();
        let (groups, arrays) = names.map_err(|error| self.file.damaged(self.path(), &error))?;
        let count = groups.len() + arrays.len();
        opened.count += count;
        opened.listed = opened.listed.max(count);
        let mut known = HashSet::new();
        match groups.iter().chain(&arrays).find(|name| name.contains('/') || !known.insert(*name)) {
            Some(name) => Err(Error::run("the names in an HDF5 group are damaged")
                .got(format_args!("'{name}'"))
                .expected("names without '/' that differ")
                .at_item(self.path())),
            None => Ok((groups, arrays)),
        }
    }

    fn attribute(&self, name: &str) -> Result<Option<hdf5_reader::Attribute>> {
        let group = self.file.group(&mut *self.file.opened()?, &self.path)?;
        self.file.optional(self.path(), group.attribute(name))
    }

    pub fn array(&self, name: &str) -> Result<Option<Array>> {
        let path = self.below(name);
        let mut opened = self.file.opened()?;
        let group = self.file.group(&mut opened, &self.path)?;
        let followed = || self.file.files.followed.load(Ordering::Relaxed);
        let before = followed();
        let Some(dataset) = self.file.optional(&path, group.dataset(name))? else { return Ok(None) };
        opened.count += 1;
        // An array that is itself linked lies in a file that is not known here.
        let owner = if followed() == before { self.file.owner(&opened, group.storage()) } else { None };
        let (source, len) = match &owner {
            Some(open) => (open.source.clone(), open.source.len()),
            None => (self.file.source.clone(), self.file_bytes()),
        };
        let file = owner.map(|open| open.file);
        let place = file.as_ref().map(|file| place(file, &dataset)).transpose();
        let place = place.map_err(|error| damaged(&path, &error))?.flatten();
        Ok(Some(Array { group: self.clone(), source, file, len, dataset, place, path }))
    }

    /// The array of that name. Errors: there is none.
    pub fn required_array(&self, name: &str) -> Result<Array> {
        self.array(name)?.ok_or_else(|| self.lacks("dataset", name))
    }

    fn lacks(&self, what: &str, name: &str) -> Error {
        Error::run(format!("the file lacks the HDF5 {what} '{}'", self.below(name)))
    }

    pub fn text(&self, name: &str) -> Result<Option<String>> {
        let text = self.attribute(name)?.map(|attribute| attribute.read_strings()).transpose();
        let text = text.map_err(|error| damaged(&self.below(name), &error))?;
        Ok(text.and_then(|texts| texts.into_iter().next()).map(|text| trimmed(&text)))
    }

    pub fn numbers(&self, name: &str) -> Result<Option<Vec<f64>>> {
        let Some(attribute) = self.attribute(name)? else { return Ok(None) };
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
    group: Group,
    source: Arc<Source>,
    /// The file that it lies in, if that is known.
    file: Option<Hdf5File>,
    /// Most bytes of the file, or of the files, that it can lie in.
    len: u64,
    dataset: hdf5_reader::Dataset,
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
        let found = self.group.file.optional(&self.path, self.dataset.attribute(name))?;
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
                match number_type.size().filter(|_| self.file.is_some()) {
                    Some(size) => {
                        let (reopen, part) = (self.reopen(), part.to_vec());
                        let find = move || {
                            let Array { file, dataset, .. } = reopen().ok()?;
                            ChunkRows::find(&file?, &dataset, &part, size)
                        };
                        Encoding::Chunked(Arc::new(find), gather)
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

    /// Opens it anew: an array that is read later keeps nothing of the file until then.
    fn reopen(&self) -> impl Fn() -> Result<Array> + Send + Sync + 'static {
        let (group, name) = (self.group.clone(), self.name().to_owned());
        move || group.required_array(&name)
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
        let (reopen, selection) = (self.reopen(), SliceInfo { selections: part.iter().map(slice).collect() });
        Ok(Arc::new(move || {
            let array = reopen()?;
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

#[cfg(test)]
mod tests {
    use super::super::contents::Meter;
    use super::*;
    use std::io::Read;
    use voltet_core::progress::NoProgress;

    /// Places that name the bytes of a file that is open once.
    const SOURCES: usize = 4;

    #[test]
    fn arrays_that_are_read_later_keep_nothing_of_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let file = |packed: &[u8], name: &str| {
            let (path, mut bytes) = (folder.path().join(name), Vec::new());
            flate2::read::GzDecoder::new(packed).read_to_end(&mut bytes).unwrap();
            std::fs::write(&path, bytes).unwrap();
            Group::root(Source::open(&path).unwrap()).unwrap()
        };
        let root = file(include_bytes!("../tests/files/chunks.h5.gz"), "chunks.h5");
        let numbers = |stored: &Stored| stored.load::<f64>(&Meter::new(&NoProgress, 1)).unwrap();
        let (mut later, mut truth) = (Vec::new(), Vec::new());
        for array in root.arrays().unwrap() {
            later.push(array.stored("a", 1).unwrap());
            truth.push(numbers(&array.stored("a", 1).unwrap()));
        }
        // The file was opened anew a few times, of which one is there, beside the file itself and what is read later.
        assert!(root.file.opened().unwrap().count < 13);
        assert_eq!((later.len(), Arc::strong_count(root.source())), (13, 13 + SOURCES));
        assert!(later.iter().map(numbers).eq(truth));
        let root = file(include_bytes!("../tests/files/links.h5.gz"), "links.h5");
        let groups = root.required_group("beside").unwrap().groups().unwrap();
        for group in groups.iter().chain(&groups) {
            let again = root.required_group("beside").unwrap().required_group(group.name()).unwrap();
            assert_eq!(again.identity(), group.identity());
        }
        let views = root.file.opened().unwrap().views.len();
        assert_eq!((groups.len(), Arc::strong_count(root.source())), (20, SOURCES + views));
    }
}
