//! Wakes the window when a file is another than it was: the window need not look while nothing happens.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, SystemTime};

/// Interval between two checks of the files.
pub(crate) const BETWEEN: Duration = Duration::from_secs(1);

/// Length and time of a file; nothing of one that is not there.
pub(crate) type State = Option<(u64, SystemTime)>;

/// Files, each as it was found last.
pub(crate) type FileStamps = BTreeMap<PathBuf, State>;

pub(crate) fn state(path: &Path) -> State {
    let metadata = std::fs::metadata(path).ok()?;
    Some((metadata.len(), metadata.modified().ok()?))
}

/// A thread of its own that looks at files; it ends with this.
#[derive(Debug)]
pub(crate) struct FileWatcher {
    known: Arc<Mutex<FileStamps>>,
}

impl FileWatcher {
    /// Looks at the files again and again, and calls `wake` as long as a file differs from what is known of it. Errors: no thread can be started.
    pub fn start(between: Duration, wake: impl Fn() + Send + 'static) -> std::io::Result<FileWatcher> {
        let known = Arc::new(Mutex::new(FileStamps::new()));
        let watched = Arc::downgrade(&known);
        std::thread::Builder::new().name("files".into()).spawn(move || {
            loop {
                std::thread::sleep(between);
                let Some(known) = watched.upgrade() else { return };
                // Not held while a slow disk is asked.
                let known = known.lock().unwrap_or_else(PoisonError::into_inner).clone();
                if known.iter().any(|(path, before)| state(path) != *before) {
                    wake();
                }
            }
        })?;
        Ok(FileWatcher { known })
    }

    /// Sets the stamps that later ones are compared with.
    pub fn knows(&self, known: FileStamps) {
        *self.known.lock().unwrap_or_else(PoisonError::into_inner) = known;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::mpsc;

    #[test]
    fn a_file_that_comes_or_changes_wakes() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("data.vtk");
        let (sender, woken) = mpsc::channel();
        let watch = FileWatcher::start(BETWEEN / 100, move || _ = sender.send(())).unwrap();
        let know = || watch.knows(FileStamps::from([(path.clone(), state(&path))]));
        know();
        std::fs::write(&path, "1").unwrap();
        woken.recv_timeout(60 * BETWEEN).expect("a file that came");
        know();
        while woken.recv_timeout(BETWEEN / 10).is_ok() {}
        std::fs::write(&path, "12").unwrap();
        woken.recv_timeout(60 * BETWEEN).expect("a file that changed");
        drop(watch);
        while woken.recv_timeout(60 * BETWEEN).is_ok() {}
        assert_eq!(woken.recv_timeout(60 * BETWEEN), Err(mpsc::RecvTimeoutError::Disconnected));
    }
}
