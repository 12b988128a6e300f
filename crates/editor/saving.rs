//! The document into its file, and what another program wrote there.

use crate::actions::FilePurpose;
use crate::editor::Editor;
use crate::file_dialog::FileDialog;
use crate::files::Disk;
use std::path::Path;
use voltet_nodes::files::{folder, refuse_unwritable};

impl Editor {
    /// Saves the document in its own file, or asks for one; and asks where another program wrote it meanwhile.
    pub(crate) fn save(&mut self) {
        let Some(path) = self.document.path().map(Path::to_path_buf) else {
            self.file_dialog = Some(FileDialog::new(FilePurpose::SaveAs, None));
            return;
        };
        if self.document.changed_on_disk() {
            self.disk.is_changed = true;
            return;
        }
        self.save_as(&path);
    }

    /// Takes over another program's changes of the file, or overwrites them.
    pub(crate) fn settle_with_disk(&mut self, takes_over: bool) {
        let outcome = if takes_over { self.document.reload() } else { self.document.save_over() };
        self.disk = Disk::default();
        if let Err(error) = outcome {
            self.complain(&error);
        }
    }

    pub(crate) fn save_as(&mut self, path: &Path) {
        let mut path = path.to_path_buf();
        if path.extension().is_none() {
            path.set_extension("toml");
        }
        if let Err(error) = refuse_unwritable(&path) {
            self.complain(&error);
            return;
        }
        let follow = self.document.following_to(&self.registry, folder(&path));
        let paths = match follow.len() {
            0 => String::new(),
            1 => "; a path in it leads to the same file from there".into(),
            count => format!("; {count} paths in it lead to the same files from there"),
        };
        if !follow.is_empty() {
            self.edit("paths that lead from the new folder".into(), &follow);
        }
        match self.document.save_as(&path) {
            Ok(()) => {
                self.recent.add(&path);
                self.message = Some((format!("saved: {}{paths}", path.display()), false));
            }
            Err(error) => self.complain(&error),
        }
    }
}
