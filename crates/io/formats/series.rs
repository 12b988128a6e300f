//! Series of files (`.vtu.series`, `.vtk.series`, …): JSON that names a file for each time, as ParaView writes it.

use super::request::Request;
use super::source::{HEAD, Source};
use super::xml::{beside, open_named};
use serde::Deserialize;
use std::path::{Path, PathBuf};
use voltet_core::{Error, Result};

/// The key that writers put first.
const KEY: &[u8] = b"file-series-version";

/// A byte order mark in UTF-8.
const MARK: &[u8] = b"\xef\xbb\xbf";

/// True if a file is a series by its name, or by how it begins.
pub(super) fn is_series(head: &[u8], path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("series"))
        || head.strip_prefix(MARK).unwrap_or(head).starts_with(b"{")
            && head.windows(KEY.len()).any(|window| window == KEY)
}

#[derive(Deserialize)]
struct Series {
    files: Vec<Entry>,
}

#[derive(Deserialize)]
struct Entry {
    name: String,
    #[serde(default)]
    time: f64,
}

/// Its entries by ascending time.
fn entries(source: &Source) -> Result<Vec<Entry>> {
    let bytes = source.read(0, source.len())?;
    let text = bytes.strip_prefix(MARK).unwrap_or(&bytes);
    let series: Series = serde_json::from_slice(text).map_err(|error| {
        Error::run("the series is damaged")
            .got(error)
            .expected("\"files\": [{ \"name\": …, \"time\": … }, …]")
    })?;
    let mut entries = series.files;
    if entries.is_empty() {
        return Err(Error::run("the series is empty").expected("at least one file"));
    }
    entries.sort_by(|a, b| a.time.total_cmp(&b.time));
    Ok(entries)
}

pub(super) struct SeriesStep {
    /// The file of its data.
    pub path: PathBuf,
    /// Times of all steps, ascending.
    pub times: Vec<f64>,
}

pub(super) fn step(source: &Source, request: &Request) -> Result<SeriesStep> {
    let entries = entries(source)?;
    let times: Vec<f64> = entries.iter().map(|entry| entry.time).collect();
    let path = beside(source.path(), &entries[request.step_index(&times)?].name);
    if is_series(&open_named(source.path(), &path, 0)?.head(HEAD)?, &path) {
        return Err(Error::run("a series names another").got(path.display()).expected("files of data"));
    }
    Ok(SeriesStep { path, times })
}

/// The files that a series names, of every step or of that asked for; none for other files.
pub(super) fn files_named(path: &Path, request: Option<&Request>) -> Vec<PathBuf> {
    let Some(source) = Source::open_if(path, |head| is_series(head, path)) else { return Vec::new() };
    let Ok(entries) = entries(&source) else { return Vec::new() };
    let times: Vec<f64> = entries.iter().map(|entry| entry.time).collect();
    let step = request.and_then(|request| request.step_index(&times).ok());
    let is_named = |&(index, _): &(usize, &Entry)| step.is_none_or(|step| step == index);
    entries.iter().enumerate().filter(is_named).map(|(_, entry)| beside(path, &entry.name)).collect()
}
