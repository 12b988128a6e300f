//! Views of an HDF5 file in which a group is found by its address, without the names of all that stand beside it.
//!
//! The crate hdf5-reader finds a group by its path from the root alone, and to find one name in a group of the older form it reads all that
//! are in it. A view is the file with another header of the root group, which links to what the root links to and to the group at the
//! address. So links by paths from the root lead where they lead in the file.
//! Source: HDF5 File Format Specification 3.0, IV.A.1.a, Version 1 Data Object Header Prefix, and IV.A.2.g, Link Message.

use super::hdf5_heaps::HeapStorage;
use hdf5_reader::Storage;
use hdf5_reader::error::Result;
use hdf5_reader::group::Group;
use hdf5_reader::storage::StorageBuffer;
use hdf5_reader::superblock::Superblock;
use std::collections::HashSet;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

/// Name of the link to the group.
pub(super) const LINK: &str = "\u{1}";
/// Most bytes of the names in the root of a file that has views.
const MAX_NAMES: usize = 2048;
/// Type of the message of a link in a header.
const LINK_MESSAGE: u16 = 6;

/// Links and marks that the views of a file share.
#[derive(Default)]
pub(super) struct Views {
    /// Messages of the root's links, once a view was asked for; `None` where the file has no views.
    links: OnceLock<Option<Vec<u8>>>,
    /// Addresses of the groups of many groups.
    lists: Mutex<Vec<u64>>,
    /// True if a link in a view led through such a group, which would be read again for each view.
    lead_back: AtomicBool,
}

/// Bytes of a file with another header of the root group.
struct ViewStorage {
    file: Arc<HeapStorage>,
    views: Arc<Views>,
    /// Bytes before those that addresses count from.
    base: u64,
    /// Place of the root's header in the file; no other object begins there.
    root: u64,
    header: Arc<Vec<u8>>,
}

impl Storage for ViewStorage {
    fn len(&self) -> u64 {
        self.file.len()
    }

    fn read_range(&self, at: u64, len: usize) -> Result<StorageBuffer> {
        if at == self.root {
            return StorageBuffer::from_shared_owner(self.header.clone(), 0, len);
        }
        let lists = self.views.lists.lock().unwrap_or_else(PoisonError::into_inner);
        if lists.iter().any(|list| at.checked_sub(self.base) == Some(*list)) {
            self.views.lead_back.store(true, Ordering::Relaxed);
        }
        drop(lists);
        self.file.read_range(at, len)
    }
}

impl Views {
    /// Notes the address of a group of many groups.
    pub fn list(&self, address: u64) {
        let mut lists = self.lists.lock().unwrap_or_else(PoisonError::into_inner);
        if !lists.contains(&address) {
            lists.push(address);
        }
    }

    /// The bytes of a file whose root links to the group at an address, too; `None` where it has no views.
    pub fn view(
        self: &Arc<Views>,
        file: &Arc<HeapStorage>,
        superblock: &Superblock,
        address: u64,
        links: impl FnOnce() -> Option<Vec<u8>>,
    ) -> Option<Arc<dyn Storage>> {
        let links = self.links.get_or_init(links).as_ref();
        let links = links.filter(|_| !self.lead_back.load(Ordering::Relaxed))?;
        let messages = [&**links, &message(LINK, address, superblock.offset_size)].concat();
        let size = u32::try_from(messages.len()).ok()?;
        // Of version 1; the reader goes by the size, not by the number of messages.
        let head = [&[1, 0, 0, 0], &1_u32.to_le_bytes()[..], &size.to_le_bytes(), &[0; 4]].concat();
        let (base, header) = (superblock.base_address, Arc::new([head, messages].concat()));
        let root = base.checked_add(superblock.root_object_header_address().ok()?)?;
        Some(Arc::new(ViewStorage { file: file.clone(), views: self.clone(), base, root, header }))
    }
}

/// Messages of the links of a root group; `None` where the names are too long for views, or two are the same.
pub(super) fn links(root: &Group) -> Option<Vec<u8>> {
    let (groups, arrays) = root.member_names().ok()?;
    let mut known = HashSet::from([LINK]);
    let differ = groups.iter().chain(&arrays).all(|name| known.insert(name));
    if !differ || known.iter().map(|name| name.len()).sum::<usize>() > MAX_NAMES {
        return None;
    }
    let (groups, arrays) = root.members().ok()?;
    let groups = groups.iter().map(|group| (group.name(), group.address()));
    let arrays = arrays.iter().map(|array| (array.name(), array.address()));
    Some(
        groups.chain(arrays).flat_map(|(name, address)| message(name, address, root.offset_size())).collect(),
    )
}

/// Message of a link of version 1 to an address, with a name of up to [`MAX_NAMES`] bytes.
fn message(name: &str, address: u64, offset_size: u8) -> Vec<u8> {
    let address = &address.to_le_bytes()[..offset_size.into()];
    // Flag 1: two bytes say how long the name is.
    let link = [&[1, 1], &(name.len() as u16).to_le_bytes()[..], name.as_bytes(), address].concat();
    [&LINK_MESSAGE.to_le_bytes()[..], &(link.len() as u16).to_le_bytes(), &[0; 4], &link].concat()
}

#[cfg(test)]
mod tests {
    use super::super::hdf5::Group;
    use super::super::source::Source;
    use super::*;
    use hdf5_reader::io::Cursor;
    use std::io::Read;
    use std::path::Path;

    const OLD: &[u8] = include_bytes!("../tests/files/among_old.h5.gz");
    const NEW: &[u8] = include_bytes!("../tests/files/among_new.h5.gz");

    fn unpacked(packed: &[u8]) -> Vec<u8> {
        let mut bytes = Vec::new();
        flate2::read::GzDecoder::new(packed).read_to_end(&mut bytes).unwrap();
        bytes
    }

    fn root(folder: &Path, bytes: &[u8]) -> Group {
        let path = folder.join("among.h5");
        std::fs::write(&path, bytes).unwrap();
        Group::root(Source::open(&path).unwrap()).unwrap()
    }

    fn name(number: usize) -> String {
        if number == 7 { "07 é%2F\\x2f".into() } else { format!("{number:02}") }
    }

    fn values(group: &Group, name: &str) -> Vec<f64> {
        group.required_array(name).unwrap().numbers().unwrap()
    }

    /// True if a group is found in a view, when nothing is open.
    fn is_in_view(group: &Group) -> bool {
        let mut opened = group.file.opened().unwrap();
        opened.groups.clear();
        let found = group.file.group(&mut opened, group.path().trim_end_matches('/')).unwrap();
        let whole = group.file.numbered(group.identity().0).unwrap().file;
        !std::ptr::addr_eq(found.storage(), whole.storage())
    }

    #[test]
    fn groups_among_many_are_found_by_address_and_their_links_lead_where_they_did() {
        let contents = |group: &Group| {
            let arrays = group.arrays().unwrap();
            let own: Vec<_> = arrays.iter().map(|array| values(group, array.name())).collect();
            let linked = ["root", "other"].map(|name| group.required_group(name).unwrap());
            let linked = linked.map(|group| (group.identity(), group.names().unwrap()));
            (group.identity(), group.names().unwrap(), own, group.text("name").unwrap(), linked)
        };
        for (packed, user_block) in [(OLD, 0), (OLD, 512), (NEW, 0), (NEW, 512)] {
            let folder = tempfile::tempdir().unwrap();
            std::fs::write(folder.path().join("other.h5"), unpacked(NEW)).unwrap();
            let root = root(folder.path(), &[vec![0; user_block], unpacked(packed)].concat());
            // In this file, and in one that a link leads to.
            for above in [root.clone(), root.required_group("common").unwrap()] {
                let above = above.required_group("among").unwrap();
                let by_name = |number| contents(&above.required_group(&name(number)).unwrap());
                let truth: Vec<_> = (0..20).map(by_name).collect();
                let mut groups = above.groups().unwrap();
                groups.sort_by_key(|group| group.name().to_owned());
                assert_eq!(groups.len(), 20);
                for (number, group) in groups.iter().enumerate() {
                    assert!(is_in_view(group), "{number}");
                    assert_eq!(contents(group), truth[number]);
                    let own = [number as f64];
                    assert_eq!((values(group, "own"), values(group, "near")), (own.to_vec(), own.to_vec()));
                    assert_eq!(
                        (values(group, "alone"), values(group, "shared")),
                        (vec![9.0], vec![7.0, 8.0])
                    );
                    assert_eq!(values(&group.required_group("other").unwrap(), "own"), own);
                    assert_eq!(group.text("name").unwrap(), Some(name(number)));
                }
                // The last leads to the first by its path, for which each view would read the names of all.
                assert_eq!(values(&groups[19], "first"), [0.0]);
                for (group, truth) in groups.iter().zip(&truth) {
                    assert!(!is_in_view(group));
                    assert_eq!(contents(group), *truth);
                }
            }
            assert_eq!(root.linked_files(), [folder.path().join("other.h5")]);
        }
    }

    #[test]
    fn a_file_whose_root_holds_names_that_are_the_same_has_no_views() {
        let bytes = unpacked(OLD);
        let at = bytes.windows(7).position(|own| own == b"\0alone\0").unwrap() + 1;
        for (name, has_views) in [("alone", true), ("common", false), (LINK, false)] {
            let folder = tempfile::tempdir().unwrap();
            let mut bytes = bytes.clone();
            bytes[at..at + 8].fill(0);
            bytes[at..at + name.len()].copy_from_slice(name.as_bytes());
            let groups = root(folder.path(), &bytes).required_group("among").unwrap().groups().unwrap();
            assert_eq!(is_in_view(&groups[3]), has_views, "{name}");
            assert_eq!(values(&groups[3], "own"), [3.0]);
        }
    }

    #[test]
    fn damaged_files_are_errors_or_other_values_in_views_too() {
        let folder = tempfile::tempdir().unwrap();
        let bytes = unpacked(OLD);
        let root_header =
            Superblock::parse(&mut Cursor::new(&bytes)).unwrap().root_object_header_address().unwrap();
        let (mut read, mut in_views) = (0, 0);
        let places = (0..bytes.len() - 8).step_by(8).filter(|&at| bytes[at..at + 8] != [0; 8]);
        for at in places.step_by(3) {
            for damage in [0, 1 << 63, u64::MAX - 7, root_header, bytes.len() as u64 - 8] {
                let mut damaged = bytes.clone();
                damaged[at..at + 8].copy_from_slice(&damage.to_le_bytes());
                let path = folder.path().join("damaged.h5");
                std::fs::write(&path, &damaged).unwrap();
                let groups = Source::open(&path)
                    .and_then(Group::root)
                    .and_then(|root| root.required_group("among")?.groups());
                for group in groups.iter().flatten().step_by(6) {
                    let values = |name: &str| group.required_array(name)?.numbers::<f64>();
                    read += ["own", "near", "shared"].iter().filter(|name| values(name).is_ok()).count();
                    in_views += group.file.opened().unwrap().views.len();
                }
            }
        }
        assert!(read > 0 && in_views > 0);
    }
}
