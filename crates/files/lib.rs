//! voltet-files: which file a path means, writing whole ones, the standard output, the user's folders.
//!
//! What is being written stands beside the file until it is whole. Two things of this hold for the whole process, since a
//! signal does: what stands beside files now ([`end_now`] removes it), and whether a reader is waited for.

mod file_identity;
mod hash;
mod temporary;
mod write;
mod write_guard;

pub use file_identity::{FileIdentity, STDOUT, Use, collision, folder, is_standard_output, relative_to};
pub use hash::Fnv;
pub use temporary::end_now;
pub use write::{refuse_unwritable, standard_output, unwritable_output, write_whole};
pub use write_guard::is_waiting;

use std::path::{Path, PathBuf};

/// The program's folder within the user's cache folder: what can be made again. It need not exist.
pub fn cache_folder() -> PathBuf {
    user_folder("XDG_CACHE_HOME", ".cache", "Library/Caches")
}

/// The program's folder within the user's state folder: what outlives a run and cannot be made again. It need not exist.
pub fn state_folder() -> PathBuf {
    user_folder("XDG_STATE_HOME", ".local/state", "Library/Application Support")
}

/// The program's folder within the user's configuration folder: what the user wrote. It need not exist.
pub fn configuration_folder() -> PathBuf {
    user_folder("XDG_CONFIG_HOME", ".config", "Library/Application Support")
}

/// By the variable, or within the user's home, on macOS elsewhere.
fn user_folder(variable: &str, usual: &str, on_macos: &str) -> PathBuf {
    let set = |name: &str| std::env::var_os(name).filter(|value| !value.is_empty()).map(PathBuf::from);
    let home = || set("HOME").map(|home| home.join(if cfg!(target_os = "macos") { on_macos } else { usual }));
    let base = set(variable).or_else(|| set("LOCALAPPDATA")).or_else(home);
    base.unwrap_or_else(std::env::temp_dir).join("voltet")
}

/// A path to write, as people are told of it.
pub fn display_path(path: &Path) -> String {
    match path == Path::new(STDOUT) {
        true => "the standard output".into(),
        false => path.display().to_string(),
    }
}

/// True if a path by its words alone is the standard output or a device, which have no endings.
pub fn is_stream(path: &str) -> bool {
    path == STDOUT || path.starts_with("/dev/")
}
