//! Settings: the values that a pipeline file, a command-line option or a program gives to parameters, with their origin.

use crate::color::from_hex;
use crate::{Error, Result};
use std::fmt;
use std::sync::Arc;

/// Location of a setting in its file. Ignored when two settings are compared: all spans are equal.
#[derive(Debug, Clone, Default)]
pub enum SourceSpan {
    /// Nowhere that could be shown (a default, a program).
    #[default]
    Nowhere,
    /// Byte range in the pipeline file.
    Span(std::ops::Range<usize>),
    /// A command-line option, as it was typed.
    Option(Arc<str>),
}

impl SourceSpan {
    /// Adds this place to `error`, unless it has a place in the pipeline already.
    pub fn locate(&self, mut error: Error) -> Error {
        let is_placed = error.location.span.is_some() || error.location.file.is_some();
        match self {
            SourceSpan::Span(span) if !is_placed => error.location.span = Some(span.clone()),
            // The option stands in place of the file.
            SourceSpan::Option(option) if !is_placed => error.location.file = Some(option.to_string()),
            _ => {}
        }
        error
    }
}

/// Node that names an array of another one, and where it does so, for errors about the array.
#[derive(Debug, Clone, Default)]
pub struct ArrayOrigin {
    /// The node; `None` of a program.
    pub node: Option<String>,
    /// Location of the name, or else of the node.
    pub span: SourceSpan,
}

impl ArrayOrigin {
    /// Adds the node and the place to `error`, unless it has such already.
    pub fn locate(&self, error: Error) -> Error {
        self.span.locate(self.node.iter().fold(error, Error::at_node))
    }
}

/// As of [`SourceSpan`]: who names an array changes nothing about it.
impl PartialEq for ArrayOrigin {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl Eq for ArrayOrigin {}

/// A value and where it was written.
#[derive(Debug, Clone, PartialEq)]
pub struct LocatedValue {
    /// The value.
    pub datum: ParameterValue,
    /// Location in the file.
    pub origin: SourceSpan,
}

/// A value of a setting; the keys of a table are in the order of the file.
#[derive(Debug, Clone, PartialEq)]
pub enum ParameterValue {
    /// `true` or `false`.
    Boolean(bool),
    /// A whole number.
    Integer(i64),
    /// A number.
    Number(f64),
    /// Text.
    Text(String),
    /// A list.
    List(Vec<LocatedValue>),
    /// A table, in the order of the file.
    Table(Vec<Field>),
}

/// Key of a table in a list of kinds of a thing by which people name it: nothing is made of it.
pub const ENTRY_NAME: &str = "name";

/// True if two lists of tables differ in the tables' names alone.
pub(super) fn differ_in_names(settings: [&Option<LocatedValue>; 2]) -> bool {
    fn others(entry: &LocatedValue) -> Option<Vec<&Field>> {
        Some(entry.table()?.iter().filter(|field| field.name != ENTRY_NAME).collect())
    }
    let [Some(a), Some(b)] = settings.map(|list| list.as_ref().and_then(LocatedValue::list)) else {
        return false;
    };
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| others(a).is_some_and(|own| Some(own) == others(b)))
}

/// One key of a table with its value.
#[derive(Debug, Clone, PartialEq)]
pub struct Field {
    /// The key.
    pub name: String,
    /// Location of the key in the file.
    pub origin: SourceSpan,
    /// Its value.
    pub setting: LocatedValue,
}

impl PartialEq for SourceSpan {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl Eq for SourceSpan {}

impl<T: Into<ParameterValue>> From<T> for LocatedValue {
    fn from(datum: T) -> Self {
        LocatedValue { datum: datum.into(), origin: SourceSpan::Nowhere }
    }
}

impl From<f64> for ParameterValue {
    fn from(number: f64) -> Self {
        ParameterValue::Number(number)
    }
}

impl From<&str> for ParameterValue {
    fn from(text: &str) -> Self {
        ParameterValue::Text(text.to_string())
    }
}

impl From<String> for ParameterValue {
    fn from(text: String) -> Self {
        ParameterValue::Text(text)
    }
}

impl<T: Into<LocatedValue>> FromIterator<T> for ParameterValue {
    fn from_iter<I: IntoIterator<Item = T>>(values: I) -> Self {
        ParameterValue::List(values.into_iter().map(T::into).collect())
    }
}

impl Field {
    /// A key and its value, stated nowhere in a file.
    pub fn new(name: impl Into<String>, value: impl Into<LocatedValue>) -> Field {
        Field { name: name.into(), origin: SourceSpan::Nowhere, setting: value.into() }
    }
}

/// The value of a key of a table.
pub fn find_setting<'a>(fields: &'a [Field], name: &str) -> Option<&'a LocatedValue> {
    fields.iter().find(|field| field.name == name).map(|field| &field.setting)
}

impl LocatedValue {
    /// An error about this setting: `what`, with the value as found and the setting's place.
    pub fn error(&self, what: impl Into<String>, accepted: impl fmt::Display) -> Error {
        self.origin.locate(Error::usage(what).got(&self.datum).expected(accepted))
    }

    /// Location of some bytes of a text; of all of it where it is written with escapes or over several lines.
    pub fn origin_of(&self, bytes: std::ops::Range<usize>) -> SourceSpan {
        match (&self.origin, self.text()) {
            (SourceSpan::Span(whole), Some(text)) if whole.len() == text.len() + 2 => {
                let start = whole.start + 1;
                SourceSpan::Span(start + bytes.start..start + bytes.end.max(bytes.start + 1))
            }
            (origin, _) => origin.clone(),
        }
    }

    /// The value as a number; whole numbers count.
    pub fn number(&self) -> Option<f64> {
        match self.datum {
            ParameterValue::Number(x) => Some(x),
            // Beyond 2^53 the nearest double is meant.
            ParameterValue::Integer(n) => Some(n as f64),
            _ => None,
        }
    }

    /// The value as text.
    pub fn text(&self) -> Option<&str> {
        let ParameterValue::Text(text) = &self.datum else { return None };
        Some(text)
    }

    /// The value as a list.
    pub fn list(&self) -> Option<&[LocatedValue]> {
        let ParameterValue::List(list) = &self.datum else { return None };
        Some(list)
    }

    /// The value as a list of numbers.
    pub fn numbers(&self) -> Option<Vec<f64>> {
        self.list()?.iter().map(LocatedValue::number).collect()
    }

    /// The value as a list of so many numbers.
    pub fn array<const N: usize>(&self) -> Option<[f64; N]> {
        self.numbers()?.try_into().ok()
    }

    /// The value as a colour: linear RGB, of a list as it is, of a text "#rrggbb" from sRGB.
    pub fn color(&self) -> Option<[f64; 3]> {
        self.text().map_or_else(|| self.array(), from_hex)
    }

    /// The value as a table.
    pub fn table(&self) -> Option<&[Field]> {
        let ParameterValue::Table(fields) = &self.datum else { return None };
        Some(fields)
    }

    /// Replaces the value at `path` (keys of tables, numbers of list entries), making keys that are not there.
    pub fn replace(&mut self, path: &[&str], new: LocatedValue) -> Result<()> {
        let Some((first, rest)) = path.split_first() else {
            *self = new;
            return Ok(());
        };
        match &mut self.datum {
            ParameterValue::Table(fields) => replace_field(fields, first, rest, new),
            ParameterValue::List(list) => {
                let count = list.len();
                let place = first.parse::<usize>().ok().filter(|&i| i < count);
                match place {
                    Some(i) => list[i].replace(rest, new),
                    None => Err(Error::usage("there is no such entry in the list")
                        .got(first)
                        .expected(format!("a number below {count}"))),
                }
            }
            other => Err(Error::usage(format!("'{first}' is asked for inside a value that has no parts"))
                .got(other.to_string())),
        }
    }
}

/// Replaces or adds the key `first` (and `rest` within it) of a table.
pub fn replace_field(fields: &mut Vec<Field>, first: &str, rest: &[&str], new: LocatedValue) -> Result<()> {
    if let Some(field) = fields.iter_mut().find(|f| f.name == first) {
        return field.setting.replace(rest, new);
    }
    let origin = new.origin.clone();
    let mut setting = LocatedValue::from(ParameterValue::Table(Vec::new()));
    setting.replace(rest, new)?;
    fields.push(Field { name: first.to_string(), origin, setting });
    Ok(())
}

impl fmt::Display for ParameterValue {
    /// As TOML writes it, on one line.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ParameterValue::Boolean(flag) => write!(f, "{flag}"),
            ParameterValue::Integer(n) => write!(f, "{n}"),
            // Debug is the shortest text that reads back the same, always with a point or an exponent.
            ParameterValue::Number(x) if x.is_finite() => write!(f, "{x:?}"),
            ParameterValue::Number(x) if x.is_nan() => f.write_str("nan"),
            ParameterValue::Number(x) => f.write_str(if *x > 0.0 { "inf" } else { "-inf" }),
            ParameterValue::Text(text) => write_text(f, text),
            ParameterValue::List(list) => {
                f.write_str("[")?;
                for (i, setting) in list.iter().enumerate() {
                    write!(f, "{}{}", if i > 0 { ", " } else { "" }, setting.datum)?;
                }
                f.write_str("]")
            }
            ParameterValue::Table(fields) => {
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
    if bare { name.to_string() } else { ParameterValue::Text(name.to_string()).to_string() }
}
