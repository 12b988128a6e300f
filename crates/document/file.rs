//! The file of a document: opening, saving whole, also in another folder, and noticing that somebody else wrote it.

use crate::Document;
use crate::edit::Edit;
use crate::panel::{Control, Row};
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};
use voltet_core::{Error, Result};
use voltet_files::{relative_to, write_whole};
use voltet_graph::{ParameterValue, Registry, Stamp};

/// The first bytes of a file that is a picture: what pictures carry is opened by others.
const PICTURES: [&[u8]; 2] = [b"\x89PNG\r\n\x1a\n", &[0x76, 0x2f, 0x31, 0x01]];

impl Document {
    /// Opens a file. A text that is wrong in whatever way opens, too. Errors: it cannot be read, or is
    /// no text in UTF-8.
    pub fn open(path: &Path) -> Result<Document> {
        let unreadable =
            |error: std::io::Error| Error::usage("the pipeline file cannot be read").got(error).in_file(path);
        let mut file = File::open(path).map_err(unreadable)?;
        // Before it is read: a change in between is noticed, at worst one that was read.
        let stamp = stamp(path);
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes).map_err(unreadable)?;
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
        let same = |a: &Path, b: &Path| absolute(a).is_some_and(|a| absolute(b) == Some(a));
        if same(&own, folder) {
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

/// A folder without links; none where it is not there.
fn absolute(folder: &Path) -> Option<PathBuf> {
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    std::fs::canonicalize(folder).ok()
}

/// The files to read that rows state.
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
