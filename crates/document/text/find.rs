//! Search of a path in a text.

use super::lines;
use super::syntax::{Element, Section, Syntax, Value, ValueKind};
use crate::path::{Path, Step};
use std::ops::Range;
use voltet_core::{Error, Result};

/// Result of a search.
#[derive(Debug)]
pub enum Match<'a> {
    /// A value that is written in one place.
    Value(InsertionPoint<'a>),
    /// A table, or a list of tables, that headers and keys with points make together.
    Pieces(Vec<Piece>),
    /// Nothing.
    Nothing,
}

/// An element and what holds it.
#[derive(Debug, Clone, Copy)]
pub struct InsertionPoint<'a> {
    /// The element.
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

/// Relation of two paths.
enum PathMatch {
    /// The path ends within or at the longer one.
    Within,
    /// The path goes on for so many steps.
    Beyond(usize),
    Elsewhere,
}

/// Relation of `path` to paths that begin with `start`.
fn match_path(path: &[Step], start: &[Step]) -> PathMatch {
    let shared = path.iter().zip(start).take_while(|(a, b)| a == b || a.key() == b.key()).count();
    match (shared == path.len(), shared == start.len()) {
        (true, _) => PathMatch::Within,
        (false, true) => PathMatch::Beyond(path.len() - shared),
        (false, false) => PathMatch::Elsewhere,
    }
}

impl Syntax {
    /// Finds the part at a path. Errors: a table made by dotted keys within a value, which no edit changes.
    pub fn find(&self, path: &[Step]) -> Result<Match<'_>> {
        let mut pieces = Vec::new();
        for (i, section) in self.sections.iter().enumerate() {
            let rest = match match_path(path, &section.path.0) {
                PathMatch::Elsewhere => continue,
                PathMatch::Within if section.header.is_some() => {
                    pieces.push(Piece::Section(i));
                    continue;
                }
                PathMatch::Within => path,
                PathMatch::Beyond(steps) => &path[path.len() - steps..],
            };
            for (k, element) in section.assignments.iter().enumerate() {
                let keys: Vec<Step> = element.path().collect();
                match match_path(rest, &keys) {
                    PathMatch::Elsewhere => {}
                    PathMatch::Within if rest.len() < keys.len() => pieces.push(Piece::Assignment(i, k)),
                    PathMatch::Within => {
                        return Ok(Match::Value(InsertionPoint {
                            element,
                            holder: None,
                            section: i,
                            assignment: k,
                        }));
                    }
                    PathMatch::Beyond(steps) => {
                        let rest = &rest[rest.len() - steps..];
                        let found = within(&element.value, rest)?;
                        return Ok(found.map_or(Match::Nothing, |(element, holder)| {
                            Match::Value(InsertionPoint {
                                element,
                                holder: Some(holder),
                                section: i,
                                assignment: k,
                            })
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
}

/// Finds the part at a path within a value, and its container.
fn within<'a>(value: &'a Value, path: &[Step]) -> Result<Option<(&'a Element, (&'a Value, usize))>> {
    let Some(first) = path.first() else { return Ok(None) };
    for (i, element) in value.elements().iter().enumerate() {
        let taken = match (&value.kind, first) {
            (ValueKind::List(_), Step::Entry(number)) if *number == i => 1,
            (ValueKind::List(_) | ValueKind::Scalar, _) => continue,
            (ValueKind::Table(_), _) => {
                let keys: Vec<Step> = element.path().collect();
                match match_path(path, &keys) {
                    PathMatch::Elsewhere => continue,
                    PathMatch::Within if path.len() < keys.len() => {
                        let error = Error::usage("a table is written by keys with points within a value");
                        let found = keys.iter().map(|key| key.key()).collect::<Vec<_>>().join(".");
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
