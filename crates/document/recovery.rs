//! Work that was not saved outlives a crash: its text lies in the user's state folder until it is saved or given up.
//!
//! Beside each text lies a lock that its window holds as long as it lives; the system lets go of it however the program ends.
//! What is there and not locked was left behind.

use crate::Document;
use std::fs::{File, OpenOptions, TryLockError};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::SystemTime;
use voltet_core::{Error, Result};
use voltet_files::{Fnv, state_folder, write_whole};
use voltet_graph::ParameterValue;

const TEXT: &str = "toml";
const LOCK: &str = "lock";
/// Windows with documents of one file, or of none, that keep their work at a time.
const SLOTS: usize = 64;
/// The first words of a kept text; the file's path follows.
const OF: &str = "# unsaved work of ";
/// First line of a draft without a file.
const NEW: &str = "# unsaved work, not in a file yet";

/// Folder of drafts of unsaved work.
#[derive(Debug, Clone)]
pub struct Recovery {
    folder: PathBuf,
}

/// Keeps the unsaved work of one window.
#[derive(Debug)]
pub struct Autosave {
    text: PathBuf,
    /// Held as long as the window lives.
    lock: File,
    lock_path: PathBuf,
    of: Option<PathBuf>,
    /// The text that was kept last.
    kept: Option<Arc<str>>,
}

/// Work that was left behind.
#[derive(Debug)]
pub struct OrphanedDraft {
    /// The file that it is of.
    pub path: Option<PathBuf>,
    /// The text.
    pub text: String,
    /// Time of the draft.
    pub written: SystemTime,
    place: PathBuf,
    lock: File,
    lock_path: PathBuf,
}

impl Recovery {
    /// In the user's state folder.
    pub fn usual() -> Recovery {
        Recovery::in_folder(state_folder().join("unsaved"))
    }

    /// In another folder, which need not exist.
    pub fn in_folder(folder: PathBuf) -> Recovery {
        Recovery { folder }
    }

    /// Begins to keep the work of a window. Errors: the folder cannot be made or written.
    pub fn keeper(&self, document: &Document) -> Result<Autosave> {
        let unwritable = |error: std::io::Error| {
            Error::run("unsaved work cannot be kept")
                .got(error)
                .expected("a folder that can be written to")
                .in_file(&self.folder)
        };
        std::fs::create_dir_all(&self.folder).map_err(unwritable)?;
        let of = document.path().map(absolute);
        let mut hash = Fnv::default();
        hash.text(&of.as_deref().map(Path::to_string_lossy).unwrap_or_default());
        for slot in 0..SLOTS {
            let name = format!("{:016x}-{slot}", hash.0 as u64);
            let lock_path = self.folder.join(&name).with_extension(LOCK);
            let text = self.folder.join(&name).with_extension(TEXT);
            let lock = open_locked(&lock_path).map_err(unwritable)?;
            // What was left behind there is not written over.
            if lock.try_lock().is_ok() && !text.exists() {
                return Ok(Autosave { text, lock, lock_path, of, kept: None });
            }
        }
        Err(Error::run("unsaved work cannot be kept").got(format!("{SLOTS} works of the same file")))
    }

    /// Orphaned drafts, the newest first.
    pub fn left_behind(&self) -> Vec<OrphanedDraft> {
        let entries =
            std::fs::read_dir(&self.folder).into_iter().flatten().flatten().map(|entry| entry.path());
        let kept = entries.filter(|path| path.extension().is_some_and(|ending| ending == TEXT));
        let mut found: Vec<OrphanedDraft> = kept.filter_map(|path| OrphanedDraft::load(&path)).collect();
        found.sort_by_key(|one| std::cmp::Reverse(one.written));
        found
    }
}

impl Autosave {
    /// Keeps the text as it is now, where it is not saved and was not kept already; takes away what was kept where it is saved.
    /// Cheap to call often. Errors: it cannot be written.
    pub fn follow(&mut self, document: &Document) -> Result<()> {
        if document.is_saved() {
            return self.give_up();
        }
        let text = document.shared_text();
        if self.kept.as_ref().is_some_and(|kept| Arc::ptr_eq(kept, &text)) {
            return Ok(());
        }
        let head = match &self.of {
            Some(path) => format!("{OF}{}\n", ParameterValue::Text(path.to_string_lossy().into_owned())),
            None => format!("{NEW}\n"),
        };
        write_whole(&self.text, format!("{head}{text}").as_bytes())?;
        self.kept = Some(text);
        Ok(())
    }

    /// Takes away what was kept: it was saved, or nobody wants it.
    pub fn give_up(&mut self) -> Result<()> {
        self.kept = None;
        removed(&self.text)
    }
}

impl Drop for Autosave {
    fn drop(&mut self) {
        // A lock without a text is of no use; with one it says that nobody holds it.
        if !self.text.exists() {
            let _ = std::fs::remove_file(&self.lock_path);
        }
        let _ = self.lock.unlock();
    }
}

impl OrphanedDraft {
    fn load(place: &Path) -> Option<OrphanedDraft> {
        let lock_path = place.with_extension(LOCK);
        let lock = open_locked(&lock_path).ok()?;
        match lock.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => return None,
            // Where nothing can be locked, everything may be in use.
            Err(TryLockError::Error(_)) => return None,
        }
        let whole = std::fs::read_to_string(place).ok()?;
        let written = std::fs::metadata(place).and_then(|metadata| metadata.modified()).ok()?;
        let (head, text) = whole.split_once('\n')?;
        let path = match head.strip_prefix(OF) {
            Some(path) => Some(PathBuf::from(voltet_graph::pipeline::value(path)?.text()?)),
            None => None,
        };
        let (place, text) = (place.to_path_buf(), text.to_string());
        Some(OrphanedDraft { path, text, written, place, lock, lock_path })
    }

    /// A document of its file with this text in it, not saved; what was left behind is taken away once the document is kept or
    /// saved, so call [`LeftBehind::give_up`] then.
    pub fn document(&self) -> Document {
        let opened = self.path.as_deref().and_then(|path| Document::open(path).ok());
        let mut document = opened.unwrap_or_else(|| Document::from_text(String::new(), self.path.clone()));
        // A text can always be put in place of another.
        let edit = crate::Edit::Text(self.text.clone());
        let _ = document.edit_all("take up unsaved work".into(), &[edit], None);
        document
    }

    /// Takes it away.
    pub fn give_up(self) -> Result<()> {
        removed(&self.place)?;
        removed(&self.lock_path)?;
        drop(self.lock);
        Ok(())
    }
}

fn open_locked(path: &Path) -> std::io::Result<File> {
    OpenOptions::new().read(true).write(true).create(true).truncate(false).open(path)
}

fn removed(path: &Path) -> Result<()> {
    match std::fs::remove_file(path) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
            Err(Error::run("unsaved work cannot be taken away").got(error).in_file(path))
        }
        _ => Ok(()),
    }
}

/// The path that does not depend on where the program runs.
fn absolute(path: &Path) -> PathBuf {
    std::fs::canonicalize(path).or_else(|_| std::path::absolute(path)).unwrap_or_else(|_| path.to_path_buf())
}
