//! Files: what their names say, a document for data, and what another program wrote.

use crate::file_watcher::{BETWEEN, FileStamps, FileWatcher, state};
use std::path::{Path, PathBuf};
use std::time::Instant;
use voltet_core::Result;
use voltet_document::{Document, Edit};

/// Changes by other programs: the document's file, and the data.
#[derive(Debug, Default)]
pub(crate) struct Disk {
    pub is_changed: bool,
    pub looked: Option<Instant>,
    data: FileStamps,
}

impl Disk {
    /// Looks now and then; whether data that were known have changed, come or gone since.
    pub fn look(
        &mut self,
        document: &Document,
        data: impl FnOnce() -> Vec<PathBuf>,
        watch: &FileWatcher,
    ) -> bool {
        if self.looked.is_some_and(|looked| looked.elapsed() < BETWEEN) {
            return false;
        }
        self.is_changed = document.changed_on_disk();
        self.looked = Some(Instant::now());
        let now: FileStamps = data().into_iter().map(|path| (path.clone(), state(&path))).collect();
        let own = document.path().map(|path| (path.to_path_buf(), state(path)));
        watch.knows(now.clone().into_iter().chain(own).collect());
        let before = std::mem::replace(&mut self.data, now);
        self.data.iter().any(|(path, state)| before.get(path).is_some_and(|before| before != state))
    }
}

/// True if the ending is that of a pipeline, or of a picture, which may carry one.
pub(crate) fn is_pipeline_ending(ending: &str) -> bool {
    ending == "toml" || voltet_io::encode::FORMATS.iter().any(|format| format.name == ending)
}

/// Ends of the names of data files.
pub(crate) const DATA: [&str; 10] = ["vtu", "vtk", "vts", "vtr", "vti", "pvtu", "pvd", "xyz", "p3d", "x"];

/// True if a name is that of a pipeline file.
pub(crate) fn is_pipeline(path: &Path) -> bool {
    path.extension().is_none_or(|end| end == "toml")
}

/// Path for the pipeline made for a data file: beside it, under an unused name.
pub(crate) fn free_path(path: &Path) -> PathBuf {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let numbered = (2..).map(|number| path.with_file_name(format!("{stem}_{number}.toml")));
    let mut all = std::iter::once(path.with_extension("toml")).chain(numbered);
    all.find(|path| !path.exists()).unwrap_or_default()
}

/// A document that is not saved yet, of a text whose paths are relative to where it would be.
pub(crate) fn begun(text: String, at: &Path) -> Result<Document> {
    let mut document = Document::from_text(String::new(), Some(at.to_path_buf()));
    document.edit(&Edit::Text(text))?;
    Ok(document)
}
