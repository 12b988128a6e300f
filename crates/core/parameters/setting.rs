//! Settings: what a pipeline file, a command-line option or a program gives for a parameter, with its origin.

use crate::{Error, Result};
use std::fmt;
use std::sync::Arc;

/// Where something was written. Of no account when two settings are compared: all origins are equal.
#[derive(Debug, Clone, Default)]
pub enum Origin {
    /// Nowhere that could be shown (a default, a program).
    #[default]
    Nowhere,
    /// Byte range in the pipeline file.
    Span(std::ops::Range<usize>),
    /// A command-line option, as it was typed.
    Option(Arc<str>),
}

impl Origin {
    /// Adds this place to `error`, unless it has a place in the pipeline already.
    pub fn blame(&self, mut error: Error) -> Error {
        match self {
            Origin::Nowhere => {}
            Origin::Span(span) => {
                if error.place.span.is_none() && error.place.file.is_none() {
                    error.place.span = Some(span.clone());
                }
            }
            Origin::Option(option) => {
                // The option stands in place of the file.
                if error.place.span.is_none() && error.place.file.is_none() {
                    error.place.file = Some(option.to_string());
                }
            }
        }
        error
    }
}

/// A value and where it was written.
#[derive(Debug, Clone, PartialEq)]
pub struct Setting {
    /// The value.
    pub datum: Datum,
    /// Where it was written.
    pub origin: Origin,
}

/// A value of a setting.
#[derive(Debug, Clone, PartialEq)]
pub enum Datum {
    /// `true` or `false`.
    Boolean(bool),
    /// A whole number.
    Integer(i64),
    /// A number.
    Number(f64),
    /// Text.
    Text(String),
    /// A list.
    List(Vec<Setting>),
    /// A table, in the order of the file.
    Table(Vec<Field>),
}

/// One key of a table with its value.
#[derive(Debug, Clone, PartialEq)]
pub struct Field {
    /// The key.
    pub name: String,
    /// Where the key was written.
    pub origin: Origin,
    /// Its value.
    pub setting: Setting,
}

impl PartialEq for Origin {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl From<Datum> for Setting {
    fn from(datum: Datum) -> Self {
        Setting { datum, origin: Origin::Nowhere }
    }
}

impl Setting {
    /// An error about this setting: `what`, with the value as found and the setting's place.
    pub fn error(&self, what: impl Into<String>, accepted: impl fmt::Display) -> Error {
        self.origin.blame(Error::usage(what).found(&self.datum).accepted(accepted))
    }

    /// The value as a number; whole numbers count.
    pub fn number(&self) -> Option<f64> {
        match self.datum {
            Datum::Number(x) => Some(x),
            // Beyond 2^53 the nearest double is meant.
            Datum::Integer(n) => Some(n as f64),
            _ => None,
        }
    }

    /// The value as text.
    pub fn text(&self) -> Option<&str> {
        match &self.datum {
            Datum::Text(text) => Some(text),
            _ => None,
        }
    }

    /// The value as a list.
    pub fn list(&self) -> Option<&[Setting]> {
        match &self.datum {
            Datum::List(list) => Some(list),
            _ => None,
        }
    }

    /// The value as a list of numbers.
    pub fn numbers(&self) -> Option<Vec<f64>> {
        self.list()?.iter().map(Setting::number).collect()
    }

    /// The value as a table.
    pub fn table(&self) -> Option<&[Field]> {
        match &self.datum {
            Datum::Table(fields) => Some(fields),
            _ => None,
        }
    }

    /// Replaces the value at `path` (keys of tables, numbers of list entries), making keys that are not there.
    pub fn replace(&mut self, path: &[&str], new: Setting) -> Result<()> {
        let Some((first, rest)) = path.split_first() else {
            *self = new;
            return Ok(());
        };
        match &mut self.datum {
            Datum::Table(fields) => replace_field(fields, first, rest, new),
            Datum::List(list) => {
                let count = list.len();
                let place = first.parse::<usize>().ok().filter(|&i| i < count);
                match place {
                    Some(i) => list[i].replace(rest, new),
                    None => Err(Error::usage("there is no such entry in the list")
                        .found(first)
                        .accepted(format!("a number below {count}"))),
                }
            }
            other => Err(Error::usage(format!("'{first}' is asked for inside a value that has no parts"))
                .found(other.to_string())),
        }
    }
}

/// Replaces or adds the key `first` (and `rest` within it) of a table.
pub fn replace_field(fields: &mut Vec<Field>, first: &str, rest: &[&str], new: Setting) -> Result<()> {
    if let Some(field) = fields.iter_mut().find(|f| f.name == first) {
        return field.setting.replace(rest, new);
    }
    let origin = new.origin.clone();
    let mut setting = if rest.is_empty() { new.clone() } else { Datum::Table(Vec::new()).into() };
    if !rest.is_empty() {
        setting.replace(rest, new)?;
    }
    fields.push(Field { name: first.to_string(), origin, setting });
    Ok(())
}

impl fmt::Display for Datum {
    /// As TOML writes it, on one line.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Datum::Boolean(flag) => write!(f, "{flag}"),
            Datum::Integer(n) => write!(f, "{n}"),
            // Debug is the shortest text that reads back the same, always with a point or an exponent.
            Datum::Number(x) if x.is_finite() => write!(f, "{x:?}"),
            Datum::Number(x) if x.is_nan() => f.write_str("nan"),
            Datum::Number(x) => f.write_str(if *x > 0.0 { "inf" } else { "-inf" }),
            Datum::Text(text) => write_text(f, text),
            Datum::List(list) => {
                f.write_str("[")?;
                for (i, setting) in list.iter().enumerate() {
                    write!(f, "{}{}", if i > 0 { ", " } else { "" }, setting.datum)?;
                }
                f.write_str("]")
            }
            Datum::Table(fields) => {
                f.write_str("{")?;
                for (i, field) in fields.iter().enumerate() {
                    let comma = if i > 0 { "," } else { "" };
                    write!(f, "{comma} {} = {}", key_text(&field.name), field.setting.datum)?;
                }
                f.write_str(" }")
            }
        }
    }
}

/// A TOML basic string.
fn write_text(f: &mut fmt::Formatter<'_>, text: &str) -> fmt::Result {
    f.write_str("\"")?;
    for c in text.chars() {
        match c {
            '"' => f.write_str("\\\"")?,
            '\\' => f.write_str("\\\\")?,
            '\n' => f.write_str("\\n")?,
            '\t' => f.write_str("\\t")?,
            '\r' => f.write_str("\\r")?,
            c if c.is_control() => write!(f, "\\u{:04X}", c as u32)?,
            c => write!(f, "{c}")?,
        }
    }
    f.write_str("\"")
}

/// A TOML key: bare where that is allowed, quoted otherwise.
pub fn key_text(name: &str) -> String {
    let bare = !name.is_empty() && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '-' || c == '_');
    if bare { name.to_string() } else { Datum::Text(name.to_string()).to_string() }
}
