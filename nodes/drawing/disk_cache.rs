//! Measurements of devices, kept in the user's cache folder: one small file a key.

use crate::files::{Fnv, cache_folder, write_whole};
use std::fs;
use std::path::PathBuf;
use voltet_optics::engine::KeyValueStore;

/// A folder of such files. A damaged file counts as none; a measurement that cannot be kept is made again the next time.
pub struct CacheFolder(PathBuf);

impl CacheFolder {
    /// The store of this name within the user's cache folder.
    pub fn named(name: &str) -> CacheFolder {
        CacheFolder(cache_folder().join(name))
    }

    fn path(&self, key: &str) -> PathBuf {
        let mut name = Fnv::default();
        name.text(key);
        self.0.join(format!("{:032x}.txt", name.0))
    }
}

impl KeyValueStore for CacheFolder {
    fn recall(&self, key: &str) -> Option<String> {
        let file = fs::read_to_string(self.path(key)).ok()?;
        let (content, _) = file.split_at_checked(file.len().checked_sub(CHECK_LENGTH)?)?;
        let text = content.strip_prefix(key)?;
        (checked(content.to_string()) == file).then(|| text.to_string())
    }

    fn keep(&self, key: &str, text: &str) {
        let file = checked(format!("{key}{text}"));
        let _ = fs::create_dir_all(&self.0).map(|()| write_whole(&self.path(key), file.as_bytes()));
    }
}

/// "check ", 32 digits, a line end.
const CHECK_LENGTH: usize = 39;

/// The content with a hash of it behind.
fn checked(content: String) -> String {
    let mut check = Fnv::default();
    check.bytes(content.as_bytes());
    format!("{content}check {:032x}\n", check.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    const KEY: &str = "what was measured 1\nSome GPU (discrete, vulkan)\n";
    const TEXT: &str = "tiles 1.25e-3 s\nraster 3.5e-4 s\n";

    #[test]
    fn what_was_kept_is_found_again_under_its_own_key() {
        let folder = tempfile::tempdir().unwrap();
        let memory = CacheFolder(folder.path().join("not there yet"));
        assert_eq!(memory.recall(KEY), None);
        memory.keep(KEY, TEXT);
        assert_eq!(memory.recall(KEY).as_deref(), Some(TEXT));
        assert_eq!(memory.recall(&KEY.replace("Some", "Another")), None);
    }

    #[test]
    fn a_damaged_file_is_as_none_and_is_mended() {
        let folder = tempfile::tempdir().unwrap();
        let memory = CacheFolder(folder.path().into());
        memory.keep(KEY, TEXT);
        let file = fs::read_dir(folder.path()).unwrap().next().unwrap().unwrap().path();
        let whole = fs::read(&file).unwrap();
        for place in 0..whole.len() {
            let mut damaged = whole.clone();
            damaged[place] ^= 1;
            for content in [&damaged[..], &whole[..place]] {
                fs::write(&file, content).unwrap();
                assert_eq!(memory.recall(KEY), None, "byte {place}");
            }
        }
        memory.keep(KEY, TEXT);
        assert_eq!(memory.recall(KEY).as_deref(), Some(TEXT));
    }

    #[test]
    fn a_folder_that_cannot_be_written_is_no_error() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("a file");
        fs::write(&file, "in the way").unwrap();
        let memory = CacheFolder(file.join("below"));
        memory.keep(KEY, TEXT);
        assert_eq!(memory.recall(KEY), None);
    }
}
