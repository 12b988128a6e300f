//! Files of an input of Nastran in the order of its entries: each file up to an INCLUDE, the file that this names, and what follows, up to
//! ENDDATA.
//!
//! Source: MSC Nastran quick reference guide, "INCLUDE": the name stands in quotes, within which it may go on over lines, or is a word.

use crate::formats::cursor::Cursor;
use crate::formats::named_files::IncludedFiles;
use crate::formats::source::Source;
use crate::formats::text::TextRange;
use crate::formats::xml::beside;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use voltet_core::{Error, Result};

/// The statement that names a file, and what may stand round the name.
const STATEMENT: &str = "INCLUDE";
const QUOTES: [char; 2] = ['\'', '"'];
/// Bytes of a name in quotes within which it ends.
const LONGEST: usize = 1 << 12;

/// An input with the files that it includes.
pub(super) struct Deck {
    /// Parts of files with entries, in order.
    pub parts: Vec<TextRange>,
    pub included: IncludedFiles,
    /// Files that are within one another, the first before those that it includes.
    open: Vec<PathBuf>,
    has_ended: bool,
}

impl Deck {
    /// Without entries yet.
    pub fn new(first: &Source) -> Deck {
        Deck { parts: Vec::new(), included: IncludedFiles::new(first), open: Vec::new(), has_ended: false }
    }

    /// Adds a file and those that it includes.
    pub fn add(&mut self, source: &Arc<Source>) -> Result<()> {
        let file = TextRange::new(source, 0..source.len());
        let mut places = Vec::new();
        file.each_piece(
            |rest| rest[0] == b'\n',
            |piece| {
                let marks =
                    piece.lines().filter(|line| starts_with(line, STATEMENT) || starts_with(line, "ENDDATA"));
                Ok(marks.map(|line| piece.place(line)).collect::<Vec<_>>())
            },
            |found| {
                places.extend(found);
                Ok(true)
            },
        )?;
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
        let counted = self.included.count(path, self.open.len());
        counted.map_err(|error| located(error.got(format_args!("'{name}'"))))?;
        match self.included.open(&by, path)? {
            Some(source) => self.add(&source).map_err(|error| error.in_file(path)),
            None => Ok(()),
        }
    }
}

fn starts_with(line: &[u8], statement: &str) -> bool {
    let word = line.trim_ascii_start().get(..statement.len());
    word.is_some_and(|word| word.eq_ignore_ascii_case(statement.as_bytes()))
}

/// The name in the INCLUDE that begins here, empty where there is none; `None` for another statement. Names without quotes stand in its
/// own line; those in quotes may begin behind comments and blank lines, and go on over lines.
fn name_of_included(lines: &mut Cursor) -> Result<Option<String>> {
    let first = match lines.line()? {
        Some(line) if starts_with(line, STATEMENT) => String::from_utf8_lossy(line).into_owned(),
        _ => return Ok(None),
    };
    let mut text = without_comment(&first.trim_start()[STATEMENT.len()..]).to_owned();
    if !text.is_empty() && !text.starts_with(QUOTES) {
        return Ok(text.split_ascii_whitespace().next().map(str::to_owned));
    }
    loop {
        // Within quotes all letters are of the name.
        if let Some(quote) = text.chars().next()
            && let Some((name, _)) = text[1..].split_once(quote)
        {
            return Ok(Some(name.trim().to_owned()));
        }
        let Some(line) = lines.line()?.filter(|_| text.len() < LONGEST) else { break };
        let line = String::from_utf8_lossy(line);
        let more = if text.is_empty() { without_comment(&line) } else { line.trim() };
        if text.is_empty() && !more.is_empty() && !more.starts_with(QUOTES) {
            break;
        }
        text.push_str(more);
    }
    Ok(Some(String::new()))
}

/// A line before its comment and without white space round it; all of one that begins with a quote.
fn without_comment(line: &str) -> &str {
    let line = line.trim();
    if line.starts_with(QUOTES) { line } else { line.split('$').next().unwrap_or_default().trim_end() }
}
