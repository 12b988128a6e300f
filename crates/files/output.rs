//! The standard output: descriptor 1, or a private one once others in this process may print.

use std::fs::File;
use std::io::{self, Write};
use std::sync::OnceLock;

static PRIVATE: OnceLock<File> = OnceLock::new();

/// Takes the standard output for what this program writes by [`crate::standard_output`] and [`crate::write_whole`]. Prints of others
/// in this process, and of processes that they begin, go to the standard error from here on. Does nothing the second time, and on other
/// systems than Unix.
///
/// Errors: the system has no descriptor left.
pub fn take_standard_output() -> io::Result<()> {
    #[cfg(unix)]
    if PRIVATE.get().is_none() {
        use std::os::fd::AsFd;
        io::stdout().flush()?;
        let own = io::stdout().as_fd().try_clone_to_owned()?;
        // SAFETY: both are descriptors of this process, and nothing of the standard output is buffered.
        if unsafe { libc::dup2(2, 1) } < 0 {
            return Err(io::Error::last_os_error());
        }
        let _ = PRIVATE.set(File::from(own));
    }
    Ok(())
}

/// The private descriptor, if it was taken.
pub(crate) fn private() -> Option<&'static File> {
    PRIVATE.get()
}

/// Carries out `work` with the standard output.
pub(crate) fn with_output<T>(work: impl FnOnce(&mut dyn Write) -> T) -> T {
    match private() {
        Some(mut own) => work(&mut own),
        None => work(&mut io::stdout().lock()),
    }
}
