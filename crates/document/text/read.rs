//! A text to its [`Syntax`], by the events of the TOML parser.

use super::syntax::{Element, Header, Key, Section, Syntax, Value, ValueKind};
use crate::path::{Path, Step};
use std::collections::HashMap;
use std::ops::Range;
use toml_parser::parser::{Event, EventKind, parse_document};
use toml_parser::{Raw, Source};

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
                EventKind::StdTableClose
                | EventKind::ArrayTableClose
                | EventKind::InlineTableOpen
                | EventKind::InlineTableClose
                | EventKind::ArrayOpen
                | EventKind::ArrayClose
                | EventKind::KeySep
                | EventKind::KeyValSep
                | EventKind::Scalar
                | EventKind::ValueSep
                | EventKind::Whitespace
                | EventKind::Comment
                | EventKind::Newline
                | EventKind::Error => {}
            }
        }
        Syntax { sections }
    }
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
