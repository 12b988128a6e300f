//! The error type of all crates: message, value found, value expected, and location.
//!
//! The place is added on the way out, once, by whoever knows it (`in_file`, `at_node`, …). A message that is
//! shown to a person is [`Error`]'s `Display`: `what: found …; expected … (at …)`.

use crate::nearest::{nearest_first, suggest};
use std::fmt;

/// Result of the library.
pub type Result<T> = std::result::Result<T, Error>;

/// Category of an error, by which callers tell what to do about it; the program's exit code is 2 for the user's mistake, else 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum ErrorKind {
    /// The command line or the pipeline file is wrong.
    Usage,
    /// The run failed (a data file is damaged, an output cannot be written, memory ends).
    Run,
    /// The user stopped the run.
    Cancelled,
    /// One tile of a picture has more cells than a device holds or sorts; in a picture of more pixels a tile has fewer.
    CrowdedTile,
    /// Another of several processes failed, and shows why.
    OtherProcess,
    /// A mistake of the program itself.
    Panic,
}

/// A change that would mend a mistake.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum Remedy {
    /// A picture of fewer pixels, which may succeed.
    FewerPixels,
    /// Another name: those that are known, the nearest first.
    Names(Vec<String>),
    /// A node that feeds this input.
    Input(&'static str),
}

impl Remedy {
    /// Names that are known, the nearest first.
    pub fn names<'a>(names: impl IntoIterator<Item = &'a str>) -> Self {
        Remedy::Names(names.into_iter().map(str::to_string).collect())
    }
}

/// Location of an error, from the outermost to the innermost place known.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Location {
    /// The file, as the user wrote its path.
    pub file: Option<String>,
    /// Byte range in the text of `file` (pipeline files), for a caret.
    pub span: Option<std::ops::Range<usize>>,
    /// 1-based line and column in `file`.
    pub line_column: Option<(usize, usize)>,
    /// Name of the node in the pipeline.
    pub node: Option<String>,
    /// Name of the port, parameter, array or element concerned.
    pub item: Option<String>,
}

/// Error with its cause, the offending value, the expected value and its location.
#[derive(Debug, Clone, thiserror::Error)]
pub struct Error {
    /// Category.
    pub kind: ErrorKind,
    /// Statement of the mistake, one clause without a full stop.
    pub what: String,
    /// Offending value, if there is one to show.
    pub got: Option<String>,
    /// Valid values.
    pub expected: Option<String>,
    /// Location.
    pub location: Box<Location>,
    /// Change that would mend it, where a program can offer one.
    pub remedy: Option<Box<Remedy>>,
}

impl Error {
    /// A mistake in the command or in a pipeline file.
    pub fn usage(what: impl Into<String>) -> Self {
        Self::new(ErrorKind::Usage, what)
    }

    /// A failure of the run.
    pub fn run(what: impl Into<String>) -> Self {
        Self::new(ErrorKind::Run, what)
    }

    /// The user stopped the run.
    pub fn cancelled() -> Self {
        Self::new(ErrorKind::Cancelled, "the run was stopped")
    }

    /// An error of a category.
    pub fn new(kind: ErrorKind, what: impl Into<String>) -> Self {
        Error {
            kind,
            what: without_number(what.into()),
            got: None,
            expected: None,
            location: Box::default(),
            remedy: None,
        }
    }

    /// Adds what was found.
    pub fn got(mut self, found: impl fmt::Display) -> Self {
        self.got = Some(without_number(found.to_string()));
        self
    }

    /// Adds what would be right: a clause that can follow "expected".
    pub fn expected(mut self, accepted: impl fmt::Display) -> Self {
        self.expected = Some(accepted.to_string());
        self
    }

    /// Adds a change that would mend it.
    pub fn with_remedy(mut self, remedy: Remedy) -> Self {
        self.remedy = Some(Box::new(remedy));
        self
    }

    /// Adds what would be right where `name` is not one of the names that are known: [`suggest`].
    pub fn not_among<'a>(self, name: &str, known: impl IntoIterator<Item = &'a str>) -> Self {
        let known: Vec<&str> = known.into_iter().collect();
        let accepted = suggest(name, known.iter().copied());
        self.expected(accepted).with_remedy(Remedy::names(nearest_first(name, known)))
    }

    /// Adds that an input is missing, and what else would be right: "", or a clause that follows.
    pub fn needs_input(self, port: &'static str, or: &str) -> Self {
        self.expected(format!("inputs = {{ {port} = \"NODE\" }}{or}")).with_remedy(Remedy::Input(port))
    }

    /// Names the file, unless an inner place named one already.
    pub fn in_file(mut self, file: impl AsRef<std::path::Path>) -> Self {
        self.location.file.get_or_insert_with(|| file.as_ref().display().to_string());
        self
    }

    /// Points at a byte range of `text`, the content of the file, unless something is pointed at already.
    pub fn at_span(mut self, text: &str, span: std::ops::Range<usize>) -> Self {
        if self.location.span.is_none() {
            let before = &text[..span.start.min(text.len())];
            let line = before.matches('\n').count() + 1;
            let column = before.rsplit('\n').next().unwrap_or("").chars().count() + 1;
            self.location.line_column = Some((line, column));
            self.location.span = Some(span);
        }
        self
    }

    /// Names the line (1-based) of the file.
    pub fn at_line(mut self, line: usize) -> Self {
        self.location.line_column.get_or_insert((line, 1));
        self
    }

    /// Names the node of the pipeline.
    pub fn at_node(mut self, node: impl Into<String>) -> Self {
        self.location.node.get_or_insert_with(|| node.into());
        self
    }

    /// Names the port, parameter, array or element.
    pub fn at_item(mut self, item: impl Into<String>) -> Self {
        self.location.item.get_or_insert_with(|| item.into());
        self
    }
}

/// Words of an error of the system, without its number: "no such file or directory".
pub fn system_words(error: &std::io::Error) -> String {
    without_number(error.to_string())
}

/// A message in which texts of the system, such as "No such file or directory (os error 2)", lose number and capital; all else stays.
fn without_number(mut message: String) -> String {
    const NUMBER: &str = " (os error ";
    let mut from = 0;
    while let Some(at) = message[from..].find(NUMBER).map(|at| from + at) {
        from = at + NUMBER.len();
        let number = message[from..].split(')').next().and_then(|number| number.parse().ok());
        let Some(number) = number else { continue };
        let text = std::io::Error::from_raw_os_error(number).to_string();
        let Some(words) = text.find(NUMBER).filter(|words| message[..at].ends_with(&text[..*words])) else {
            continue;
        };
        let begin = at - words;
        if message[begin..].starts_with(&text) {
            message.replace_range(at..begin + text.len(), "");
            message[begin..].get_mut(..1).into_iter().for_each(str::make_ascii_lowercase);
            from = at;
        }
    }
    message
}

impl From<std::io::Error> for Error {
    fn from(error: std::io::Error) -> Self {
        Self::run(error.to_string())
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.what)?;
        if let Some(found) = &self.got {
            write!(f, ": found {found}")?;
        }
        if let Some(accepted) = &self.expected {
            write!(f, "; expected {accepted}")?;
        }
        let place = &self.location;
        let mut parts = Vec::new();
        if let Some(file) = &place.file {
            parts.push(match place.line_column {
                Some((line, column)) => format!("{file}:{line}:{column}"),
                None => file.clone(),
            });
        }
        if let Some(node) = &place.node {
            parts.push(format!("node '{node}'"));
        }
        if let Some(item) = &place.item {
            parts.push(format!("'{item}'"));
        }
        if !parts.is_empty() {
            write!(f, " ({})", parts.join(", "))?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_of_the_system_has_words_and_no_number() {
        let error = || std::io::Error::from_raw_os_error(2);
        let words = error().to_string();
        let words = words.strip_suffix(" (os error 2)").expect("a number").to_lowercase();
        assert_eq!(Error::from(error()).to_string(), words);
        assert_eq!(Error::run("unreadable").got(error()).to_string(), format!("unreadable: found {words}"));
        let twice = format!("Reading: {}; writing: {}", error(), error());
        assert_eq!(Error::run(twice).to_string(), format!("Reading: {words}; writing: {words}"));
        assert_eq!(system_words(&error()), words);
        // Words that are not the system's stay, such as a name.
        for name in ["A (os error", "Reading: 'A: B (os error 2).vtu'", "Bad: Z (os error x)", "(os error 2)"]
        {
            assert_eq!(Error::run(name).to_string(), name);
        }
    }
}
