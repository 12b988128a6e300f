//! Origins of values, for the record that is written with them: cameras, units, files, and the text that the graph was made from.

use std::ops::Range;
use std::path::{Component, Path, PathBuf};
use std::sync::Arc;
use voltet_core::camera::Camera;
use voltet_core::field::Plugin;
use voltet_core::parameters::{NamedPath, ParameterValue, SourceSpan};

/// State of a file: its length and the time it was last written, or nothing where it is not there.
pub type Stamp = Option<(u64, std::time::SystemTime)>;

/// Finds the state of a file.
pub type FileStamp = fn(&Path) -> Stamp;

/// Origins of the values that some nodes gave.
#[derive(Debug, Clone, Default)]
pub struct Origins {
    /// The cameras, each with the node that gives it.
    pub cameras: Vec<(String, Arc<Camera>)>,
    /// The unit distances of transfer functions (world units), each with the node that gives it. `None`: one that the data
    /// decides, of no data.
    pub unit_distances: Vec<(String, Option<f64>)>,
    /// The files that parameters name to be read.
    pub files: Vec<FileRead>,
    /// The plug-ins that gradient filters came from, each with the node that names the filter.
    pub plugins: Vec<(String, Plugin)>,
}

/// A file that was read.
#[derive(Debug, Clone)]
pub struct FileRead {
    /// The node that read it.
    pub node: String,
    /// The path as it was given, and by which parameter.
    pub named: NamedPath,
    /// The path from where the program runs.
    pub path: PathBuf,
    /// Its state before it was read.
    pub stamp: Stamp,
    /// The files that were read beside it: pieces, the file of a step.
    pub beside: Vec<(PathBuf, Stamp)>,
    /// The files of other steps of its series that values depend on: numbers relative to a series.
    pub other_steps: Vec<(PathBuf, Stamp)>,
}

/// The text of a pipeline file with every option carried out: it makes the same graph again.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ResolvedPipeline {
    /// The title, for people.
    pub title: Option<String>,
    /// The text; empty for a graph that no text states.
    pub text: String,
    /// The paths within it that are relative to its folder, each with its place.
    paths: Vec<(Range<usize>, String)>,
}

impl ResolvedPipeline {
    /// `named`: the files that this very text names, with their places in it.
    pub fn new(
        title: Option<String>,
        text: String,
        named: impl Iterator<Item = NamedPath>,
    ) -> ResolvedPipeline {
        let relative = |named: NamedPath| match named.origin {
            SourceSpan::Span(place) if named.is_relative() => Some((place, named.path)),
            _ => None,
        };
        let mut paths: Vec<(Range<usize>, String)> = named.filter_map(relative).collect();
        paths.sort_by_key(|(place, _)| place.start);
        ResolvedPipeline { title, text, paths }
    }

    /// The text for a file that lies in the folder `from` instead of `folder`: its relative paths lead to the same files.
    /// Both folders are absolute and without links.
    pub fn moved(&self, folder: &Path, from: &Path) -> String {
        let (mut text, mut copied) = (String::with_capacity(self.text.len()), 0);
        for (place, path) in &self.paths {
            if let Some(path) =
                relative_path(from, &joined(folder, Path::new(path))).filter(|_| place.start >= copied)
            {
                text += &self.text[copied..place.start];
                text += &ParameterValue::Text(path).to_string();
                copied = place.end;
            }
        }
        text + &self.text[copied..]
    }
}

/// The path within a folder; steps up are taken off the folder, which has no links.
fn joined(folder: &Path, path: &Path) -> PathBuf {
    let mut whole = folder.to_path_buf();
    let mut parts = path.components().peekable();
    while let Some(Component::ParentDir | Component::CurDir) = parts.peek() {
        if parts.next() == Some(Component::ParentDir) {
            whole.pop();
        }
    }
    whole.extend(parts);
    whole
}

/// The relative path, with slashes, from a folder to `to`. `None` where there is none (another drive),
/// or a name is not Unicode.
pub fn relative_path(from: &Path, to: &Path) -> Option<String> {
    let shared = from.components().zip(to.components()).take_while(|(a, b)| a == b).count();
    if shared == 0 {
        return None;
    }
    let up = from.components().skip(shared).map(|_| Some(".."));
    let down = to.components().skip(shared).map(|name| name.as_os_str().to_str());
    let parts: Vec<&str> = up.chain(down).collect::<Option<_>>()?;
    Some(if parts.is_empty() { ".".into() } else { parts.join("/") })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_way_leads_up_to_what_is_shared_and_down_again() {
        let way = |from: &str, to: &str| relative_path(Path::new(from), Path::new(to));
        assert_eq!(way("/a/b", "/a/c/d.vtu").as_deref(), Some("../c/d.vtu"));
        assert_eq!(way("/a/b", "/a/b").as_deref(), Some("."));
        assert_eq!(way("/a/b/c", "/a").as_deref(), Some("../.."));
        assert_eq!(way("a", "/a"), None);
    }

    #[test]
    fn steps_up_are_taken_off_the_folder_and_others_kept() {
        let joined = |path: &str| joined(Path::new("/a/b"), Path::new(path));
        assert_eq!(joined("../c.vtu"), Path::new("/a/c.vtu"));
        assert_eq!(joined("./../../../c.vtu"), Path::new("/c.vtu"));
        // What "link" is, is not known here.
        assert_eq!(joined("link/../c.vtu"), Path::new("/a/b/link/../c.vtu"));
    }
}
