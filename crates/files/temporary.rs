//! Files that stand beside the one to be written until they are whole, and go away with the program however it ends.

use super::file_identity::folder;
use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError, TryLockError};
use tempfile::NamedTempFile;

/// Temporary files that may exist now. A signal ends the program without unwinding, and the files to remove then can be
/// known from here only.
static MADE: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// A file beside another that goes away unless it takes its place.
pub(super) struct Temporary(NamedTempFile);

impl Temporary {
    /// A file in the folder of `path`.
    pub fn create_for(path: &Path) -> io::Result<Temporary> {
        let mut builder = tempfile::Builder::new();
        builder.prefix(".voltet-").suffix(".tmp");
        #[cfg(unix)]
        {
            // As for any new file: what the umask leaves.
            use std::os::unix::fs::PermissionsExt;
            builder.permissions(std::fs::Permissions::from_mode(0o666));
        }
        // Locked until it stands in the list, so that a signal between the two waits.
        let mut made = MADE.lock().unwrap_or_else(PoisonError::into_inner);
        made.retain(|file| file.exists());
        let file = builder.tempfile_in(folder(path))?;
        made.push(file.path().to_path_buf());
        Ok(Temporary(file))
    }

    /// Takes the place of `path`.
    pub fn persist(self, path: &Path) -> io::Result<()> {
        self.0.persist(path).map(drop).map_err(|failed| failed.error)
    }

    pub fn file(&mut self) -> &mut File {
        self.0.as_file_mut()
    }
}

/// Ends the program at once with this exit code, and removes what it has begun to write.
pub fn end_now(code: i32) -> ! {
    // Whoever holds the lock may be the thread that this one interrupts (where memory ended); then it stays unlocked.
    let made = match MADE.try_lock() {
        Err(TryLockError::WouldBlock) => None,
        Ok(made) => Some(made),
        Err(TryLockError::Poisoned(made)) => Some(made.into_inner()),
    };
    for file in made.iter().flat_map(|made| made.iter()) {
        // One that is gone already took its place.
        let _ = std::fs::remove_file(file);
    }
    // The list stays locked: nothing new is begun.
    std::process::exit(code)
}
