//! Settings with relative numbers, by the type that allows them.

use super::declaration::{Along, Measure, Measured, ParameterType};
use super::relative::{Quantity, Relative};
use super::setting::{Datum, Setting};
use crate::{Error, Result};

/// A relative number where it was given.
#[derive(Debug, Clone)]
pub struct RelativeNumber {
    /// The number.
    pub relative: Relative,
    /// What it is.
    pub is: Measure,
    /// Of what.
    pub quantity: Quantity,
    /// As it was written.
    pub setting: Setting,
}

impl Measured {
    /// Whether the number at a place of the list or row may be relative.
    pub fn may_be_relative(&self, place: usize) -> bool {
        !matches!(self.along, Along::Places(names) if place >= names.len())
    }

    /// How many numbers of a setting may be relative.
    pub fn number_count(&self, setting: &Setting) -> usize {
        let Some(list) = setting.list() else { return 1 };
        let of = |(place, part): (usize, &Setting)| match part.list() {
            Some(_) => self.number_count(part),
            None => usize::from(self.may_be_relative(place)),
        };
        list.iter().enumerate().map(of).sum()
    }

    /// Of what the number at a place is; `None` where it cannot be relative.
    pub(super) fn quantity(
        &self,
        place: usize,
        beside: &dyn Fn(&str) -> Option<Setting>,
    ) -> Option<Quantity> {
        let listed = |name: &str| {
            let names = beside(name)?;
            let name = names.list()?.get(place)?.text()?;
            Some(Quantity::Array(name.to_string()))
        };
        // Where the list is too short, its length is the error.
        let listed = |name: &str| listed(name).unwrap_or(Quantity::Array(String::new()));
        let per = |one, other| Quantity::Per(Box::new(one), Box::new(other));
        match self.along {
            Along::Every(name) => Some(Quantity::Named(name)),
            Along::Places(names) => names.get(place).map(|name| Quantity::Named(name)),
            Along::Names(parameter) => Some(listed(parameter)),
            Along::EveryPer(one, other) => Some(per(Quantity::Named(one), Quantity::Named(other))),
            Along::NamesPer(parameter, other) => {
                let other =
                    beside(other).and_then(|other| other.text().map(str::to_string)).unwrap_or_default();
                Some(per(listed(parameter), Quantity::Array(other)))
            }
        }
    }

    /// The relative number that a text is, or why it is none that can stand here.
    fn read(&self, name: &str, part: &Setting, text: &str) -> Result<Relative> {
        let relative = Relative::parse(text).ok_or_else(|| {
            let accepted = format!("a number, {}", self.describe());
            part.error(format!("'{name}' holds a text that is no number relative to data"), accepted)
        })?;
        match (self.is, relative) {
            (Measure::Width | Measure::Factor, Relative::Percentile(_)) => Err(part.error(
                format!("'{name}' is a width, and a percentile is a value of the data"),
                "a number, or a percentage of the range's length such as \"5 %\"",
            )),
            (Measure::Place, Relative::Percentile(_)) => Err(part.error(
                format!("'{name}' is a place, and a percentile is a value of a field"),
                "a number, or a percentage of the bounds such as \"50 %\"",
            )),
            (Measure::Width, Relative::Share(share)) if share <= 0.0 => {
                Err(part.error(format!("'{name}' is out of range"), "a percentage above 0"))
            }
            // A factor may turn its axis round.
            (Measure::Factor, Relative::Share(0.0)) => {
                Err(part.error(format!("'{name}' is out of range"), "a percentage other than 0, or 0.0"))
            }
            (_, relative) => Ok(relative),
        }
    }

    /// The setting with each relative number replaced. `f` is given the place in the list or row.
    pub fn replaced(
        &self,
        name: &str,
        setting: &Setting,
        f: &mut dyn FnMut(usize, &Setting, Relative) -> Result<f64>,
    ) -> Result<Setting> {
        self.replaced_at(name, setting, 0, f)
    }

    fn replaced_at(
        &self,
        name: &str,
        setting: &Setting,
        place: usize,
        f: &mut dyn FnMut(usize, &Setting, Relative) -> Result<f64>,
    ) -> Result<Setting> {
        let datum = match &setting.datum {
            // A word that the type knows is none.
            Datum::Text(text) if !matches!(self.plain, ParameterType::NumberOr(_, word) if word == text) => {
                match self.along {
                    Along::Places(names) if place >= names.len() => return Ok(setting.clone()),
                    _ => Datum::Number(f(place, setting, self.read(name, setting, text)?)?),
                }
            }
            Datum::List(list) => {
                let part = |(place, part): (usize, &Setting)| self.replaced_at(name, part, place, f);
                Datum::List(list.iter().enumerate().map(part).collect::<Result<_>>()?)
            }
            other => other.clone(),
        };
        Ok(Setting { datum, origin: setting.origin.clone() })
    }
}

impl RelativeNumber {
    /// Adds the place where it was written to an error.
    pub fn blame(&self, error: Error) -> Error {
        self.setting.origin.blame(error)
    }
}
