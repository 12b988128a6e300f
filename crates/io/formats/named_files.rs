//! Files that a file includes, and limits on them. They are remembered until one of them changes: large files are read as a whole to find
//! them.

use super::request::Request;
use super::source::Source;
use super::xml::open_named;
use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};
use std::sync::{Arc, LazyLock, Mutex, PoisonError};
use std::time::SystemTime;
use voltet_core::{Error, Result};

/// Files that a file may include in all, and within one another.
const MAX_INCLUDED: usize = 1 << 10;
const MAX_DEPTH: usize = 16;
/// Bytes that are read again, of files that are included more than once: for each byte of all files, and beside these. Requests of output
/// are repeated in the cases of a load, and a mesh in some parts.
const MAX_REPEATED_PER_BYTE: u64 = 4;
const MAX_REPEATED_BESIDE: u64 = 1 << 20;

/// Length of a file and the time at which it was changed; `None` where the system does not tell.
type Stamp = Option<(u64, SystemTime)>;

/// Files with named ones that are remembered.
const MAX_FILES: usize = 64;

type Named = (Vec<PathBuf>, Vec<Stamp>);

static KNOWN: LazyLock<Mutex<HashMap<PathBuf, Named>>> = LazyLock::new(Mutex::default);

fn stamp(path: &Path) -> Stamp {
    let own = path.metadata().ok()?;
    Some((own.len(), own.modified().ok()?))
}

/// Files that a first one and those within it include.
pub(super) struct IncludedFiles {
    /// Their paths, as often as they are included.
    pub paths: Vec<PathBuf>,
    /// Bytes of all files and of the first one, each once.
    pub file_bytes: u64,
    repeated_bytes: u64,
    known: HashSet<PathBuf>,
}

impl IncludedFiles {
    /// None yet.
    pub fn new(first: &Source) -> IncludedFiles {
        let known = first.path().canonicalize().into_iter().collect();
        IncludedFiles { paths: Vec::new(), file_bytes: first.len(), repeated_bytes: 0, known }
    }

    /// Counts a file that is to be opened, at `depth` within others. Errors: there are too many, or too much would be read again.
    pub fn count(&mut self, path: &Path, depth: usize) -> Result<()> {
        let too_many =
            |expected: String| Err(Error::run("the file includes too many others").expected(expected));
        if depth > MAX_DEPTH || self.paths.len() == MAX_INCLUDED {
            return too_many(format!(
                "at most {MAX_INCLUDED}, {MAX_DEPTH} within one another, none within itself"
            ));
        }
        let len = path.metadata().map_or(0, |own| own.len());
        if self.known.insert(path.canonicalize().unwrap_or_else(|_| path.to_owned())) {
            self.file_bytes = self.file_bytes.saturating_add(len);
            return Ok(());
        }
        self.repeated_bytes = self.repeated_bytes.saturating_add(len);
        let most = self.file_bytes.saturating_mul(MAX_REPEATED_PER_BYTE).saturating_add(MAX_REPEATED_BESIDE);
        if self.repeated_bytes > most {
            return too_many(format!(
                "at most {most} bytes of files that were included before, none within itself"
            ));
        }
        Ok(())
    }

    /// Opens a file that `by` includes; `None`: it is empty.
    pub fn open(&mut self, by: &Path, path: &Path) -> Result<Option<Arc<Source>>> {
        let is_empty = path.metadata().is_ok_and(|own| own.is_file() && own.len() == 0);
        let source = if is_empty { None } else { Some(open_named(by, path, self.paths.len())?) };
        self.paths.push(path.to_owned());
        Ok(source)
    }
}

/// The files that a file of a format includes, by the scan that finds them; none for other formats.
pub(super) fn files_included(
    path: &Path,
    matches: impl FnOnce(&[u8], &Path, &Request) -> bool,
    scan: impl FnOnce(&Arc<Source>) -> (Result<()>, IncludedFiles),
) -> Vec<PathBuf> {
    let Some(source) = Source::open_if(path, |head| matches(head, path, &Request::default())) else {
        return Vec::new();
    };
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
    // What is damaged is an error of the reading itself, and not remembered.
    let (scanned, IncludedFiles { paths: files, .. }) = scan(&source);
    let mut known = KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
    if known.len() >= MAX_FILES {
        known.clear();
    }
    known.remove(path);
    if scanned.is_ok() {
        known.insert(path.to_owned(), (files.clone(), stamps(own, &files)));
    }
    files
}
