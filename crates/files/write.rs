//! Writing whole files: beside, then renamed; devices and pipes as they are.

use super::file_identity::folder;
use super::file_identity::{followed, is_standard_output};
use super::temporary::Temporary;
use super::write_guard;
use std::fs::{File, Metadata, OpenOptions};
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};
use voltet_core::{Error, Result};

/// Target of a path to write.
enum Target {
    /// The standard output.
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
/// are; [`super::STDOUT`] is the standard output.
pub fn write_whole(path: &Path, content: &[u8]) -> Result<()> {
    match target(path)? {
        Target::StandardOutput => standard_output(content).map(drop),
        Target::Through => write_through(path, content).map(drop).map_err(|error| unwritable(path, &error)),
        Target::File(there, former) => {
            replace(&there, former.as_ref(), content).map_err(|error| unwritable(path, &error))
        }
    }
}

/// Writes to the standard output; gives whether somebody reads on. Where nobody does, that is no error.
pub fn standard_output(content: &[u8]) -> Result<bool> {
    let _guard = write_guard::begin();
    let mut output = io::stdout().lock();
    unless_closed(output.write_all(content).and_then(|()| output.flush()))
        .map_err(|error| unwritable_output(&error))
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
fn write_through(path: &Path, content: &[u8]) -> io::Result<bool> {
    let _guard = write_guard::begin();
    unless_closed(OpenOptions::new().write(true).open(path)?.write_all(content))
}

/// True while the reader goes on. A reader that has seen enough closes its end: then nothing more is to be written.
fn unless_closed(written: io::Result<()>) -> io::Result<bool> {
    match written {
        Ok(()) => Ok(true),
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(false),
        Err(error) => Err(error),
    }
}

fn replace(path: &Path, former: Option<&Metadata>, content: &[u8]) -> io::Result<()> {
    let mut file = Temporary::create_for(path)?;
    file.file().write_all(content)?;
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
