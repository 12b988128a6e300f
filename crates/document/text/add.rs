//! Adding what is not there: keys, tables, sections.

use super::draft::Draft;
use super::entries::headed;
use super::find::{Match, Piece};
use super::lines;
use super::set::assigned;
use super::syntax::{Value, ValueKind};
use crate::path::{Path, Step};
use voltet_core::parameters::key_text;
use voltet_core::{Error, Result};
use voltet_graph::pipeline::EDITOR;
use voltet_graph::{Field, LocatedValue, ParameterValue};

/// Tables at so few steps have a header of their own where there is none yet; deeper ones are written on one line.
const HEADED: usize = 2;

impl Draft {
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
                    let error = Error::usage("there is no such entry in the list").got(path);
                    return Err(error.expected(format!("a number below {}", below.len())));
                }
                self.add_line(&parent, &pieces, &last.key(), value)
            }
            Match::Nothing if parent.0.is_empty() => self.add_at_the_top(&key, value),
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
            (ValueKind::List(elements), _) => Err(Error::usage("there is no such entry in the list")
                .got(path)
                .expected(format!("a number below {}", elements.len()))),
            (ValueKind::Scalar, _) => {
                Err(Error::usage("a part is asked for of a value that has no parts").got(path))
            }
        }
    }

    fn add_at_the_top(&mut self, key: &str, value: &str) -> Result<()> {
        let first = &self.syntax.sections[0];
        let at = if first.assignments.is_empty() { 0 } else { lines::end(&self.text, first.end()) };
        self.add_text(at, &format!("{key} = {value}\n"));
        Ok(())
    }

    /// Adds an assignment to a table that headers and keys with points make.
    fn add_line(&mut self, parent: &Path, pieces: &[Piece], key: &str, value: &str) -> Result<()> {
        let syntax = self.syntax.clone();
        let own = pieces.iter().find_map(|piece| match piece {
            Piece::Section(i) if syntax.sections[*i].path.0.len() == parent.0.len() => Some(*i),
            Piece::Section(_) | Piece::Assignment(..) => None,
        });
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
        let first = pieces.iter().find_map(|piece| match piece {
            Piece::Section(i) => Some(*i),
            Piece::Assignment(..) => None,
        });
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

    /// The end of the last section.
    pub(super) fn end_of_all(&self) -> usize {
        self.syntax.block(&self.text, self.syntax.sections.len() - 1).end
    }

    /// Adds a section, which begins with its header, at the end of a block, with a blank line before it and, where something
    /// follows, after it.
    pub(super) fn add_section(&mut self, at: usize, text: &str) {
        let blank = if at == 0 { "" } else { "\n" };
        let after = if lines::is_followed(&self.text, at) { "\n" } else { "" };
        self.add_text(at, &format!("{blank}{text}{after}"));
    }

    /// Adds lines at the beginning of a line or at the end of the text, where a last line without an end gets one.
    pub(super) fn add_text(&mut self, at: usize, text: &str) {
        let unended = at == self.text.len() && at > 0 && !self.text.ends_with('\n');
        let line_end = if unended { "\n" } else { "" };
        self.replace(at..at, &format!("{line_end}{text}"));
    }
}
