//! Identity of the file behind a path, however the path is spelled.

use crate::output;
use std::path::{Path, PathBuf};

/// The path of the standard output. A file of that name is `./-`.
pub const STDOUT: &str = "-";

/// More links than this from one to the next are a ring: what Linux allows.
const MAX_LINKS: usize = 40;

/// Identity of a file: equal for two paths where data written to one shows at the other.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub enum FileIdentity {
    /// The standard output, where that is a terminal or another device.
    StandardOutput,
    /// A file that is there, by the numbers of its device and of itself.
    #[cfg(unix)]
    Numbers(u64, u64),
    /// A file that is not there yet, or is known by its path alone: the path without links.
    Path(PathBuf),
}

impl FileIdentity {
    /// Identity of the file at a path; `None` for devices (`/dev/null`), which keep nothing that could be lost.
    pub fn from_path(path: &Path) -> Option<FileIdentity> {
        if names_standard_output(path) {
            let there = standard_output().and_then(|metadata| Self::there(&metadata, path));
            return Some(there.unwrap_or(FileIdentity::StandardOutput));
        }
        match std::fs::metadata(path) {
            Ok(metadata) => Self::there(&metadata, path),
            Err(_) => Some(FileIdentity::Path(without_links(&followed(path)))),
        }
    }

    #[cfg(unix)]
    fn there(metadata: &std::fs::Metadata, _path: &Path) -> Option<FileIdentity> {
        use std::os::unix::fs::{FileTypeExt, MetadataExt};
        let is_device = metadata.file_type().is_char_device();
        (!is_device).then(|| FileIdentity::Numbers(metadata.dev(), metadata.ino()))
    }

    #[cfg(not(unix))]
    fn there(_metadata: &std::fs::Metadata, path: &Path) -> Option<FileIdentity> {
        Some(FileIdentity::Path(without_links(path)))
    }
}

/// True if a path is the standard output, by its own name, by another or by a link.
pub fn is_standard_output(path: &Path) -> bool {
    names_standard_output(path)
        || FileIdentity::from_path(path)
            .is_some_and(|meant| FileIdentity::from_path(Path::new(STDOUT)) == Some(meant))
}

/// True if a path or one that its links lead to is a name of descriptor 1, which may be another file's now.
fn names_standard_output(path: &Path) -> bool {
    let mut path = path.to_path_buf();
    for _ in 0..MAX_LINKS {
        let names = [STDOUT, "/dev/stdout", "/dev/fd/1", "/proc/self/fd/1"];
        if names.iter().any(|name| path == Path::new(name)) {
            return true;
        }
        let Ok(link) = std::fs::read_link(&path) else { return false };
        path = folder(&path).join(link);
    }
    false
}

/// Metadata of the standard output's target, where the system reports it.
fn standard_output() -> Option<std::fs::Metadata> {
    match output::private() {
        Some(own) => own.metadata().ok(),
        None => cfg!(unix).then(|| std::fs::metadata("/dev/stdout").ok())?,
    }
}

/// The path that symbolic links lead to from here, whether or not there is something.
pub(super) fn followed(path: &Path) -> PathBuf {
    let mut path = path.to_path_buf();
    for _ in 0..MAX_LINKS {
        let Ok(link) = std::fs::read_link(&path) else { break };
        path = folder(&path).join(link);
    }
    path
}

/// The folder without links, and the name in it; the path as it is where there is no such folder.
fn without_links(path: &Path) -> PathBuf {
    let folder = std::fs::canonicalize(folder(path)).ok();
    folder.zip(path.file_name()).map_or_else(|| path.to_path_buf(), |(folder, name)| folder.join(name))
}

/// A file that is read or written, by whom does not matter here.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Use {
    /// The path.
    pub path: PathBuf,
    /// True if it is written; it is read otherwise.
    pub written: bool,
}

/// The first of these that writes a file which another one reads or writes, and that other one, by their places.
pub fn collision(uses: &[Use]) -> Option<[usize; 2]> {
    let meant: Vec<Option<FileIdentity>> =
        uses.iter().map(|one| FileIdentity::from_path(&one.path)).collect();
    let same = |a: usize, b: usize| a != b && meant[a].is_some() && meant[a] == meant[b];
    let before_others = |a: usize, b: usize| !uses[b].written || b < a;
    (0..uses.len()).filter(|&a| uses[a].written).find_map(|a| {
        let other = (0..uses.len()).find(|&b| same(a, b) && before_others(a, b))?;
        Some([a, other])
    })
}

/// The folder that a file lies in.
pub fn folder(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

/// Path from `folder` to the file at `path`, which need not exist: a relative path where both lie in a folder
/// other than the root, else by the whole path; as it is where its folder is not there.
pub fn relative_to(path: &Path, folder: &Path) -> PathBuf {
    let own = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let there = std::fs::canonicalize(path).unwrap_or_else(|_| without_links(path));
    let Ok(own) = std::fs::canonicalize(own) else { return path.to_path_buf() };
    let shared = there.components().zip(own.components()).take_while(|(a, b)| a == b);
    let has_home = shared.into_iter().any(|(part, _)| matches!(part, std::path::Component::Normal(_)));
    match voltet_graph::relative_path(&own, &there).filter(|_| has_home) {
        Some(way) => PathBuf::from(way),
        None => there,
    }
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use std::fs;
    use std::os::unix::fs::symlink;

    fn collides(a: &Path, b: &Path) -> bool {
        let of = |path: &Path, written| Use { path: path.into(), written };
        let both = [of(a, false), of(b, true)];
        assert_eq!(collision(&both).is_some(), collision(&[of(a, true), of(b, true)]).is_some());
        collision(&both).is_some()
    }

    #[test]
    fn one_file_is_known_by_every_spelling() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::create_dir(at("in")).unwrap();
        for name in ["a", "b"] {
            fs::write(at(name), "").unwrap();
        }
        fs::hard_link(at("a"), at("hard")).unwrap();
        symlink("a", at("soft")).unwrap();
        symlink("in", at("into")).unwrap();
        symlink("into/later", at("dangling")).unwrap();
        symlink("dangling", at("twice")).unwrap();
        symlink("ring", at("ring")).unwrap();
        for (one, other) in [
            ("a", "./a"),
            ("a", "in/../a"),
            ("a", "hard"),
            ("soft", "hard"),
            ("in/later", "into/later"),
            ("in/later", "dangling"),
            ("into/../in/later", "twice"),
            ("ring", "ring"),
            ("not/there", "not/there"),
        ] {
            assert!(collides(&at(one), &at(other)), "{one} {other}");
        }
        for (one, other) in [("a", "b"), ("soft", "b"), ("in/later", "later"), ("ring", "a")] {
            assert!(!collides(&at(one), &at(other)), "{one} {other}");
        }
        assert!(collides(Path::new("-"), Path::new("-")));
        assert!(!collides(Path::new("/dev/null"), Path::new("/dev/null")));
        assert!(!collides(Path::new("-"), &at("-")));
    }

    #[test]
    fn a_file_is_named_from_a_folder() {
        let whole = tempfile::tempdir().unwrap();
        let home = whole.path().canonicalize().unwrap();
        fs::create_dir_all(home.join("a/b")).unwrap();
        fs::write(home.join("a/data.vtu"), "").unwrap();
        let named = |path: &str, folder: &str| relative_to(&home.join(path), &home.join(folder));
        assert_eq!(named("a/data.vtu", "a"), Path::new("data.vtu"));
        assert_eq!(named("a/data.vtu", "a/b"), Path::new("../data.vtu"));
        assert_eq!(named("a/b/../data.vtu", "."), Path::new("a/data.vtu"));
        assert_eq!(named("a/not_yet.png", "a/b"), Path::new("../not_yet.png"));
        // Nothing but the root is shared.
        assert_eq!(relative_to(Path::new("/dev/null"), &home), Path::new("/dev/null"));
        assert_eq!(relative_to(Path::new("/dev/null"), Path::new("/no/such/folder")), Path::new("/dev/null"));
    }

    #[test]
    fn what_is_only_read_never_collides() {
        let read = Use { path: "a".into(), written: false };
        assert_eq!(collision(&[read.clone(), read.clone()]), None);
        let written = Use { written: true, ..read.clone() };
        assert_eq!(collision(&[written, read]), Some([0, 1]));
    }
}
