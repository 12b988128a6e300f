//! Numbers relative to data: a share of a range ("25 %") or a percentile by volume ("p90") in place of a number.
//!
//! What they become is found where the data are known; a declaration says of which quantities they may be.

use super::declaration::{AxisRef, ParameterType, RelativeNumberType, StatisticKind};
use super::setting::{LocatedValue, ParameterValue};
use crate::{Error, Result};
use std::fmt;

/// A number relative to data.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Relative {
    /// A share of the range, 1 for "100 %": of a value or a place from the least one on, of a width of the range's length.
    Share(f64),
    /// "p90": of 90 % of the volume the value is at most this; 0 to 100.
    Percentile(f64),
}

/// A quantity that numbers are relative to.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub enum ArrayRef {
    /// One that the declaration names: "s", "g", "x".
    Named(&'static str),
    /// An array of the data.
    Array(String),
    /// One per unit of another.
    Per(Box<ArrayRef>, Box<ArrayRef>),
}

impl Relative {
    /// From a text such as "25 %", "-10%", "p90" or "p 99.5"; `None` where it is none.
    pub fn parse(text: &str) -> Option<Relative> {
        let number = |text: &str| text.trim().parse::<f64>().ok().filter(|x| x.is_finite());
        let text = text.trim();
        match (text.strip_suffix('%'), text.strip_prefix('p')) {
            (Some(share), _) => number(share).map(|share| Relative::Share(share / 100.0)),
            (_, Some(percent)) => {
                number(percent).filter(|p| (0.0..=100.0).contains(p)).map(Relative::Percentile)
            }
            _ => None,
        }
    }

    /// The value at a share of a range; its ends exactly at 0 % and 100 %.
    pub fn at_share(share: f64, [low, high]: [f64; 2]) -> f64 {
        low * (1.0 - share) + high * share
    }
}

impl fmt::Display for ArrayRef {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ArrayRef::Named(name) => f.write_str(name),
            ArrayRef::Array(name) => write!(f, "'{name}'"),
            ArrayRef::Per(one, other) => write!(f, "{one} per unit of {other}"),
        }
    }
}

/// A relative number where it was given.
#[derive(Debug, Clone)]
pub struct RelativeNumber {
    /// The number.
    pub relative: Relative,
    /// Statistic that the number refers to.
    pub is: StatisticKind,
    /// Array that the number refers to.
    pub quantity: ArrayRef,
    /// As it was written.
    pub setting: LocatedValue,
}

impl RelativeNumberType {
    /// True if the number at a place of the list or row may be relative.
    pub fn may_be_relative(&self, place: usize) -> bool {
        !matches!(self.axis, AxisRef::Places(names) if place >= names.len())
    }

    /// Count of the numbers of a setting that may be relative.
    pub fn number_count(&self, setting: &LocatedValue) -> usize {
        let Some(list) = setting.list() else { return 1 };
        let of = |(place, part): (usize, &LocatedValue)| match part.list() {
            Some(_) => self.number_count(part),
            None => usize::from(self.may_be_relative(place)),
        };
        list.iter().enumerate().map(of).sum()
    }

    /// Array that the number at a position refers to; `None` where it cannot be relative.
    pub(crate) fn quantity(
        &self,
        place: usize,
        beside: &dyn Fn(&str) -> Option<LocatedValue>,
    ) -> Option<ArrayRef> {
        let listed = |name: &str| {
            let names = beside(name)?;
            let name = names.list()?.get(place)?.text()?;
            Some(ArrayRef::Array(name.to_string()))
        };
        // Where the list is too short, its length is the error.
        let listed = |name: &str| listed(name).unwrap_or(ArrayRef::Array(String::new()));
        let per = |one, other| ArrayRef::Per(Box::new(one), Box::new(other));
        match self.axis {
            AxisRef::Every(name) => Some(ArrayRef::Named(name)),
            AxisRef::Places(names) => names.get(place).map(|name| ArrayRef::Named(name)),
            AxisRef::Names(parameter) => Some(listed(parameter)),
            AxisRef::EveryPer(one, other) => Some(per(ArrayRef::Named(one), ArrayRef::Named(other))),
            AxisRef::NamesPer(parameter, other) => {
                let other =
                    beside(other).and_then(|other| other.text().map(str::to_string)).unwrap_or_default();
                Some(per(listed(parameter), ArrayRef::Array(other)))
            }
        }
    }

    /// The relative number that a text is, or why it is none that can stand here.
    fn read(&self, name: &str, part: &LocatedValue, text: &str) -> Result<Relative> {
        let relative = Relative::parse(text).ok_or_else(|| {
            let accepted = format!("a number, {}", self.describe());
            part.error(format!("'{name}' holds a text that is no number relative to data"), accepted)
        })?;
        match (self.statistic, relative) {
            (StatisticKind::Width | StatisticKind::Factor, Relative::Percentile(_)) => Err(part.error(
                format!("'{name}' is a width, and a percentile is a value of the data"),
                "a number, or a percentage of the range's length such as \"5 %\"",
            )),
            (StatisticKind::Place, Relative::Percentile(_)) => Err(part.error(
                format!("'{name}' is a place, and a percentile is a value of a field"),
                "a number, or a percentage of the bounds such as \"50 %\"",
            )),
            (StatisticKind::Width, Relative::Share(share)) if share <= 0.0 => {
                Err(part.error(format!("'{name}' is out of range"), "a percentage above 0"))
            }
            // A factor may turn its axis round.
            (StatisticKind::Factor, Relative::Share(0.0)) => {
                Err(part.error(format!("'{name}' is out of range"), "a percentage other than 0, or 0.0"))
            }
            (_, relative) => Ok(relative),
        }
    }

    /// The setting with each relative number replaced. `f` is given the place in the list or row; `place`: that of the setting.
    pub fn replaced(
        &self,
        name: &str,
        setting: &LocatedValue,
        place: usize,
        f: &mut dyn FnMut(usize, &LocatedValue, Relative) -> Result<f64>,
    ) -> Result<LocatedValue> {
        let datum = match &setting.datum {
            // A word that the type knows is none.
            ParameterValue::Text(text) if !matches!(self.plain, ParameterType::NumberOr(_, word) if word == text) => {
                match self.axis {
                    AxisRef::Places(names) if place >= names.len() => return Ok(setting.clone()),
                    _ => ParameterValue::Number(f(place, setting, self.read(name, setting, text)?)?),
                }
            }
            ParameterValue::List(list) => {
                let part = |(place, part): (usize, &LocatedValue)| self.replaced(name, part, place, f);
                ParameterValue::List(list.iter().enumerate().map(part).collect::<Result<_>>()?)
            }
            other => other.clone(),
        };
        Ok(LocatedValue { datum, origin: setting.origin.clone() })
    }
}

impl RelativeNumber {
    /// Adds the place where it was written to an error.
    pub fn locate(&self, error: Error) -> Error {
        self.setting.origin.locate(error)
    }
}
