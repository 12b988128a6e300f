//! Virtual datasets of HDF5, whose values are those of other datasets: the error that refuses them.
//!
//! Version 0.12 of the crate hdf5-reader reads none. Source: HDF5 File Format Specification 3.0, "Data Layout Message" (class 3) and
//! "Global Heap Block for Virtual Datasets".

use hdf5_reader::Storage;
use hdf5_reader::error::Error as Failure;
use hdf5_reader::global_heap::GlobalHeapCollection;
use voltet_core::Error;

/// Version of the message about a layout, and the class of that of a virtual dataset.
const LAYOUT: [u8; 2] = [4, 3];
/// Bytes of an object header in which its layout is looked for.
const HEADER_BYTES: u64 = 1 << 12;

/// The error about a virtual dataset at a path or in the group there, if that is why the crate failed; with the first dataset that its values
/// are of where its file is known.
pub(super) fn refusal(storage: Option<&dyn Storage>, path: &str, error: &Failure) -> Option<Error> {
    let (mut child, mut error) = ("", error);
    while let Failure::Context { path, source } = error {
        (child, error) = (path, source);
    }
    if !matches!(error, Failure::UnsupportedLayoutClass(class) if *class == LAYOUT[1]) {
        return None;
    }
    // The crate writes: child 'NAME' at 0xADDRESS.
    let (name, address) = child.strip_prefix("child '")?.rsplit_once("' at 0x")?;
    let is_named = path.rsplit('/').next() == Some(name);
    let path = if is_named { path.to_owned() } else { format!("{}/{name}", path.trim_end_matches('/')) };
    let address = u64::from_str_radix(address, 16).ok()?;
    let found = storage
        .and_then(|storage| source(storage, address))
        .unwrap_or_else(|| "values of other datasets".to_owned());
    let expected = "a file with the values themselves: `h5repack -l CONTI FILE NEW` makes one while the files of the values are there";
    Some(Error::run("virtual datasets are not read").got(found).expected(expected).at_item(path))
}

/// The first dataset whose values those of a virtual one are, by the address of its header; `None` where that is not found.
fn source(storage: &dyn Storage, header: u64) -> Option<String> {
    let len = HEADER_BYTES.min(storage.len().checked_sub(header)?) as usize;
    let bytes = storage.read_range(header, len).ok()?;
    bytes.windows(14).filter(|own| own[..2] == LAYOUT).find_map(|layout| {
        let (address, index) = layout[2..].split_first_chunk::<8>()?;
        let heap =
            GlobalHeapCollection::parse_at_storage(storage, u64::from_le_bytes(*address), 8, 8).ok()?;
        let block = &heap.get_object(u16::from_le_bytes(*index.first_chunk()?))?.data;
        let count = u64::from_le_bytes(*block.get(1..)?.first_chunk()?);
        let texts: Vec<&[u8]> = block.get(9..)?.splitn(3, |&byte| byte == 0).collect();
        let [file, path] =
            [0, 1].map(|place| String::from_utf8_lossy(texts.get(place).copied().unwrap_or(b"")));
        let more = if count > 1 { format!(" and {} more", count - 1) } else { String::new() };
        Some(format!("values of '{path}' in the file '{file}'{more}"))
    })
}
