//! Writing whole files: beside, then renamed, so that no partial file is ever seen; and the user's cache folder.

mod hash;

pub use hash::Fnv;

use std::io::Write;
use std::path::{Path, PathBuf};
use voltet_core::{Error, Result};

/// The program's folder within the user's cache folder. It need not exist.
pub fn cache_folder() -> PathBuf {
    let set = |name: &str| std::env::var_os(name).filter(|value| !value.is_empty()).map(PathBuf::from);
    let home = || {
        set("HOME").map(|home| home.join(if cfg!(target_os = "macos") { "Library/Caches" } else { ".cache" }))
    };
    let base = set("XDG_CACHE_HOME").or_else(|| set("LOCALAPPDATA")).or_else(home);
    base.unwrap_or_else(std::env::temp_dir).join("voltet")
}

/// The folder that a file lies in.
fn folder(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

/// Finds out, before the work, whether `path` can be written.
pub fn refuse_unwritable(path: &Path) -> Result<()> {
    let folder = folder(path);
    if !folder.is_dir() {
        let error = Error::run(format!("'{}' cannot be written: its folder does not exist", path.display()));
        return Err(error.found(folder.display()).accepted("a folder that is there"));
    }
    if path.is_dir() {
        let error = Error::run("the path of the file to write is a folder").found(path.display());
        return Err(error.accepted("the path of a file"));
    }
    temporary(path).map(drop)
}

/// Writes `content` to a file beside `path` and renames it.
pub fn write_whole(path: &Path, content: &[u8]) -> Result<()> {
    let mut file = temporary(path)?;
    file.write_all(content).map_err(|e| unwritable(path, &e))?;
    file.persist(path).map_err(|e| unwritable(path, &e.error))?;
    Ok(())
}

/// A file beside `path` that goes away unless it is kept.
fn temporary(path: &Path) -> Result<tempfile::NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".voltet-").suffix(".tmp");
    #[cfg(unix)]
    {
        // As for any new file: what the umask leaves.
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    builder.tempfile_in(folder(path)).map_err(|error| unwritable(path, &error))
}

fn unwritable(path: &Path, error: &std::io::Error) -> Error {
    Error::run(format!("'{}' cannot be written", path.display()))
        .found(error)
        .accepted("a folder that can be written to, with space left")
}
