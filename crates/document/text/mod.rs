//! TOML texts changed where asked and nowhere else: values set and taken out, keys, tables and entries of lists added, however they are
//! written.
//!
//! A [`Draft`] holds a text and the places of everything in it, and collects replacements of bytes; what is not replaced is not
//! written again, so comments, order, spaces and line ends stay by construction.

mod lines;
mod list_entries;
mod syntax;

pub use syntax::Syntax;

use crate::path::{Path, Step};
use std::ops::Range;
use std::sync::Arc;
use syntax::{Element, InsertionPoint, Match, Piece, Value, ValueKind};
use voltet_core::parameters::key_text;
use voltet_core::{Error, Result};
use voltet_graph::pipeline::EDITOR;
use voltet_graph::{Field, LocatedValue, ParameterValue};

/// A text that is being changed: where everything stands in it, and what is to be replaced.
///
/// Changes that follow each other without [`Draft::reparse`] are all of the text as it was: they may not touch the same bytes, and
/// do not see each other.
pub struct Draft {
    pub text: Arc<str>,
    pub syntax: Arc<Syntax>,
    replaced: Vec<(Range<usize>, String)>,
}

/// Tables at so few steps have a header of their own where there is none yet; deeper ones are written on one line.
const HEADED: usize = 2;

impl Draft {
    /// Draft of a text that is valid TOML, with its syntax tree.
    pub fn new(text: Arc<str>, syntax: Arc<Syntax>) -> Draft {
        Draft { text, syntax, replaced: Vec::new() }
    }

    /// Replaces bytes. Line ends are written as the text has them.
    fn replace(&mut self, range: Range<usize>, new: &str) {
        let new = match lines::line_end(&self.text) {
            "\n" => new.to_string(),
            line_end => new.replace("\r\n", "\n").replace('\n', line_end),
        };
        self.replaced.push((range, new));
    }

    /// Carries out what was asked for so far, so that what follows sees it. Errors: two parts overlap, which is a fault of whoever
    /// made them.
    pub fn reparse(&mut self) -> Result<()> {
        if self.replaced.is_empty() {
            return Ok(());
        }
        let mut parts = std::mem::take(&mut self.replaced);
        parts.sort_by_key(|(range, _)| (range.start, range.end));
        let (mut later, mut copied) = (String::with_capacity(self.text.len()), 0);
        for (range, new) in parts {
            let overlap = || Error::run("two parts of an edit overlap").got(format!("{new:?}"));
            later += self.text.get(copied..range.start).ok_or_else(overlap)?;
            later += &new;
            copied = range.end;
        }
        later += self.text.get(copied..).ok_or_else(|| Error::run("an edit points outside of the text"))?;
        self.syntax = Arc::new(Syntax::read(&later));
        self.text = later.into();
        Ok(())
    }

    /// Sets what a path leads to, and makes tables that are not there. Of lists and tables only the parts are written that differ.
    pub fn set(&mut self, path: &Path, datum: &ParameterValue) -> Result<()> {
        let syntax = self.syntax.clone();
        match syntax.find(&path.0)? {
            Match::Value(spot) => self.change(&spot.element.value, datum),
            Match::Pieces(pieces) => self.set_pieces(path, &pieces, datum),
            Match::Nothing => self.add(path, &datum.to_string()),
        }
    }

    fn set_pieces(&mut self, path: &Path, pieces: &[Piece], datum: &ParameterValue) -> Result<()> {
        let below = self.syntax.below(pieces, path.0.len());
        let is_list = below.iter().all(|step| matches!(step, Step::Entry(_))) && !below.is_empty();
        match datum {
            ParameterValue::Table(fields) if !is_list => {
                for step in &below {
                    if !fields.iter().any(|field| field.name == step.key()) {
                        self.unset(&path.with(step.clone()))?;
                    }
                }
                fields
                    .iter()
                    .try_for_each(|field| self.set(&path.with(field.name.as_str()), &field.setting.datum))
            }
            ParameterValue::List(list)
                if is_list
                    && list.len() == below.len()
                    && list.iter().all(|part| matches!(part.datum, ParameterValue::Table(_))) =>
            {
                list.iter().enumerate().try_for_each(|(i, part)| self.set(&path.with(i), &part.datum))
            }
            other if matches!(path.0.last(), Some(Step::Entry(_))) => {
                Err(Error::usage("an entry of this list must be a table").got(other))
            }
            other => {
                self.unset(path)?;
                self.reparse()?;
                self.add(path, &other.to_string())
            }
        }
    }

    /// Changes a value that is there, as far as it differs.
    fn change(&mut self, value: &Value, datum: &ParameterValue) -> Result<()> {
        match (&value.kind, datum) {
            (ValueKind::List(elements), ParameterValue::List(list)) => {
                let same = |i: &usize, j: &usize| self.is(&elements[*i].value, &list[*j].datum);
                let least = elements.len().min(list.len());
                let before = (0..least).take_while(|i| same(i, i)).count();
                let after = (1..=least - before)
                    .take_while(|k| same(&(elements.len() - k), &(list.len() - k)))
                    .count();
                let (old, new) = (before..elements.len() - after, before..list.len() - after);
                for (i, j) in old.clone().zip(new.clone()) {
                    self.change(&elements[i].value, &list[j].datum)?;
                }
                let shared = old.len().min(new.len());
                if shared < old.len() {
                    let gone: Vec<usize> = (old.start + shared..old.end).collect();
                    self.remove_elements(value, &gone);
                }
                if shared < new.len() {
                    let parts = list[new.start + shared..new.end].iter();
                    let texts: Vec<String> = parts.map(|part| part.datum.to_string()).collect();
                    self.add_elements(value, old.start + shared, &texts);
                }
                Ok(())
            }
            (ValueKind::Table(elements), ParameterValue::Table(fields))
                if elements.iter().all(|e| e.keys.len() == 1) =>
            {
                let named = |field: &Field| elements.iter().position(|e| e.keys[0].name == field.name);
                let gone = |i: &usize| !fields.iter().any(|field| named(field) == Some(*i));
                let gone: Vec<usize> = (0..elements.len()).filter(gone).collect();
                let fresh: Vec<String> = fields
                    .iter()
                    .filter(|f| named(f).is_none())
                    .map(|f| assigned(&f.name, &f.setting))
                    .collect();
                if gone.len() == elements.len() || (!gone.is_empty() && !fresh.is_empty()) {
                    self.replace(value.span.clone(), &datum.to_string());
                    return Ok(());
                }
                for field in fields {
                    if let Some(i) = named(field) {
                        self.change(&elements[i].value, &field.setting.datum)?;
                    }
                }
                if !gone.is_empty() {
                    self.remove_elements(value, &gone);
                }
                if !fresh.is_empty() {
                    self.add_elements(value, elements.len(), &fresh);
                }
                Ok(())
            }
            _ => {
                if !self.is(value, datum) {
                    self.replace(value.span.clone(), &datum.to_string());
                }
                Ok(())
            }
        }
    }

    /// True if a value says this already, in whatever words.
    fn is(&self, value: &Value, datum: &ParameterValue) -> bool {
        let written = voltet_graph::pipeline::value(&self.text[value.span.clone()]);
        written.is_some_and(|setting| setting.datum == *datum)
    }

    /// Takes out what a path leads to; nothing where there is nothing.
    pub fn unset(&mut self, path: &Path) -> Result<()> {
        let syntax = self.syntax.clone();
        match syntax.find(&path.0)? {
            Match::Nothing => {}
            Match::Value(InsertionPoint { holder: Some((holder, number)), .. }) => {
                self.remove_elements(holder, &[number])
            }
            Match::Value(spot) => self.remove_lines(spot.section, spot.assignment),
            Match::Pieces(pieces) => {
                // Sections that follow each other go as one, with the blank lines between.
                let mut blocks: Vec<(usize, Range<usize>)> = Vec::new();
                for piece in pieces {
                    match piece {
                        Piece::Assignment(i, k) => self.remove_lines(i, k),
                        Piece::Section(i) => {
                            let block = syntax.block(&self.text, i);
                            match blocks.last_mut().filter(|(last, range)| {
                                last + 1 == i && self.text[range.end..block.start].trim().is_empty()
                            }) {
                                Some(last) => *last = (i, last.1.start..block.end),
                                None => blocks.push((i, block)),
                            }
                        }
                    }
                }
                for (_, block) in blocks {
                    self.replace(lines::with_blanks(&self.text, block), "");
                }
            }
        }
        Ok(())
    }

    /// Takes out an assignment that has lines of its own. Comments above it go with it unless they may be meant for what
    /// follows directly, too.
    fn remove_lines(&mut self, section: usize, assignment: usize) {
        let syntax = self.syntax.clone();
        let this = &syntax.sections[section];
        let place = this.assignments[assignment].span();
        let (from, to) = (lines::start(&self.text, place.start), lines::end(&self.text, place.end));
        let floor = match assignment.checked_sub(1) {
            Some(above) => lines::end(&self.text, this.assignments[above].span().end),
            None if this.header.is_some() => lines::end(&self.text, this.start()),
            None => 0,
        };
        let next = this.assignments.get(assignment + 1);
        let shares = next.is_some_and(|next| lines::start(&self.text, next.span().start) == to);
        let from = if shares { from } else { lines::with_comments_above(&self.text, from, floor) };
        self.replace(from..to, "");
    }

    /// Gives a table or an assignment another last key, wherever it is written.
    pub fn rename(&mut self, path: &Path, name: &str) -> Result<()> {
        let syntax = self.syntax.clone();
        let depth = path.0.len().checked_sub(1).ok_or_else(|| Error::usage("a path must name something"))?;
        let new = key_text(name);
        match syntax.find(&path.0)? {
            Match::Nothing => return Err(nothing_at(path)),
            Match::Value(spot) => match spot.element.keys.last() {
                Some(key) => self.replace(key.span.clone(), &new),
                None => return Err(nothing_at(path)),
            },
            Match::Pieces(pieces) => {
                for piece in pieces {
                    let key = match piece {
                        Piece::Section(i) => {
                            // Numbers of entries are not among the keys.
                            let before = syntax.sections[i].path.0[..depth].iter();
                            let numbers = before.filter(|step| matches!(step, Step::Entry(_))).count();
                            let header = syntax.sections[i].header.as_ref();
                            header.and_then(|header| header.keys.get(depth - numbers))
                        }
                        Piece::Assignment(i, k) => {
                            let section = &syntax.sections[i];
                            section.assignments[k].keys.get(depth - section.path.0.len())
                        }
                    };
                    if let Some(key) = key {
                        self.replace(key.span.clone(), &new);
                    }
                }
            }
        }
        Ok(())
    }

    /// Adds elements before the one at `place`, or at the end. On lines of their own where the others are.
    fn add_elements(&mut self, holder: &Value, place: usize, texts: &[String]) {
        let text = self.text.clone();
        let elements = holder.elements();
        let Some(beside) = elements.get(place).or(elements.last()) else {
            let inner = holder.span.start + 1..holder.span.end - 1;
            let joined = texts.join(", ");
            let is_blank = text[inner.clone()].trim().is_empty();
            match (&holder.kind, is_blank) {
                (ValueKind::Table(_), true) => self.replace(inner, &format!(" {joined} ")),
                (_, true) => self.replace(inner, &joined),
                // Comments alone stand there.
                (_, false) => self.replace(inner.start..inner.start, &format!(" {joined},")),
            }
            return;
        };
        let start = beside.span().start;
        let is_own_line = lines::is_first(&text, start) && lines::start(&text, start) > holder.span.start;
        let between =
            if is_own_line { format!(",\n{}", lines::indent(&text, start)) } else { ", ".to_string() };
        let joined = texts.join(&between);
        if place < elements.len() {
            self.replace(start..start, &format!("{joined}{between}"));
            return;
        }
        let end = beside.value.span.end;
        match (beside.comma, is_own_line) {
            (Some(comma), true) => {
                let at = self.end_of_line(comma + 1, holder);
                self.replace(at..at, &format!("{}{joined},", &between[1..]));
            }
            (Some(comma), false) => self.replace(comma + 1..comma + 1, &format!(" {joined},")),
            (None, true) => {
                let at = self.end_of_line(end, holder);
                self.replace(end..end, ",");
                self.replace(at..at, &format!("{}{joined}", &between[1..]));
            }
            (None, false) => self.replace(end..end, &format!("{between}{joined}")),
        }
    }

    /// The end of the words on the line of a byte within a list or table, a comment included.
    fn end_of_line(&self, at: usize, holder: &Value) -> usize {
        let line = &self.text[at..lines::end(&self.text, at).min(holder.span.end - 1)];
        at + line.trim_end().len()
    }

    /// Removes elements, by their numbers in rising order, with the comments on their lines.
    fn remove_elements(&mut self, holder: &Value, gone: &[usize]) {
        let elements = holder.elements();
        if gone.len() == elements.len() {
            self.replace(holder.span.start + 1..holder.span.end - 1, "");
            return;
        }
        let mut runs: Vec<Range<usize>> = Vec::new();
        for &i in gone {
            match runs.last_mut() {
                Some(run) if run.end == i => run.end = i + 1,
                _ => runs.push(i..i + 1),
            }
        }
        for run in runs {
            self.remove_run(holder, elements, run);
        }
    }

    fn remove_run(&mut self, holder: &Value, elements: &[Element], run: Range<usize>) {
        let text = self.text.clone();
        let own_line = |at: usize| lines::is_first(&text, at) && lines::start(&text, at) > holder.span.start;
        let first = elements[run.start].span().start;
        let last = &elements[run.end - 1];
        let after_comma = last.comma.map_or(last.value.span.end, |comma| comma + 1);
        if let Some(next) = elements.get(run.end) {
            let next = next.span().start;
            if own_line(first) && own_line(next) {
                self.replace(lines::start(&text, first)..lines::end(&text, after_comma), "")
            } else {
                self.replace(first..next, "")
            }
            return;
        }
        let kept = &elements[run.start - 1];
        let comma = kept.comma.unwrap_or(kept.value.span.end);
        let after_kept = if kept.comma.is_some() { comma + 1 } else { comma };
        match (own_line(first), last.comma) {
            (true, Some(_)) => self.replace(lines::start(&text, first)..lines::end(&text, after_comma), ""),
            (true, None) => {
                self.replace(comma..after_kept, "");
                let from = lines::start(&text, first);
                let to = lines::end(&text, after_comma).min(holder.span.end - 1);
                self.replace(from..to.max(last.value.span.end), "");
            }
            (false, Some(_)) => self.replace(after_kept..after_comma, ""),
            (false, None) => self.replace(comma..after_comma, ""),
        }
    }

    /// Adds what is not there: a value, as it is to be written.
    pub fn add(&mut self, path: &Path, value: &str) -> Result<()> {
        let Some((last, parent)) = path.0.split_last() else {
            return Err(Error::usage("a path must name something"));
        };
        let parent = Path(parent.to_vec());
        let key = key_text(&last.key());
        let syntax = self.syntax.clone();
        match syntax.find(&parent.0)? {
            Match::Value(spot) => self.add_within(path, &spot.element.value, last, value),
            Match::Pieces(pieces) => {
                let below = syntax.below(&pieces, parent.0.len());
                if below.iter().any(|step| matches!(step, Step::Entry(_))) {
                    return Err(no_entry(path, below.len()));
                }
                self.add_line(&parent, &pieces, &last.key(), value)
            }
            Match::Nothing if parent.0.is_empty() => {
                let first = &self.syntax.sections[0];
                let at = if first.assignments.is_empty() { 0 } else { lines::end(&self.text, first.end()) };
                self.add_text(at, &format!("{key} = {value}\n"));
                Ok(())
            }
            Match::Nothing if parent.0.len() <= HEADED => {
                self.add_section(self.end_of_all(), &format!("[{parent}]\n{key} = {value}\n"));
                Ok(())
            }
            Match::Nothing => self.add(&parent, &format!("{{ {key} = {value} }}")),
        }
    }

    fn add_within(&mut self, path: &Path, holder: &Value, last: &Step, value: &str) -> Result<()> {
        match (&holder.kind, last) {
            (ValueKind::Table(elements), _) => {
                let text = format!("{} = {value}", key_text(&last.key()));
                self.add_elements(holder, elements.len(), &[text]);
                Ok(())
            }
            (ValueKind::List(elements), Step::Entry(number)) if *number == elements.len() => {
                self.add_elements(holder, elements.len(), &[value.to_string()]);
                Ok(())
            }
            (ValueKind::List(elements), _) => Err(no_entry(path, elements.len())),
            (ValueKind::Scalar, _) => {
                Err(Error::usage("a part is asked for of a value that has no parts").got(path))
            }
        }
    }

    /// Adds an assignment to a table that headers and keys with points make.
    fn add_line(&mut self, parent: &Path, pieces: &[Piece], key: &str, value: &str) -> Result<()> {
        let syntax = self.syntax.clone();
        let is_own = |i: &usize| syntax.sections[*i].path.0.len() == parent.0.len();
        let own = pieces.iter().filter_map(Piece::section).find(is_own);
        let assignment = pieces.iter().rev().find_map(|piece| match piece {
            Piece::Assignment(i, k) => Some((*i, *k)),
            Piece::Section(_) => None,
        });
        if let Some(i) = own {
            let section = &syntax.sections[i];
            let text = format!("{} = {value}", key_text(key));
            // What feeds a node stands last, as people write it.
            let before = section.assignments.last().filter(|last| {
                let [only] = last.keys.as_slice() else { return false };
                only.name == "inputs" && key != "inputs" && section.assignments.len() > 1
            });
            match before {
                Some(last) => {
                    let from = lines::start(&self.text, last.span().start);
                    let above = &section.assignments[section.assignments.len() - 2];
                    let floor = lines::end(&self.text, above.span().end);
                    let at = lines::with_comments_above(&self.text, from, floor);
                    let spaces = lines::indent(&self.text, from).to_string();
                    self.add_text(at, &format!("{spaces}{text}\n"));
                }
                None => {
                    let anchor = section.assignments.last().map_or(section.start(), |last| last.span().start);
                    let spaces = lines::indent(&self.text, anchor).to_string();
                    self.add_text(lines::end(&self.text, section.end()), &format!("{spaces}{text}\n"));
                }
            }
            return Ok(());
        }
        if let Some((i, k)) = assignment {
            let section = &syntax.sections[i];
            let beside = &section.assignments[k];
            let within = parent.0.len() - section.path.0.len();
            let keys: Vec<&str> =
                beside.keys[..within].iter().map(|key| &self.text[key.span.clone()]).collect();
            let spaces = lines::indent(&self.text, beside.span().start);
            let text = format!("{spaces}{}.{} = {value}\n", keys.join("."), key_text(key));
            self.add_text(lines::end(&self.text, beside.span().end), &text);
            return Ok(());
        }
        // Only tables within it are there: its own header goes before them.
        let first = pieces.iter().find_map(Piece::section);
        let at = first.map_or(self.text.len(), |i| syntax.block(&self.text, i).start);
        self.add_text(at, &format!("[{parent}]\n{} = {value}\n\n", key_text(key)));
        Ok(())
    }

    /// Adds a table that is not there, under a header of its own where tables beside it may have one; lists of tables in it too.
    pub fn add_table(&mut self, path: &Path, fields: &[Field]) -> Result<()> {
        let syntax = self.syntax.clone();
        let parent = &path.0[..path.0.len().saturating_sub(1)];
        if let Match::Value(_) = syntax.find(parent)? {
            return self.add(path, &ParameterValue::Table(fields.to_vec()).to_string());
        }
        let is_tables = |setting: &LocatedValue| {
            setting
                .list()
                .is_some_and(|list| !list.is_empty() && list.iter().all(|part| part.table().is_some()))
        };
        let (lists, plain): (Vec<&Field>, Vec<&Field>) = fields.iter().partition(|f| is_tables(&f.setting));
        let mut text = format!("[{path}]\n");
        for field in plain {
            text += &format!("{}\n", assigned(&field.name, &field.setting));
        }
        for list in lists {
            for entry in list.setting.list().unwrap_or_default() {
                text += "\n";
                text += &headed(&path.with(list.name.as_str()), &entry.datum)?;
            }
        }
        self.add_block(&Path(parent.to_vec()), &text)
    }

    /// Adds lines that begin with a header after all that is headed so.
    pub fn add_block(&mut self, after: &Path, text: &str) -> Result<()> {
        let syntax = self.syntax.clone();
        let at = match syntax.find(&after.0)? {
            Match::Pieces(pieces) => pieces.iter().fold(0, |at, piece| match piece {
                Piece::Section(i) | Piece::Assignment(i, _) => at.max(syntax.block(&self.text, *i).end),
            }),
            Match::Value(_) | Match::Nothing => self.foreign_end().unwrap_or_else(|| self.end_of_all()),
        };
        self.add_section(at, text);
        Ok(())
    }

    /// End of the sections before the first that belongs to the editor, which stands last.
    fn foreign_end(&self) -> Option<usize> {
        let own = |step: &Step| step.key() == EDITOR;
        let first =
            self.syntax.sections.iter().position(|section| section.path.0.first().is_some_and(own))?;
        Some(self.syntax.block(&self.text, first.checked_sub(1)?).end)
    }

    /// Adds assignments to a table, which need not be there.
    pub fn add_lines(&mut self, table: &Path, values: &[(&str, ParameterValue)]) -> Result<()> {
        let is_there = !matches!(self.syntax.find(&table.0)?, Match::Nothing);
        if !is_there && !values.is_empty() {
            let line = |(key, value): &(&str, ParameterValue)| format!("{} = {value}\n", key_text(key));
            let text: String = values.iter().map(line).collect();
            self.add_section(self.end_of_all(), &format!("[{table}]\n{text}"));
            return Ok(());
        }
        values.iter().try_for_each(|(key, value)| self.add(&table.with(*key), &value.to_string()))
    }

    fn end_of_all(&self) -> usize {
        self.syntax.block(&self.text, self.syntax.sections.len() - 1).end
    }

    /// Adds a section, which begins with its header, at the end of a block, with a blank line before it and, where something
    /// follows, after it.
    fn add_section(&mut self, at: usize, text: &str) {
        let blank = if at == 0 { "" } else { "\n" };
        let after = if lines::is_followed(&self.text, at) { "\n" } else { "" };
        self.add_text(at, &format!("{blank}{text}{after}"));
    }

    /// Adds lines at the beginning of a line or at the end of the text, where a last line without an end gets one.
    fn add_text(&mut self, at: usize, text: &str) {
        let unended = at == self.text.len() && at > 0 && !self.text.ends_with('\n');
        let line_end = if unended { "\n" } else { "" };
        self.replace(at..at, &format!("{line_end}{text}"));
    }
}

fn nothing_at(path: &Path) -> Error {
    Error::usage("there is nothing at this place of the file").got(path)
}

fn assigned(key: &str, setting: &LocatedValue) -> String {
    format!("{} = {}", key_text(key), setting.datum)
}

fn no_entry(path: &Path, count: usize) -> Error {
    let error = Error::usage("there is no such entry in the list").got(path);
    error.expected(format!("a number below {count}"))
}

/// An entry under a header of its own.
fn headed(list: &Path, entry: &ParameterValue) -> Result<String> {
    let ParameterValue::Table(fields) = entry else {
        return Err(Error::usage("an entry of this list must be a table").got(entry));
    };
    // Numbers of entries are not written: the last one before is meant.
    let keys: Vec<String> = list
        .0
        .iter()
        .filter_map(|step| match step {
            Step::Key(key) => Some(key_text(key)),
            Step::Entry(_) => None,
        })
        .collect();
    let lines = fields.iter().map(|field| format!("{} = {}\n", key_text(&field.name), field.setting.datum));
    Ok(format!("[[{}]]\n{}", keys.join("."), lines.collect::<String>()))
}
