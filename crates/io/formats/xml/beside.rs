//! The files that a file of these formats names, found from heads alone.

use super::header::{self, Element};
use super::series;
use crate::formats::request::Request;
use crate::formats::source::Source;
use std::path::{Path, PathBuf};

/// The files that a series (of every step, or of that asked for) or a parallel file names, and those that these name; none for
/// files of other kinds, of which no more than the head is read.
pub(in crate::formats) fn all(path: &Path, request: Option<&Request>) -> Vec<PathBuf> {
    by_file(path, &MARKS, request)
}

/// Files that a file of one of these kinds names.
fn by_file(path: &Path, marks: &[&str], request: Option<&Request>) -> Vec<PathBuf> {
    let Ok(source) = Source::open(path) else { return Vec::new() };
    let head = source.head(HEAD).unwrap_or_default();
    let names_others = |mark: &[u8]| head.windows(mark.len()).any(|window| window == mark);
    if !head.trim_ascii_start().starts_with(b"<") || !marks.iter().any(|mark| names_others(mark.as_bytes())) {
        return Vec::new();
    }
    let Ok((root, _)) = header::read(&source) else { return Vec::new() };
    let folder = path.parent().unwrap_or(Path::new(""));
    // A series may name parallel files; these name no further ones.
    let is_series = root.attribute("type") == Some(SERIES);
    let mut names = Vec::new();
    match request.filter(|_| is_series) {
        Some(request) => names.extend(series::files_of_step(&root, request).unwrap_or_default()),
        None => names_below(&root, &mut names),
    }
    let paths: Vec<PathBuf> = names.into_iter().map(|name| folder.join(name)).collect();
    let further = paths.iter().filter(|_| is_series).flat_map(|path| by_file(path, &MARKS[1..], None));
    let further: Vec<PathBuf> = further.collect();
    paths.into_iter().chain(further).collect()
}

/// Bytes of a file within which its kind stands.
const HEAD: u64 = 1024;
/// The kinds that name others, as every writer spells them.
const MARKS: [&str; 2] = ["type=\"Collection\"", "type=\"P"];
const SERIES: &str = "Collection";

fn names_below<'a>(element: &'a Element, names: &mut Vec<&'a str>) {
    names.extend(["file", "Source"].iter().filter_map(|name| element.attribute(name)));
    element.children.iter().for_each(|child| names_below(child, names));
}
