//! The files that were opened and saved last, kept in the user's state folder.

use std::path::{Path, PathBuf};
use voltet_nodes::files::{state_folder, write_whole};

/// Length of the list.
const MAX_COUNT: usize = 8;

/// The list, the last one first; kept nowhere unless it has a file.
#[derive(Debug, Default)]
pub(crate) struct Recent {
    file: Option<PathBuf>,
    paths: Vec<PathBuf>,
}

impl Recent {
    /// The user's own.
    pub fn usual() -> Recent {
        Recent::in_file(state_folder().join("recent"))
    }

    /// Kept in a file, a path a line.
    pub fn in_file(file: PathBuf) -> Recent {
        let text = std::fs::read_to_string(&file).unwrap_or_default();
        let paths = text.lines().filter(|line| !line.is_empty()).map(PathBuf::from).take(MAX_COUNT).collect();
        Recent { file: Some(file), paths }
    }

    /// Files of the list that exist.
    pub fn paths(&self) -> impl Iterator<Item = &Path> {
        self.paths.iter().map(PathBuf::as_path).filter(|path| path.is_file())
    }

    /// A file was opened or saved.
    pub fn add(&mut self, path: &Path) {
        let path = std::fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf());
        if self.paths.first() == Some(&path) {
            return;
        }
        self.paths.retain(|other| *other != path);
        self.paths.insert(0, path);
        self.paths.truncate(MAX_COUNT);
        let lines: Option<Vec<&str>> = self.paths.iter().map(|path| path.to_str()).collect();
        if let (Some(file), Some(lines)) = (&self.file, lines) {
            // Where it cannot be kept, the next window does without.
            let made = file.parent().map(std::fs::create_dir_all);
            let _ = made.map(|_| write_whole(file, (lines.join("\n") + "\n").as_bytes()));
        }
    }
}
