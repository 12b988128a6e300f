//! The document into its file, and what another program wrote there.

use crate::editor::Editor;
use crate::files::{Asked, Disk, FileAsking};
use std::path::Path;

impl Editor {
    /// Saves the document in its own file, or asks for one; and asks where another program wrote it meanwhile.
    pub(crate) fn save(&mut self) {
        let Some(path) = self.document.path().map(Path::to_path_buf) else {
            self.asking = Some(FileAsking::new(Asked::SaveAs, None));
            return;
        };
        if self.document.changed_on_disk() {
            self.disk.is_changed = true;
            return;
        }
        self.save_as(&path);
    }

    /// What another program wrote is taken over, or written over.
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
        let outcome = self.document.save_as(&path);
        match outcome {
            Ok(()) => self.message = Some((format!("saved: {}", path.display()), false)),
            Err(error) => self.complain(&error),
        }
    }
}
