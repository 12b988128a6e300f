//! Writing whole files: beside, then renamed; devices and pipes as they are.
//!
//! Files that stand beside the one to be written until they are whole go away with the program however it ends. While a reader of the
//! output is slow, only the program's end stops a write.

use crate::file_identity::{folder, followed, is_standard_output};
use crate::output::with_output;
use std::fs::{File, Metadata, OpenOptions};
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError, TryLockError};
use tempfile::NamedTempFile;
use voltet_core::{Error, Result};

enum Target {
    StandardOutput,
    /// A device or a pipe, which takes what is written and is not replaced.
    Through,
    /// A file, at the path that links lead to, and what is there.
    File(PathBuf, Option<Metadata>),
}

/// Finds out, before the work, whether `path` can be written.
pub fn refuse_unwritable(path: &Path) -> Result<()> {
    match target(path)? {
        Target::File(there, _) => {
            Temporary::create_for(&there).map(drop).map_err(|error| unwritable(path, &error))
        }
        // A pipe is opened only when there is something to write: that waits for its reader.
        Target::StandardOutput | Target::Through => Ok(()),
    }
}

/// Writes `content`: to a file beside `path` that is renamed, so that no partial file is ever seen. Links are followed; a
/// file that is there gives its permissions, and its owner where that is allowed. Devices and pipes are written as they
/// are; [`crate::STDOUT`] is the standard output.
pub fn write_whole(path: &Path, content: &[u8]) -> Result<()> {
    write_parts(path, &mut |out| out.write_all(content))
}

/// Bytes that are collected before they are written.
const BUFFER: usize = 1 << 18;

/// Like [`write_whole`], for content that is made while it is written. What it writes may come in small parts.
///
/// Errors: those of writing; an [`Error`] within one of `content` as it is.
pub fn write_parts(path: &Path, content: Content) -> Result<()> {
    let mut buffered = |out: &mut dyn Write| {
        let mut out = BufWriter::with_capacity(BUFFER, out);
        content(&mut out)?;
        out.flush()
    };
    let failed = |error: io::Error, other: &dyn Fn(&io::Error) -> Error| match error.downcast::<Error>() {
        Ok(own) => own,
        Err(error) => other(&error),
    };
    let of_path = |error| failed(error, &|error| unwritable(path, error));
    match target(path)? {
        Target::StandardOutput => {
            let _guard = begin();
            let written = with_output(buffered);
            unless_closed(written).map(drop).map_err(|error| failed(error, &unwritable_output))
        }
        Target::Through => write_through(path, &mut buffered).map_err(of_path),
        Target::File(there, former) => replace(&there, former.as_ref(), &mut buffered).map_err(of_path),
    }
}

/// Writes the content of a file to what it is given.
pub type Content<'a> = &'a mut dyn FnMut(&mut dyn Write) -> io::Result<()>;

/// Writes to the standard output; gives whether somebody reads on. Where nobody does, that is no error.
pub fn standard_output(content: &[u8]) -> Result<bool> {
    let _guard = begin();
    let written = with_output(|output| output.write_all(content).and_then(|()| output.flush()));
    unless_closed(written).map_err(|error| unwritable_output(&error))
}

/// The error where the standard output takes nothing more.
pub fn unwritable_output(error: &io::Error) -> Error {
    Error::run("the standard output cannot be written").got(error).expected("an output with space left")
}

fn target(path: &Path) -> Result<Target> {
    if is_standard_output(path) {
        return Ok(Target::StandardOutput);
    }
    match std::fs::metadata(path) {
        Ok(there) if there.is_dir() => {
            let error = Error::run("the path of the file to write is a folder").got(path.display());
            Err(error.expected("the path of a file"))
        }
        // The superuser may write to it all the same; whoever took the right to write away meant it.
        Ok(there) if there.permissions().readonly() => Err(read_only(path)),
        Ok(there) if there.is_file() => match OpenOptions::new().write(true).open(path) {
            Err(error) if error.kind() == ErrorKind::PermissionDenied => Err(read_only(path)),
            _ => Ok(Target::File(followed(path), Some(there))),
        },
        Ok(there) if takes_a_stream(&there) => Ok(Target::Through),
        Ok(_) => Err(Error::run(format!("'{}' cannot be written", path.display()))
            .got("a disk or a socket")
            .expected("a file, a pipe, a terminal, or a device such as /dev/null")),
        Err(error) if error.kind() == ErrorKind::NotFound => {
            let there = followed(path);
            match folder(&there).is_dir() {
                true => Ok(Target::File(there, None)),
                false => Err(without_folder(path, folder(&there))),
            }
        }
        Err(error) => Err(unwritable(path, &error)),
    }
}

#[cfg(unix)]
fn takes_a_stream(there: &Metadata) -> bool {
    use std::os::unix::fs::FileTypeExt;
    there.file_type().is_char_device() || there.file_type().is_fifo()
}

#[cfg(not(unix))]
fn takes_a_stream(_there: &Metadata) -> bool {
    true
}

/// Writes to a device or a pipe.
fn write_through(path: &Path, content: Content) -> io::Result<()> {
    let _guard = begin();
    unless_closed(content(&mut OpenOptions::new().write(true).open(path)?)).map(drop)
}

/// True while the reader goes on. A reader that has seen enough closes its end: then nothing more is to be written.
fn unless_closed(written: io::Result<()>) -> io::Result<bool> {
    match written {
        Ok(()) => Ok(true),
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(false),
        Err(error) => Err(error),
    }
}

fn replace(path: &Path, former: Option<&Metadata>, content: Content) -> io::Result<()> {
    let mut file = Temporary::create_for(path)?;
    content(file.file())?;
    if let Some(former) = former {
        take_over(former, file.file())?;
    }
    file.persist(path)
}

/// Gives a file the permissions of the one whose place it takes, and its owner where that is allowed.
#[cfg(unix)]
fn take_over(former: &Metadata, file: &File) -> io::Result<()> {
    use std::os::unix::fs::{MetadataExt, PermissionsExt, fchown};
    let own = file.metadata()?;
    let (owner, group) = (former.uid(), former.gid());
    let owned = (own.uid(), own.gid()) == (owner, group)
        || fchown(file, Some(owner), Some(group)).or_else(|_| fchown(file, None, Some(group))).is_ok();
    // Rights that go with an owner (set-user-id) stay with that owner.
    let rights = if owned { 0o7777 } else { 0o777 };
    file.set_permissions(std::fs::Permissions::from_mode(former.mode() & rights))
}

#[cfg(not(unix))]
fn take_over(former: &Metadata, file: &File) -> io::Result<()> {
    file.set_permissions(former.permissions())
}

fn read_only(path: &Path) -> Error {
    Error::run(format!("'{}' is read-only and is left as it is", path.display()))
        .expected("another path, or the right to write to the file")
}

fn without_folder(path: &Path, folder: &Path) -> Error {
    Error::run(format!("'{}' cannot be written: its folder does not exist", path.display()))
        .got(folder.display())
        .expected("a folder that is there")
}

fn unwritable(path: &Path, error: &io::Error) -> Error {
    Error::run(format!("'{}' cannot be written", path.display()))
        .got(error)
        .expected("a folder that can be written to, with space left")
}

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

static WAITS: AtomicBool = AtomicBool::new(false);

/// The program waits until this goes away.
pub(super) struct WriteGuard;

/// A write begins that may have to wait for a reader: to a pipe or a terminal.
pub(super) fn begin() -> WriteGuard {
    WAITS.store(true, Ordering::Relaxed);
    WriteGuard
}

impl Drop for WriteGuard {
    fn drop(&mut self) {
        WAITS.store(false, Ordering::Relaxed);
    }
}

/// True if a write to a pipe or a terminal is on its way.
pub fn is_waiting() -> bool {
    WAITS.load(Ordering::Relaxed)
}
