//! Syntax tree of a TOML text: headers, assignments, keys, values, commas, each with its bytes.

use crate::path::{Path, Step};
use std::ops::Range;

/// The sections of a text in its order; the first is what stands before any header.
#[derive(Debug, Clone, Default)]
pub struct Syntax {
    /// The sections.
    pub sections: Vec<Section>,
}

/// A header and the assignments below it.
#[derive(Debug, Clone, Default)]
pub struct Section {
    /// Path of the table; entries of lists of tables have their numbers.
    pub path: Path,
    /// `[a.b]` or `[[a.b]]`; none for the first section.
    pub header: Option<Header>,
    /// Assignments of the table.
    pub assignments: Vec<Element>,
}

/// A header.
#[derive(Debug, Clone)]
pub struct Header {
    /// From the first bracket to after the last.
    pub span: Range<usize>,
    /// The places of its keys.
    pub keys: Vec<Key>,
}

/// A key.
#[derive(Debug, Clone, PartialEq)]
pub struct Key {
    /// Name without quotes.
    pub name: String,
    /// Bytes, with quotes.
    pub span: Range<usize>,
}

/// An assignment, an entry of an inline table, or one of a list (which has no keys).
#[derive(Debug, Clone)]
pub struct Element {
    /// Its keys: several where points are between them.
    pub keys: Vec<Key>,
    /// Its value.
    pub value: Value,
    /// The comma after it.
    pub comma: Option<usize>,
}

/// A value.
#[derive(Debug, Clone)]
pub struct Value {
    /// Bytes.
    pub span: Range<usize>,
    /// Kind of value.
    pub kind: ValueKind,
}

/// Kind of a value.
#[derive(Debug, Clone)]
pub enum ValueKind {
    /// A text, a number, a word.
    Scalar,
    /// `[…]`.
    List(Vec<Element>),
    /// `{…}`.
    Table(Vec<Element>),
}

impl Section {
    /// Start of the header or, of the first section, of the text.
    pub fn start(&self) -> usize {
        self.header.as_ref().map_or(0, |header| header.span.start)
    }

    /// End of its last token.
    pub fn end(&self) -> usize {
        let header = self.header.as_ref().map_or(0, |header| header.span.end);
        self.assignments.last().map_or(header, |last| last.value.span.end)
    }
}

impl Element {
    /// From its first key, or its value, to the end of its value.
    pub fn span(&self) -> Range<usize> {
        self.keys.first().map_or(self.value.span.start, |key| key.span.start)..self.value.span.end
    }

    /// Its keys as a path.
    pub fn path(&self) -> impl Iterator<Item = Step> + '_ {
        self.keys.iter().map(|key| Step::Key(key.name.clone()))
    }
}

impl Value {
    /// True if its elements have numbers.
    pub fn is_list(&self) -> bool {
        matches!(self.kind, ValueKind::List(_))
    }

    /// Its elements; none of a scalar.
    pub fn elements(&self) -> &[Element] {
        match &self.kind {
            ValueKind::Scalar => &[],
            ValueKind::List(elements) | ValueKind::Table(elements) => elements,
        }
    }
}
