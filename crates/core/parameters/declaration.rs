//! Declaration of a parameter: name, type, unit, range, default value, help.

use super::setting::ParameterValue;
use crate::counted;
use std::any::Any;
use std::sync::Arc;

/// A parameter of a node or a gradient filter, or of a table within one.
#[derive(Debug, Clone, Copy)]
pub struct Parameter {
    /// The key in a pipeline file.
    pub name: &'static str,
    /// Type of the value.
    pub parameter_type: ParameterType,
    /// Its unit, empty where it has none.
    pub unit: &'static str,
    /// Value where the file sets none.
    pub default: DefaultValue,
    /// One line of help.
    pub help: &'static str,
}

/// Value of a parameter that the file does not set. `Required`: the file must set it; `Unset`: none, and the text says what that means.
#[derive(Debug, Clone, Copy)]
pub enum DefaultValue {
    /// The file must give it.
    Required,
    /// Nothing; the text says what that means.
    Unset(&'static str),
    /// A flag.
    Boolean(bool),
    /// A whole number.
    Integer(i64),
    /// A number.
    Number(f64),
    /// A word or text.
    Text(&'static str),
    /// A vector.
    Numbers(&'static [f64]),
    /// A vector of whole numbers.
    Integers(&'static [i64]),
    /// Several texts, such as numbers relative to data.
    Texts(&'static [&'static str]),
}

/// Type of a parameter's value.
#[derive(Debug, Clone, Copy)]
pub enum ParameterType {
    /// `true` or `false`.
    Boolean,
    /// A whole number within the range.
    Integer(Range),
    /// A whole number within the range, or the word.
    IntegerOr(Range, &'static str),
    /// A number within the range.
    Number(Range),
    /// A number within the range, or the word.
    NumberOr(Range, &'static str),
    /// Any text.
    Text,
    /// The name of an array of the data; "NAME:0" and "NAME:magnitude" for vectors.
    ArrayName,
    /// The name of an array that the node makes.
    NewArrayName,
    /// An expression over arrays, as [`Expression`](crate::expression::Expression) reads them.
    Expression,
    /// One of the words; each with its meaning.
    Choice(&'static [(&'static str, &'static str)]),
    /// A file to read, relative to the pipeline file.
    InputPath,
    /// A file to write, relative to the pipeline file.
    OutputPath,
    /// Several numbers, each within the range; `Some(n)`: exactly n of them.
    Numbers(Option<usize>, Range),
    /// A colour: red, green and blue, linear and each within the range, or "#rrggbb" in sRGB.
    Color(Range),
    /// Exactly n whole numbers, each within the range.
    Integers(usize, Range),
    /// Rows of numbers; `Some(n)`: exactly n in each row.
    Rows(Option<usize>),
    /// Rows of so many numbers, or one of the words; each with its meaning.
    RowsOr(usize, &'static [(&'static str, &'static str)]),
    /// One of the words, each with its meaning, or a file to read with one of these endings, relative to the pipeline file.
    ChoiceOrPath(&'static [(&'static str, &'static str)], &'static [&'static str]),
    /// Several texts.
    Texts,
    /// The names of several arrays of the data.
    ArrayNames,
    /// A table with these keys.
    Table(&'static [Parameter]),
    /// A list of tables, each of a kind that its key `kind` names.
    Kinds(&'static [VariantSchema]),
    /// A type whose numbers may be given relative to data, as texts such as "25 %" and "p90".
    Measured(&'static RelativeNumberType),
    /// The name of a gradient filter, of those that are registered; what it declares stands beside this parameter.
    GradientFilter,
    /// The name of one of the variants that are registered for the parameter; the text is a noun with its article. The parameters
    /// of all variants stand beside this one, and those of the chosen one count.
    Registered(&'static str),
}

/// A type whose numbers may be given relative to data.
#[derive(Debug, Clone, Copy)]
pub struct RelativeNumberType {
    /// The type without relative numbers.
    pub plain: ParameterType,
    /// Statistic that a relative number refers to.
    pub statistic: StatisticKind,
    /// Arrays that the numbers refer to.
    pub axis: AxisRef,
}

/// Statistic that a relative number refers to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StatisticKind {
    /// A value of a field: shares and percentiles.
    Value,
    /// A place in space: shares.
    Place,
    /// A width or a length: shares above 0.
    Width,
    /// A factor on a field's values; a share says how much of the range counts as 1.
    Factor,
}

/// Arrays that the numbers of a list, or of each row, refer to.
#[derive(Debug, Clone, Copy)]
pub enum AxisRef {
    /// All of one.
    Every(&'static str),
    /// By their place; those beyond the list are not relative.
    Places(&'static [&'static str]),
    /// By their place in the list of arrays that another parameter gives.
    Names(&'static str),
    /// All of one per unit of another.
    EveryPer(&'static str, &'static str),
    /// As `Names`, per unit of the array that a further parameter names.
    NamesPer(&'static str, &'static str),
}

/// One of several kinds of a thing, named by a word, with parameters of its own: a table in a [`ParameterType::Kinds`]
/// list, or a gradient filter.
#[derive(Debug, Clone, Copy)]
pub struct VariantSchema {
    /// The word.
    pub name: &'static str,
    /// Description, one sentence.
    pub summary: &'static str,
    /// Its keys beside the one that holds the word.
    pub parameters: &'static [Parameter],
}

/// A variant that a program registered for a parameter of type [`ParameterType::Registered`].
#[derive(Clone)]
pub struct Variant {
    /// Its name, summary and parameters.
    pub schema: VariantSchema,
    /// The object behind the name, for the code that knows its type.
    pub object: Arc<dyn Any + Send + Sync>,
}

impl std::fmt::Debug for Variant {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Variant").field("name", &self.schema.name).finish_non_exhaustive()
    }
}

impl DefaultValue {
    /// The value, if this is one.
    pub fn datum(&self) -> Option<ParameterValue> {
        match *self {
            DefaultValue::Required | DefaultValue::Unset(_) => None,
            DefaultValue::Boolean(flag) => Some(ParameterValue::Boolean(flag)),
            DefaultValue::Integer(n) => Some(ParameterValue::Integer(n)),
            DefaultValue::Number(x) => Some(ParameterValue::Number(x)),
            DefaultValue::Text(text) => Some(ParameterValue::Text(text.to_string())),
            DefaultValue::Numbers(xs) => Some(xs.iter().copied().collect()),
            DefaultValue::Texts(texts) => Some(texts.iter().copied().collect()),
            DefaultValue::Integers(ns) => Some(ns.iter().map(|&n| ParameterValue::Integer(n)).collect()),
        }
    }
}

impl ParameterType {
    /// The words that it knows, each with its meaning.
    pub fn words(&self) -> &'static [(&'static str, &'static str)] {
        match self {
            ParameterType::Choice(words)
            | ParameterType::RowsOr(_, words)
            | ParameterType::ChoiceOrPath(words, _) => words,
            _ => &[],
        }
    }

    /// True if a value of this type is the path of a file to read.
    pub fn is_input_path(&self, text: &str) -> bool {
        match self {
            ParameterType::InputPath => true,
            ParameterType::ChoiceOrPath(words, _) => words.iter().all(|(word, _)| *word != text),
            _ => false,
        }
    }

    /// The type in words, with its range: "number above 0", "3 numbers", "exact | centroid | none | auto".
    pub fn describe(&self) -> String {
        let joined = |words: &[(&str, &str)]| words.iter().map(|w| w.0).collect::<Vec<_>>().join(" | ");
        let ranged = |noun: &str, range: &Range| {
            let range = range.to_string();
            if range.is_empty() { noun.to_string() } else { format!("{noun} {range}") }
        };
        match self {
            ParameterType::Boolean => "true | false".into(),
            ParameterType::Integer(range) => ranged("whole number", range),
            ParameterType::IntegerOr(range, word) => {
                format!("{} or \"{word}\"", ranged("whole number", range))
            }
            ParameterType::Number(range) => ranged("number", range),
            ParameterType::NumberOr(range, word) => format!("{} or \"{word}\"", ranged("number", range)),
            ParameterType::Text => "text".into(),
            ParameterType::ArrayName => "name of an array".into(),
            ParameterType::NewArrayName => "name of a new array".into(),
            ParameterType::Expression => "expression".into(),
            ParameterType::Choice(words) => joined(words),
            ParameterType::RowsOr(n, words) => {
                format!("{} | list of rows of {}", joined(words), counted(*n, "number"))
            }
            ParameterType::ChoiceOrPath(words, endings) => {
                format!("{} | path of a file .{}", joined(words), endings.join(" or ."))
            }
            ParameterType::Color(range) => format!("\"#rrggbb\" in sRGB or {}", ranged("3 numbers", range)),
            ParameterType::InputPath | ParameterType::OutputPath => "path".into(),
            ParameterType::Numbers(Some(n), range) => ranged(&counted(*n, "number"), range),
            ParameterType::Numbers(None, range) => ranged("list of numbers", range),
            ParameterType::Integers(n, range) => ranged(&counted(*n, "whole number"), range),
            ParameterType::Rows(Some(n)) => format!("list of rows of {}", counted(*n, "number")),
            ParameterType::Rows(None) => "list of rows of numbers".into(),
            ParameterType::Texts => "list of texts".into(),
            ParameterType::ArrayNames => "list of names of arrays".into(),
            ParameterType::Table(fields) => {
                format!("table of {}", fields.iter().map(|p| p.name).collect::<Vec<_>>().join(", "))
            }
            ParameterType::Kinds(_) => "list of tables, each with a kind".into(),
            ParameterType::Measured(measured) => {
                format!("{}, {}", measured.plain.describe(), measured.describe())
            }
            ParameterType::GradientFilter => "name of a gradient filter".into(),
            ParameterType::Registered(noun) => format!("name of {noun}"),
        }
    }
}

impl RelativeNumberType {
    /// Forms of a relative number, for help and messages.
    pub(super) fn describe(&self) -> &'static str {
        match self.statistic {
            StatisticKind::Value => "or \"25 %\" of the range, \"p90\" by volume",
            StatisticKind::Place => "or \"25 %\" of the bounds",
            StatisticKind::Width => "or \"5 %\" of the range's length",
            StatisticKind::Factor => "or \"5 %\": 1 for so much of the range",
        }
    }
}

impl std::fmt::Display for DefaultValue {
    /// As a pipeline file would write it; "required" or the meaning of leaving it out otherwise.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            DefaultValue::Required => f.write_str("required"),
            DefaultValue::Unset(meaning) => f.write_str(meaning),
            other => match other.datum() {
                Some(datum) => write!(f, "{datum}"),
                None => Ok(()),
            },
        }
    }
}

/// The range of a number. Numbers are finite unless the range says otherwise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    /// Smallest value.
    pub min: f64,
    /// Largest value.
    pub max: f64,
    /// True if `min` itself is excluded.
    pub above_min: bool,
    /// True if `max` itself is excluded.
    pub below_max: bool,
    /// True if infinite values are allowed.
    pub infinite: bool,
}

impl Range {
    /// Any finite number.
    pub const ANY: Range = Range {
        min: f64::NEG_INFINITY,
        max: f64::INFINITY,
        above_min: false,
        below_max: false,
        infinite: false,
    };
    /// Any number, infinite ones too.
    pub const ANY_OR_INFINITE: Range = Range { infinite: true, ..Range::ANY };

    /// `min` or more.
    pub const fn at_least(min: f64) -> Range {
        Range { min, ..Range::ANY }
    }

    /// More than `min`.
    pub const fn above(min: f64) -> Range {
        Range { min, above_min: true, ..Range::ANY }
    }

    /// From `min` to `max`, both included.
    pub const fn within(min: f64, max: f64) -> Range {
        Range { min, max, ..Range::ANY }
    }

    /// Between `min` and `max`, both excluded.
    pub const fn between(min: f64, max: f64) -> Range {
        Range { min, max, above_min: true, below_max: true, infinite: false }
    }

    /// True if `x` lies in the range; NaN never does.
    pub fn holds(&self, x: f64) -> bool {
        (x.is_finite() || (self.infinite && x.is_infinite()))
            && (x > self.min || (x == self.min && !self.above_min))
            && (x < self.max || (x == self.max && !self.below_max))
    }
}

impl std::fmt::Display for Range {
    /// "above 0", "0 or more", "from 0 to 1", "between 0 and 180", or nothing.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Range { min, max, above_min, below_max, infinite } = *self;
        match (min.is_finite(), max.is_finite()) {
            (false, false) => Ok(()),
            (true, false) if above_min => write!(f, "above {min}"),
            (true, false) => write!(f, "{min} or more"),
            (false, true) if below_max => write!(f, "below {max}"),
            (false, true) => write!(f, "{max} or less"),
            (true, true) if above_min && below_max => write!(f, "between {min} and {max}"),
            (true, true) if above_min => write!(f, "above {min}, up to {max}"),
            (true, true) if below_max => write!(f, "from {min} to below {max}"),
            (true, true) => write!(f, "from {min} to {max}"),
        }?;
        if infinite && (min.is_finite() || max.is_finite()) {
            f.write_str(", or inf")?;
        }
        Ok(())
    }
}
