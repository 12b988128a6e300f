//! Setting what a path leads to.

use super::draft::Draft;
use super::find::{Match, Piece};
use super::syntax::{Value, ValueKind};
use crate::path::{Path, Step};
use voltet_core::parameters::key_text;
use voltet_core::{Error, Result};
use voltet_graph::{Field, LocatedValue, ParameterValue};

impl Draft {
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
    pub(super) fn change(&mut self, value: &Value, datum: &ParameterValue) -> Result<()> {
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
        match (&value.kind, datum) {
            (ValueKind::List(elements), ParameterValue::List(list)) => {
                elements.len() == list.len()
                    && elements.iter().zip(list).all(|(element, part)| self.is(&element.value, &part.datum))
            }
            (ValueKind::Table(elements), ParameterValue::Table(fields)) => {
                let is = |(element, field): (&super::syntax::Element, &Field)| {
                    let [key] = element.keys.as_slice() else { return false };
                    key.name == field.name && self.is(&element.value, &field.setting.datum)
                };
                elements.len() == fields.len() && elements.iter().zip(fields).all(is)
            }
            (ValueKind::Scalar, ParameterValue::List(_) | ParameterValue::Table(_)) => false,
            (ValueKind::Scalar, _) => self.datum(&value.span).as_ref() == Some(datum),
            (ValueKind::List(_) | ValueKind::Table(_), _) => false,
        }
    }
}

/// `key = value`.
pub(super) fn assigned(key: &str, setting: &LocatedValue) -> String {
    format!("{} = {}", key_text(key), setting.datum)
}
