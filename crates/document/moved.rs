//! A document saved in another folder: its relative paths lead to the same files.

use crate::Document;
use crate::edit::Edit;
use crate::panel::{Control, Row};
use crate::path::Path;
use std::path::Path as FilePath;
use voltet_files::relative_to;
use voltet_graph::{ParameterValue, Registry};

impl Document {
    /// The edits after which the files that it reads are found from another folder, too; those that are not there, and whole
    /// paths, stay as they are. What it writes is written beside it, wherever that is.
    pub fn following_to(&self, registry: &Registry, folder: &FilePath) -> Vec<Edit> {
        let own = self.folder();
        let same = |a: &FilePath, b: &FilePath| absolute(a).is_some_and(|a| absolute(b) == Some(a));
        if same(&own, folder) {
            return Vec::new();
        }
        let mut edits = Vec::new();
        for node in &self.pipeline().nodes {
            read(&self.rows(registry, &node.name), &mut |path, text| {
                let there = own.join(text);
                if FilePath::new(text).is_relative() && there.exists() {
                    let text = relative_to(&there, folder).to_string_lossy().into_owned();
                    edits.push(Edit::set(&node.name, path.clone(), ParameterValue::Text(text)));
                }
            });
        }
        edits
    }
}

/// A folder without links; none where it is not there.
fn absolute(folder: &FilePath) -> Option<std::path::PathBuf> {
    let folder = if folder.as_os_str().is_empty() { FilePath::new(".") } else { folder };
    std::fs::canonicalize(folder).ok()
}

/// The files to read that rows state.
fn read(rows: &[Row], found: &mut dyn FnMut(&Path, &str)) {
    for row in rows {
        if let (Control::InputFile, Some(ParameterValue::Text(text))) = (&row.control, &row.set_value) {
            found(&row.path, text);
        }
        read(&row.rows, found);
        row.entries.iter().for_each(|entry| read(&entry.rows, found));
    }
}
