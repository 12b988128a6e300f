//! The file of a document: opening, saving whole, also in another folder, and noticing that somebody else wrote it.
//!
//! Work that was not saved outlives a crash: its text lies in the user's state folder until it is saved or given up. Beside each text
//! lies a lock that its window holds as long as it lives; the system releases it however the program ends. A text that is not locked
//! was left behind.

use crate::Document;
use crate::edit::Edit;
use crate::panel::{Control, Row};
use std::fs::{File, OpenOptions};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::SystemTime;
use voltet_core::{Error, Result};
use voltet_files::{Fnv, relative_to, state_folder, write_whole};
use voltet_graph::{ParameterValue, Registry, Stamp};

/// The first bytes of a file that is a picture: what pictures carry is opened by others.
const PICTURES: [&[u8]; 2] = [b"\x89PNG\r\n\x1a\n", &[0x76, 0x2f, 0x31, 0x01]];

impl Document {
    /// Opens a file. A text that is wrong in whatever way opens, too. Errors: it cannot be read, or is
    /// no text in UTF-8.
    pub fn open(path: &Path) -> Result<Document> {
        let unreadable =
            |error: std::io::Error| Error::usage("the pipeline file cannot be read").got(error).in_file(path);
        // Before it is read: a change in between is noticed, at worst one that was read.
        let stamp = stamp(path);
        let bytes = std::fs::read(path).map_err(unreadable)?;
        if PICTURES.iter().any(|first| bytes.starts_with(first)) {
            let error = Error::usage("the file is a picture, not a pipeline file");
            return Err(error.expected("the pipeline file that it was drawn by").in_file(path));
        }
        let text = String::from_utf8(bytes).map_err(|error| {
            let found = format!("byte {} is no UTF-8", error.utf8_error().valid_up_to());
            let error = Error::usage("the file is no pipeline file").got(found);
            error.expected("TOML text").in_file(path)
        })?;
        let mut document = Document::from_text(text, Some(path.to_path_buf()));
        document.stamp = stamp;
        Ok(document)
    }

    /// Writes the text to its file, whole or not at all. Errors: there is no file yet, it cannot be written, or it was changed by
    /// somebody else since it was read or written here: then [`Document::save_over`] or [`Document::reload`] decide.
    pub fn save(&mut self) -> Result<()> {
        let path = self
            .path
            .clone()
            .ok_or_else(|| Error::usage("the pipeline has no file yet").expected("a path to save it to"))?;
        if self.changed_on_disk() {
            let error = Error::run("the file was changed by another program since it was read");
            return Err(error.expected("that change taken over, or this text saved over it").in_file(&path));
        }
        self.save_as(&path)
    }

    /// Saves the document, whatever the file holds now.
    pub fn save_over(&mut self) -> Result<()> {
        self.stamp = self.path.as_deref().and_then(stamp);
        self.save()
    }

    /// Writes the text to a file, which is the document's from now on. Relative paths in it are of its folder: see
    /// [`Document::following_to`].
    pub fn save_as(&mut self, path: &Path) -> Result<()> {
        write_whole(path, self.text.as_bytes())?;
        self.stamp = stamp(path);
        self.path = Some(path.to_path_buf());
        self.history.save();
        Ok(())
    }

    /// True if the file is not as it was when it was read or written here.
    pub fn changed_on_disk(&self) -> bool {
        self.path.as_deref().is_some_and(|path| stamp(path) != self.stamp)
    }

    /// Takes over what is in the file now, as a step that can be undone. Errors: it cannot be read.
    pub fn reload(&mut self) -> Result<()> {
        let Some(path) = self.path.clone() else { return Ok(()) };
        let there = Document::open(&path)?;
        self.edit_all("reload the file".into(), &[Edit::Text(there.text().to_string())], None)?;
        self.stamp = there.stamp;
        self.history.save();
        Ok(())
    }

    /// The edits after which the files that it reads are found from another folder, too; those that are not there, and whole
    /// paths, stay as they are. What it writes is written beside it, wherever that is.
    pub fn following_to(&self, registry: &Registry, folder: &Path) -> Vec<Edit> {
        let own = self.folder();
        let whole = |folder: &Path| std::fs::canonicalize(Path::new(".").join(folder)).ok();
        if whole(&own).is_some_and(|own| whole(folder) == Some(own)) {
            return Vec::new();
        }
        let mut edits = Vec::new();
        for node in &self.pipeline().nodes {
            read(&self.rows(registry, &node.name), &mut |path, text| {
                let there = own.join(text);
                if Path::new(text).is_relative() && there.exists() {
                    let text = relative_to(&there, folder).to_string_lossy().into_owned();
                    edits.push(Edit::set(&node.name, path.clone(), ParameterValue::Text(text)));
                }
            });
        }
        edits
    }
}

fn read(rows: &[Row], found: &mut dyn FnMut(&crate::Path, &str)) {
    for row in rows {
        if let (Control::InputFile, Some(ParameterValue::Text(text))) = (&row.control, &row.set_value) {
            found(&row.path, text);
        }
        read(&row.rows, found);
        row.entries.iter().for_each(|entry| read(&entry.rows, found));
    }
}

/// Length and time of a file; none where it is not there.
pub fn stamp(path: &Path) -> Stamp {
    let metadata = std::fs::metadata(path).ok()?;
    Some((metadata.len(), metadata.modified().ok()?))
}

const TEXT: &str = "toml";
const LOCK: &str = "lock";
/// Windows with documents of one file, or of none, that keep their work at a time.
const SLOTS: usize = 64;
/// The first words of a kept text; the file's path follows.
const OF: &str = "# unsaved work of ";
/// First line of a draft without a file.
const NEW: &str = "# unsaved work, not in a file yet";

/// A draft's text, whose lock is held.
#[derive(Debug)]
struct Slot {
    text: PathBuf,
    _lock: File,
}

impl Slot {
    /// `None` where another window holds the lock, or where nothing can be locked and everything may be in use.
    fn hold(text: PathBuf) -> std::io::Result<Option<Slot>> {
        let mut options = OpenOptions::new();
        let options = options.read(true).write(true).create(true).truncate(false);
        let lock = options.open(text.with_extension(LOCK))?;
        Ok(lock.try_lock().is_ok().then_some(Slot { text, _lock: lock }))
    }

    fn remove_text(&self) -> Result<()> {
        match std::fs::remove_file(&self.text) {
            Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
                Err(Error::run("unsaved work cannot be taken away").got(error).in_file(&self.text))
            }
            _ => Ok(()),
        }
    }
}

impl Drop for Slot {
    fn drop(&mut self) {
        // A lock without a text is of no use; one with a text marks it as left behind.
        if !self.text.exists() {
            let _ = std::fs::remove_file(self.text.with_extension(LOCK));
        }
    }
}

/// Folder of drafts of unsaved work.
#[derive(Debug, Clone)]
pub struct Recovery {
    folder: PathBuf,
}

/// Keeps the unsaved work of one window.
#[derive(Debug)]
pub struct Autosave {
    slot: Slot,
    of: Option<PathBuf>,
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
    slot: Slot,
}

impl Recovery {
    /// In the user's state folder; `None` where there is none.
    pub fn usual() -> Option<Recovery> {
        Some(Recovery::in_folder(state_folder()?.join("unsaved")))
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
        // A path that does not depend on where the program runs.
        let absolute = |path: &Path| std::fs::canonicalize(path).or_else(|_| std::path::absolute(path)).ok();
        let of = document.path().map(|path| absolute(path).unwrap_or_else(|| path.to_path_buf()));
        let mut hash = Fnv::default();
        hash.text(&of.as_deref().map(Path::to_string_lossy).unwrap_or_default());
        for slot in 0..SLOTS {
            let text = self.folder.join(format!("{:016x}-{slot}.{TEXT}", hash.0 as u64));
            // What was left behind there is not written over.
            if let Some(slot) = Slot::hold(text).map_err(unwritable)?.filter(|slot| !slot.text.exists()) {
                return Ok(Autosave { slot, of, kept: None });
            }
        }
        Err(Error::run("unsaved work cannot be kept").got(format!("{SLOTS} works of the same file")))
    }

    /// Orphaned drafts, the newest first.
    pub fn left_behind(&self) -> Vec<OrphanedDraft> {
        let entries =
            std::fs::read_dir(&self.folder).into_iter().flatten().flatten().map(|entry| entry.path());
        let kept = entries.filter(|path| path.extension().is_some_and(|ending| ending == TEXT));
        let mut found: Vec<OrphanedDraft> = kept.filter_map(OrphanedDraft::load).collect();
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
        let text = &document.text;
        if self.kept.as_ref().is_some_and(|kept| Arc::ptr_eq(kept, text)) {
            return Ok(());
        }
        let head = match &self.of {
            Some(path) => format!("{OF}{}\n", ParameterValue::Text(path.to_string_lossy().into_owned())),
            None => format!("{NEW}\n"),
        };
        write_whole(&self.slot.text, format!("{head}{text}").as_bytes())?;
        self.kept = Some(text.clone());
        Ok(())
    }

    /// Takes away what was kept: it was saved, or nobody wants it.
    pub fn give_up(&mut self) -> Result<()> {
        self.kept = None;
        self.slot.remove_text()
    }
}

impl OrphanedDraft {
    fn load(place: PathBuf) -> Option<OrphanedDraft> {
        let slot = Slot::hold(place).ok()??;
        let whole = std::fs::read_to_string(&slot.text).ok()?;
        let written = std::fs::metadata(&slot.text).and_then(|metadata| metadata.modified()).ok()?;
        let (head, text) = whole.split_once('\n')?;
        let path = match head.strip_prefix(OF) {
            Some(path) => Some(PathBuf::from(voltet_graph::pipeline::value(path)?.text()?)),
            None => None,
        };
        Some(OrphanedDraft { path, text: text.to_string(), written, slot })
    }

    /// A document of its file with this text in it, not saved; call [`OrphanedDraft::give_up`] once the document is kept or saved. Without
    /// a file it begins with this text.
    pub fn document(&self) -> Document {
        let Some(mut document) = self.path.as_deref().and_then(|path| Document::open(path).ok()) else {
            let mut document = Document::from_text(self.text.clone(), self.path.clone());
            document.history.saved = None;
            return document;
        };
        // A text can always be put in place of another.
        let edit = Edit::Text(self.text.clone());
        let _ = document.edit_all("take up unsaved work".into(), &[edit], None);
        document
    }

    /// Takes it away.
    pub fn give_up(self) -> Result<()> {
        self.slot.remove_text()
    }
}
