//! Files of an input of Nastran in the order of its entries: each file up to an INCLUDE, the file that this names, and what follows, up to
//! ENDDATA.
//!
//! Source: MSC Nastran quick reference guide, "INCLUDE": the name stands in quotes, within which it may go on over lines, or is a word.

use crate::formats::cursor::Cursor;
use crate::formats::source::Source;
use crate::formats::text::TextRange;
use crate::formats::xml::{beside, open_named};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use voltet_core::{Error, Result};

/// Files that may be included in all, and within one another.
const MAX_FILES: usize = 1 << 10;
const MAX_DEPTH: usize = 16;
/// Bytes of an INCLUDE within which its name ends.
const LONGEST: usize = 1 << 12;

/// An input with the files that it includes.
#[derive(Default)]
pub(super) struct Deck {
    /// Parts of files with entries, in order.
    pub parts: Vec<TextRange>,
    /// Files that were included.
    pub included: Vec<PathBuf>,
    /// Bytes of all files.
    pub file_bytes: u64,
    /// Files that are within one another, the first before those that it includes.
    open: Vec<PathBuf>,
    has_ended: bool,
}

impl Deck {
    /// Adds a file and those that it includes.
    pub fn add(&mut self, source: &Arc<Source>) -> Result<()> {
        let file = TextRange::new(source, 0..source.len());
        let mut places = Vec::new();
        file.each_piece(
            |rest| rest[0] == b'\n',
            |piece| {
                let marks =
                    piece.lines().filter(|line| starts_with(line, "INCLUDE") || starts_with(line, "ENDDATA"));
                Ok(marks.map(|line| piece.place(line)).collect::<Vec<_>>())
            },
            |found| {
                places.extend(found);
                Ok(true)
            },
        )?;
        self.file_bytes = self.file_bytes.saturating_add(source.len());
        self.open.push(source.path().to_owned());
        let mut begin = 0;
        for place in places {
            // A name that goes on over lines may look like another statement.
            if place < begin {
                continue;
            }
            self.parts.push(file.from(begin).until(place));
            let mut lines = Cursor::within(source, place, source.len(), 1);
            let name = name_of_included(&mut lines)?;
            begin = lines.position();
            let located = |error| file.locate(error, place).in_file(source.path());
            match name {
                Some(name) => self.include(&name, located)?,
                None => self.has_ended = true,
            }
            if self.has_ended {
                break;
            }
        }
        if !self.has_ended {
            self.parts.push(file.from(begin));
        }
        self.open.pop();
        Ok(())
    }

    /// Adds a file by its name in the last one.
    fn include(&mut self, name: &str, located: impl Fn(Error) -> Error) -> Result<()> {
        let by = self.open.last().cloned().unwrap_or_default();
        if name.is_empty() {
            let error = Error::run("an INCLUDE does not say which file it includes");
            return Err(located(error.expected("the name of a file in quotes")));
        }
        // A solver looks into the folder of the first file, too.
        let paths = [&by, &self.open[0]].map(|by| beside(by, name));
        let path = paths.iter().find(|path| path.exists()).unwrap_or(&paths[0]);
        let is_same =
            |other: &Path| path.canonicalize().ok().is_some_and(|own| other.canonicalize().ok() == Some(own));
        if self.open.iter().any(|open| is_same(open)) {
            let error = Error::run("a file includes itself").got(format_args!("'{name}'"));
            return Err(located(error.expected("files that do not lead back to one that includes them")));
        }
        if self.open.len() > MAX_DEPTH || self.included.len() == MAX_FILES {
            let error = Error::run("the file includes too many others").got(format_args!("'{name}'"));
            let expected = format!("at most {MAX_FILES}, {MAX_DEPTH} within one another");
            return Err(located(error.expected(expected)));
        }
        let source = open_named(&by, path, self.included.len())?;
        self.included.push(path.clone());
        self.add(&source).map_err(|error| error.in_file(path))
    }
}

/// True for a line that begins with a statement.
fn starts_with(line: &[u8], statement: &str) -> bool {
    let word = line.trim_ascii_start().get(..statement.len());
    word.is_some_and(|word| word.eq_ignore_ascii_case(statement.as_bytes()))
}

/// The name in the INCLUDE that begins here, empty where there is none; `None` for another statement.
fn name_of_included(lines: &mut Cursor) -> Result<Option<String>> {
    let mut text = String::new();
    while text.len() < LONGEST
        && let Some(line) = lines.line()?
    {
        text.push_str(String::from_utf8_lossy(line).trim());
        if !starts_with(text.as_bytes(), "INCLUDE") {
            return Ok(None);
        }
        let rest = text["INCLUDE".len()..].trim_start();
        let name = match rest.strip_prefix(['\'', '"']) {
            Some(quoted) => quoted.split_once(&rest[..1]).map(|(name, _)| name.trim()),
            None => rest.split([' ', '\t', '$']).next().filter(|word| !word.is_empty()),
        };
        if let Some(name) = name {
            return Ok(Some(name.to_owned()));
        }
    }
    Ok(Some(String::new()))
}
