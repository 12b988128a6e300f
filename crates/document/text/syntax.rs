//! Syntax tree of a TOML text: headers, assignments, keys, values, commas, each with its bytes; read by the events of the TOML
//! parser, and searched by paths.

use super::lines;
use crate::path::{Path, Step};
use std::collections::HashMap;
use std::ops::Range;
use toml_parser::parser::{Event, EventKind, parse_document};
use toml_parser::{Raw, Source};
use voltet_core::{Error, Result};

/// The sections of a text in its order; the first is what stands before any header.
#[derive(Debug, Clone, Default)]
pub struct Syntax {
    pub sections: Vec<Section>,
}

/// A header and the assignments below it.
#[derive(Debug, Clone, Default)]
pub struct Section {
    /// Path of the table; entries of lists of tables have their numbers.
    pub path: Path,
    /// `[a.b]` or `[[a.b]]`; none for the first section.
    pub header: Option<Header>,
    pub assignments: Vec<Element>,
}

#[derive(Debug, Clone)]
pub struct Header {
    /// From the first bracket to after the last.
    pub span: Range<usize>,
    pub keys: Vec<Key>,
}

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
    pub value: Value,
    /// The comma after it.
    pub comma: Option<usize>,
}

#[derive(Debug, Clone)]
pub struct Value {
    pub span: Range<usize>,
    pub kind: ValueKind,
}

/// Kind of a value.
#[derive(Debug, Clone)]
pub enum ValueKind {
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

/// Result of a search.
#[derive(Debug)]
pub enum Match<'a> {
    /// A value that is written in one place.
    Value(InsertionPoint<'a>),
    /// A table, or a list of tables, that headers and keys with points make together.
    Pieces(Vec<Piece>),
    Nothing,
}

/// An element and what holds it.
#[derive(Debug, Clone, Copy)]
pub struct InsertionPoint<'a> {
    pub element: &'a Element,
    /// The inline list or table that holds it and its number there; none for an assignment on lines of its own.
    pub holder: Option<(&'a Value, usize)>,
    /// The section and, of an assignment on lines of its own, its number there.
    pub section: usize,
    /// The number of the assignment in its section that holds it or is it.
    pub assignment: usize,
}

/// A part of a table that is written in several.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Piece {
    /// A section: its header and all below it.
    Section(usize),
    /// An assignment with points in a section that holds more.
    Assignment(usize, usize),
}

impl Piece {
    pub fn section(&self) -> Option<usize> {
        match self {
            Piece::Section(i) => Some(*i),
            Piece::Assignment(..) => None,
        }
    }
}

enum PathMatch {
    /// The path ends within or at the longer one.
    Within,
    /// The path goes on for so many steps.
    Beyond(usize),
    Elsewhere,
}

/// Relation of `path` to paths that begin with `start`, whose steps a function compares.
fn match_path<T>(path: &[Step], start: &[T], is_same: impl Fn(&Step, &T) -> bool) -> PathMatch {
    let shared = path.iter().zip(start).take_while(|(a, b)| is_same(a, b)).count();
    match (shared == path.len(), shared == start.len()) {
        (true, _) => PathMatch::Within,
        (false, true) => PathMatch::Beyond(path.len() - shared),
        (false, false) => PathMatch::Elsewhere,
    }
}

impl Syntax {
    /// Reads a text that is valid TOML; of another, what can be read.
    pub fn read(text: &str) -> Syntax {
        let tokens = Source::new(text).lex().into_vec();
        let mut events: Vec<Event> = Vec::with_capacity(tokens.len());
        parse_document(&tokens, &mut events, &mut ());
        let blank = |kind| matches!(kind, EventKind::Whitespace | EventKind::Comment | EventKind::Newline);
        events.retain(|event| !blank(event.kind()));
        let mut reader = Reader { text, events: &events, next: 0, counts: HashMap::new() };
        let mut sections = vec![Section::default()];
        while let Some(event) = reader.take() {
            match event.kind() {
                EventKind::StdTableOpen | EventKind::ArrayTableOpen => sections.push(reader.header(event)),
                EventKind::SimpleKey => {
                    if let (Some(element), Some(section)) = (reader.assignment(event), sections.last_mut()) {
                        section.assignments.push(element);
                    }
                }
                _ => {}
            }
        }
        Syntax { sections }
    }

    /// Finds the part at a path. Errors: a table made by dotted keys within a value, which no edit changes.
    pub fn find(&self, path: &[Step]) -> Result<Match<'_>> {
        let mut pieces = Vec::new();
        for (i, section) in self.sections.iter().enumerate() {
            let rest = match match_path(path, &section.path.0, |a, b| a == b || a.key() == b.key()) {
                PathMatch::Elsewhere => continue,
                PathMatch::Within if section.header.is_some() => {
                    pieces.push(Piece::Section(i));
                    continue;
                }
                PathMatch::Within => path,
                PathMatch::Beyond(steps) => &path[path.len() - steps..],
            };
            for (k, element) in section.assignments.iter().enumerate() {
                let keys = &element.keys;
                match match_path(rest, keys, |step, key| step.key() == key.name) {
                    PathMatch::Elsewhere => {}
                    PathMatch::Within if rest.len() < keys.len() => pieces.push(Piece::Assignment(i, k)),
                    PathMatch::Within => {
                        let spot = InsertionPoint { element, holder: None, section: i, assignment: k };
                        return Ok(Match::Value(spot));
                    }
                    PathMatch::Beyond(steps) => {
                        let rest = &rest[rest.len() - steps..];
                        let found = within(&element.value, rest)?;
                        return Ok(found.map_or(Match::Nothing, |(element, holder)| {
                            let holder = Some(holder);
                            Match::Value(InsertionPoint { element, holder, section: i, assignment: k })
                        }));
                    }
                }
            }
        }
        Ok(if pieces.is_empty() { Match::Nothing } else { Match::Pieces(pieces) })
    }

    /// The keys, or numbers of entries, that pieces have directly below a path of so many steps, in their order.
    pub fn below(&self, pieces: &[Piece], depth: usize) -> Vec<Step> {
        let mut steps: Vec<Step> = Vec::new();
        let mut add = |step: Option<Step>| {
            if let Some(step) = step.filter(|step| !steps.contains(step)) {
                steps.push(step);
            }
        };
        for &piece in pieces {
            match piece {
                Piece::Section(i) => {
                    let section = &self.sections[i];
                    match section.path.0.get(depth) {
                        Some(step) => add(Some(step.clone())),
                        None => section.assignments.iter().for_each(|a| add(a.path().next())),
                    }
                }
                Piece::Assignment(i, k) => {
                    let section = &self.sections[i];
                    let within = depth - section.path.0.len();
                    add(section.assignments[k].path().nth(within));
                }
            }
        }
        steps
    }

    /// The lines of a table with the comments that belong to it; none where it is not headers all.
    pub fn lines_of(&self, text: &str, path: &Path) -> Option<String> {
        let Match::Pieces(pieces) = self.find(&path.0).ok()? else { return None };
        let mut blocks = Vec::new();
        for piece in pieces {
            let Piece::Section(i) = piece else { return None };
            let block = &text[self.block(text, i)];
            blocks.push(format!("{}{}", block, if block.ends_with('\n') { "" } else { "\n" }));
        }
        Some(blocks.join("\n"))
    }

    /// Comment of a table or value: the comment lines directly above it, else the one at the end of its first lines (a header's and its
    /// first key's). `None` where there is none.
    pub fn comment(&self, text: &str, path: &Path) -> Option<String> {
        let above = |at: usize, floor: usize| {
            let line = lines::start(text, at);
            lines::comment(&text[lines::with_comments_above(text, line, floor)..line])
        };
        match self.find(&path.0).ok()? {
            Match::Value(spot) => {
                let span = spot.element.span();
                // Of several entries of a line the comment is none's.
                let above =
                    Some(span.start).filter(|at| lines::is_first(text, *at)).and_then(|at| above(at, 0));
                above.or_else(|| lines::comment_after(text, span.end))
            }
            Match::Pieces(pieces) => {
                let section = pieces.iter().find_map(Piece::section)?;
                let this = &self.sections[section];
                let first = this.assignments.first().map(|first| first.value.span.end);
                let ends = this.header.iter().map(|header| header.span.end).chain(first);
                let at_ends = || ends.into_iter().find_map(|end| lines::comment_after(text, end));
                above(this.start(), self.floor(text, section)).or_else(at_ends)
            }
            Match::Nothing => None,
        }
    }

    /// Start of the line after everything that comes before a section.
    pub fn floor(&self, text: &str, section: usize) -> usize {
        match section.checked_sub(1).map(|before| self.sections[before].end()) {
            Some(end) if end > 0 => lines::end(text, end),
            _ => 0,
        }
    }

    /// The lines of a section with the comments that belong to it.
    pub fn block(&self, text: &str, section: usize) -> Range<usize> {
        let this: &Section = &self.sections[section];
        let from = match this.header {
            Some(_) => {
                lines::with_comments_above(text, lines::start(text, this.start()), self.floor(text, section))
            }
            None => 0,
        };
        let last = if this.end() == 0 { 0 } else { lines::end(text, this.end()) };
        let ceiling = match self.sections.get(section + 1) {
            Some(next) => lines::with_comments_above(text, lines::start(text, next.start()), last),
            None => text.len(),
        };
        from..lines::with_comments_below(text, last, ceiling)
    }

    /// The path of what stands at a byte: the innermost part of a value, or the table of a header.
    pub fn path_at(&self, at: usize) -> Path {
        let after = self.sections.iter().rposition(|section| section.start() <= at).unwrap_or(0);
        let Some(section) = self.sections.get(after) else { return Path::default() };
        let mut path = section.path.0.clone();
        let mut elements = section.assignments.as_slice();
        let mut is_list = false;
        while let Some(i) = elements.iter().position(|element| element.span().contains(&at)) {
            if is_list {
                path.push(Step::Entry(i))
            } else {
                path.extend(elements[i].path())
            }
            is_list = elements[i].value.is_list();
            elements = elements[i].value.elements();
        }
        Path(path)
    }
}

fn within<'a>(value: &'a Value, path: &[Step]) -> Result<Option<(&'a Element, (&'a Value, usize))>> {
    let Some(first) = path.first() else { return Ok(None) };
    for (i, element) in value.elements().iter().enumerate() {
        let taken = match (&value.kind, first) {
            (ValueKind::List(_), Step::Entry(number)) if *number == i => 1,
            (ValueKind::List(_) | ValueKind::Scalar, _) => continue,
            (ValueKind::Table(_), _) => {
                let keys = &element.keys;
                match match_path(path, keys, |step, key| step.key() == key.name) {
                    PathMatch::Elsewhere => continue,
                    PathMatch::Within if path.len() < keys.len() => {
                        let error = Error::usage("a table is written by keys with points within a value");
                        let found = keys.iter().map(|key| key.name.as_str()).collect::<Vec<_>>().join(".");
                        return Err(error
                            .got(found)
                            .expected("{ … } in its place, or the change made in the text"));
                    }
                    PathMatch::Within | PathMatch::Beyond(_) => keys.len(),
                }
            }
        };
        return match &path[taken..] {
            [] => Ok(Some((element, (value, i)))),
            rest => within(&element.value, rest),
        };
    }
    Ok(None)
}

struct Reader<'a> {
    text: &'a str,
    events: &'a [Event],
    next: usize,
    /// Number of entries of each list of tables so far.
    counts: HashMap<Path, usize>,
}

impl Reader<'_> {
    fn take(&mut self) -> Option<Event> {
        let event = self.events.get(self.next).copied();
        self.next += 1;
        event
    }

    fn peek(&self) -> Option<EventKind> {
        self.events.get(self.next).map(Event::kind)
    }

    fn key(&self, event: Event) -> Key {
        let place = span(event);
        let mut name = String::new();
        let raw = self.text.get(place.clone()).unwrap_or_default();
        Raw::new_unchecked(raw, event.encoding(), event.span()).decode_key(&mut name, &mut ());
        Key { name, span: place }
    }

    /// Keys with points between, from the first on.
    fn keys(&mut self, first: Event) -> Vec<Key> {
        let mut keys = vec![self.key(first)];
        while self.peek() == Some(EventKind::KeySep) {
            self.next += 1;
            match self.take() {
                Some(event) if event.kind() == EventKind::SimpleKey => keys.push(self.key(event)),
                _ => break,
            }
        }
        keys
    }

    fn header(&mut self, open: Event) -> Section {
        let is_entry = open.kind() == EventKind::ArrayTableOpen;
        let mut section = Section::default();
        let Some(first) = self.take().filter(|event| event.kind() == EventKind::SimpleKey) else {
            return section;
        };
        let keys = self.keys(first);
        let close = self.take().map_or(open, |event| event);
        for (i, key) in keys.iter().enumerate() {
            section.path.0.push(Step::Key(key.name.clone()));
            let is_last = i + 1 == keys.len();
            if is_entry && is_last {
                *self.counts.entry(section.path.clone()).or_default() += 1;
            }
            if let Some(&count) = self.counts.get(&section.path) {
                section.path.0.push(Step::Entry(count - 1));
            }
        }
        section.header = Some(Header { span: open.span().start()..close.span().end(), keys });
        section
    }

    fn assignment(&mut self, first: Event) -> Option<Element> {
        let keys = self.keys(first);
        if self.peek() != Some(EventKind::KeyValSep) {
            return None;
        }
        self.next += 1;
        Some(Element { keys, value: self.value()?, comma: None })
    }

    fn value(&mut self) -> Option<Value> {
        let open = self.take()?;
        let (close, is_list) = match open.kind() {
            EventKind::Scalar => return Some(Value { span: span(open), kind: ValueKind::Scalar }),
            EventKind::ArrayOpen => (EventKind::ArrayClose, true),
            EventKind::InlineTableOpen => (EventKind::InlineTableClose, false),
            _ => return None,
        };
        let mut elements: Vec<Element> = Vec::new();
        loop {
            let kind = self.peek()?;
            if kind == close {
                let end = span(self.take()?).end;
                let kind = if is_list { ValueKind::List(elements) } else { ValueKind::Table(elements) };
                return Some(Value { span: open.span().start()..end, kind });
            }
            if kind == EventKind::ValueSep {
                let at = span(self.take()?).start;
                if let Some(last) = elements.last_mut() {
                    last.comma = Some(at);
                }
            } else if is_list {
                elements.push(Element { keys: Vec::new(), value: self.value()?, comma: None });
            } else {
                let first = self.take()?;
                elements.push(self.assignment(first)?);
            }
        }
    }
}

fn span(event: Event) -> Range<usize> {
    event.span().start()..event.span().end()
}
