//! Files that a file names, remembered until one of them changes: large files are read as a whole to find them.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::{LazyLock, Mutex, PoisonError};
use std::time::SystemTime;

/// Length of a file and the time at which it was changed; `None` where the system does not tell.
type Stamp = Option<(u64, SystemTime)>;

/// Files with named ones that are remembered.
const MAX_FILES: usize = 64;

/// The files that a path names, and the stamps of the path and of these.
type Named = (Vec<PathBuf>, Vec<Stamp>);

static KNOWN: LazyLock<Mutex<HashMap<PathBuf, Named>>> = LazyLock::new(Mutex::default);

fn stamp(path: &Path) -> Stamp {
    let own = path.metadata().ok()?;
    Some((own.len(), own.modified().ok()?))
}

/// The files that a path names by `find`: those and whether it came to the end, without which they are not remembered.
pub(super) fn files_named(path: &Path, find: impl FnOnce() -> (Vec<PathBuf>, bool)) -> Vec<PathBuf> {
    let stamps = |first: Stamp, files: &[PathBuf]| -> Vec<Stamp> {
        std::iter::once(first).chain(files.iter().map(|file| stamp(file))).collect()
    };
    let own = stamp(path);
    let known = KNOWN.lock().unwrap_or_else(PoisonError::into_inner).get(path).cloned();
    if let Some((files, before)) = known
        && stamps(own, &files) == before
        && !before.contains(&None)
    {
        return files;
    }
    let (files, is_whole) = find();
    let mut known = KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
    if known.len() >= MAX_FILES {
        known.clear();
    }
    known.remove(path);
    if is_whole {
        known.insert(path.to_owned(), (files.clone(), stamps(own, &files)));
    }
    files
}
