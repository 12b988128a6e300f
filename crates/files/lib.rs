//! voltet-files: which file a path means, writing whole ones, the standard output, the user's folders.
//!
//! What is being written stands beside the file until it is whole. Two things of this hold for the whole process, since a
//! signal does: what stands beside files now ([`end_now`] removes it), and whether a reader is waited for.

mod file_identity;
mod output;
mod write;

pub use file_identity::{FileIdentity, STDOUT, Use, collision, folder, is_standard_output, relative_to};
pub use output::take_standard_output;
pub use write::{
    Content, end_now, is_waiting, refuse_unwritable, standard_output, unwritable_output, write_parts,
    write_whole,
};

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

/// A file without a name, for what need not stay in memory: it goes when it is dropped.
pub fn nameless() -> std::io::Result<std::fs::File> {
    tempfile::tempfile()
}

/// The program's folder within the user's cache folder, or that of temporary files where no home folder is known: what can be made
/// again. It need not exist.
pub fn cache_folder() -> PathBuf {
    let own = user_folder("XDG_CACHE_HOME", ".cache", "Library/Caches");
    own.unwrap_or_else(|| std::env::temp_dir().join("voltet"))
}

/// The program's folder within the user's state folder: what outlives a run and cannot be made again. It need not exist;
/// `None` where no home folder is known: others may write into a folder for all.
pub fn state_folder() -> Option<PathBuf> {
    user_folder("XDG_STATE_HOME", ".local/state", "Library/Application Support")
}

/// The program's folder within the user's configuration folder: what the user wrote. It need not exist;
/// `None` where no home folder is known: others may write into a folder for all.
pub fn configuration_folder() -> Option<PathBuf> {
    user_folder("XDG_CONFIG_HOME", ".config", "Library/Application Support")
}

/// The folder that a variable of the environment names. A relative path names another one in each folder and is ignored, as the XDG Base
/// Directory Specification requires.
fn folder_of_variable(name: &str) -> Option<PathBuf> {
    std::env::var_os(name).map(PathBuf::from).filter(|path| path.is_absolute())
}

/// The user's home folder, if the environment names one.
pub fn home_folder() -> Option<PathBuf> {
    folder_of_variable("HOME")
}

/// By the variable, or within the user's home, on macOS elsewhere.
fn user_folder(variable: &str, usual: &str, on_macos: &str) -> Option<PathBuf> {
    let set = folder_of_variable;
    let home =
        || home_folder().map(|home| home.join(if cfg!(target_os = "macos") { on_macos } else { usual }));
    let base = set(variable).or_else(|| set("LOCALAPPDATA")).or_else(home)?;
    Some(base.join("voltet"))
}

/// Names of what is in the folder of a path: where there is no such file, one of them may be meant.
pub fn names_beside(path: &Path) -> Vec<String> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    entries.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect()
}

/// A path to write, as people are told of it.
pub fn display_path(path: &Path) -> String {
    match path == Path::new(STDOUT) {
        true => "the standard output".into(),
        false => path.display().to_string(),
    }
}

/// A word as an argument of a command that is shown: quoted where a shell would take it apart, or read a sign in another way.
pub fn argument(word: impl AsRef<OsStr>) -> String {
    let text = word.as_ref().to_string_lossy();
    let is_plain = |c: char| c.is_alphanumeric() || "/._-+=:,@%".contains(c) || cfg!(windows) && c == '\\';
    match !text.is_empty() && text.chars().all(is_plain) {
        true => text.into_owned(),
        false => format!("'{}'", text.replace('\'', r"'\''")),
    }
}

/// True if a path by its words alone is the standard output or a device, which have no endings.
pub fn is_stream(path: &str) -> bool {
    path == STDOUT || path.starts_with("/dev/")
}

/// Hash that stays the same from build to build, for keys of files and for telling damage: FNV-1a of 128 bits (Fowler, Noll, Vo; RFC 9923).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Fnv(pub u128);

impl Default for Fnv {
    fn default() -> Self {
        Fnv(0x6c62_272e_07bb_0142_62b8_2175_6295_c58d)
    }
}

impl Fnv {
    /// Takes in bytes.
    pub fn bytes(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.0 = (self.0 ^ u128::from(byte)).wrapping_mul(0x0000_0000_0100_0000_0000_0000_0000_013b);
        }
    }

    /// Takes in a text with its length, so that two texts are not one.
    pub fn text(&mut self, text: &str) {
        self.bytes(&(text.len() as u64).to_le_bytes());
        self.bytes(text.as_bytes());
    }

    /// Takes in numbers, bit by bit.
    pub fn numbers(&mut self, numbers: &[f64]) {
        numbers.iter().for_each(|x| self.bytes(&x.to_bits().to_le_bytes()));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_argument_is_quoted_where_a_shell_would_read_it_in_another_way() {
        let plain = "a/b-c_1.5+x=y:z,@%";
        for (text, shown) in
            [(plain, plain), ("", "''"), ("a b", "'a b'"), ("it's", r"'it'\''s'"), ("$x", "'$x'")]
        {
            assert_eq!(argument(text), shown);
        }
        assert_eq!(argument(r"a\b"), if cfg!(windows) { r"a\b" } else { r"'a\b'" });
    }

    #[test]
    fn the_hash_is_the_published_one() {
        // RFC 9923 gives the value for no input (the basis) and for "a".
        let mut hash = Fnv::default();
        hash.bytes(b"a");
        assert_eq!(hash.0, 0xd228_cb69_6f1a_8caf_7891_2b70_4e4a_8964);
    }
}
