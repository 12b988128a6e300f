//! Controls: the widget that edits a parameter, by its declaration.

use voltet_graph::{
    AxisRef, Parameter, ParameterType, Range, Registry, RelativeNumberType, StatisticKind, VariantSchema,
};

/// The least factor between the ends of a range for which a slider goes by factors.
const LOGARITHMIC: f64 = 1e3;

/// Scale of a slider.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// Equal steps.
    Linear,
    /// Equal factors: of what is positive and has no end, or far ones.
    Logarithmic,
}

/// Numbers that may be given relative to data, as texts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Relative {
    /// Statistic: percentiles ("p90") as well as fractions ("25 %"), or fractions alone.
    pub is: StatisticKind,
    /// Number of values of a row that may be relative; all where `None`.
    pub places: Option<usize>,
}

/// Control that edits a parameter.
#[derive(Debug, Clone)]
pub enum Control {
    /// On or off.
    Toggle,
    /// A whole number.
    Integer(Range),
    /// A number, or the word where there is one.
    Number {
        /// Its range.
        range: Range,
        /// Scale of the slider.
        scale: Scale,
        /// The word that may stand in its place.
        word: Option<&'static str>,
        /// Relative forms, if valid here.
        relative: Option<Relative>,
    },
    /// One of some words, each with its meaning.
    Choice(Vec<(&'static str, &'static str)>),
    /// Any text.
    Text,
    /// The name of an array of the data; its choices are in the data.
    Array,
    /// Names of arrays.
    Arrays,
    /// Several texts.
    Texts,
    /// A file to read.
    InputFile,
    /// A file to write.
    OutputFile,
    /// Linear red, green and blue; `most`: the largest that each may be, infinite for what glows brighter than white.
    Colour {
        /// The largest value.
        most: f64,
    },
    /// Several numbers.
    Vector {
        /// Number of values; any where `None`.
        count: Option<usize>,
        /// The range of each.
        range: Range,
        /// True if they are whole.
        whole: bool,
        /// Relative forms, if valid here.
        relative: Option<Relative>,
    },
    /// Rows of numbers, each of so many.
    Rows {
        /// Numbers in a row.
        width: Option<usize>,
        /// Relative forms, if valid here.
        relative: Option<Relative>,
    },
    /// A table; its rows are in [`Row::rows`](super::Row::rows).
    Table,
    /// A list of tables of these kinds; they are in [`Row::entries`](super::Row::entries).
    Entries(&'static [VariantSchema]),
}

impl Control {
    /// By a declaration.
    pub(super) fn from_parameter(parameter: &Parameter, registry: &Registry) -> Control {
        Self::of_type(&parameter.parameter_type, parameter.name, None, registry)
    }

    fn of_type(
        parameter_type: &ParameterType,
        name: &str,
        relative: Option<Relative>,
        registry: &Registry,
    ) -> Control {
        let number =
            |range: Range, word| Control::Number { range, scale: Scale::from_range(&range), word, relative };
        match *parameter_type {
            ParameterType::Boolean => Control::Toggle,
            ParameterType::Integer(range) => Control::Integer(range),
            ParameterType::Number(range) => number(range, None),
            ParameterType::NumberOr(range, word) => number(range, Some(word)),
            ParameterType::Text if names_array(name) => Control::Array,
            ParameterType::Text => Control::Text,
            ParameterType::Choice(words) => Control::Choice(words.to_vec()),
            ParameterType::InputPath => Control::InputFile,
            ParameterType::OutputPath => Control::OutputFile,
            ParameterType::Numbers(Some(3), range) if is_colour(name) => Control::Colour { most: range.max },
            ParameterType::Numbers(count, range) => Control::Vector { count, range, whole: false, relative },
            ParameterType::Integers(count, range) => {
                Control::Vector { count: Some(count), range, whole: true, relative }
            }
            ParameterType::Rows(width) => Control::Rows { width, relative },
            ParameterType::Texts if names_array(name) => Control::Arrays,
            ParameterType::Texts => Control::Texts,
            ParameterType::Table(_) => Control::Table,
            ParameterType::Kinds(kinds) => Control::Entries(kinds),
            ParameterType::Measured(measured) => {
                Self::of_type(&measured.plain, name, Some(Relative::from_type(measured)), registry)
            }
            ParameterType::Registered(_) => {
                let schemas = registry.variants(name).map(|variant| variant.schema);
                Control::Choice(schemas.map(|schema| (schema.name, schema.summary)).collect())
            }
            ParameterType::GradientFilter => {
                let filters = registry.filters().map(|filter| filter.declaration());
                Control::Choice(filters.map(|filter| (filter.name, filter.summary)).collect())
            }
        }
    }
}

impl Scale {
    fn from_range(range: &Range) -> Scale {
        let is_wide = range.max.is_infinite() || (range.min > 0.0 && range.max / range.min >= LOGARITHMIC);
        match range.min >= 0.0 && is_wide {
            true => Scale::Logarithmic,
            false => Scale::Linear,
        }
    }
}

impl Relative {
    fn from_type(measured: &RelativeNumberType) -> Relative {
        let places = match measured.axis {
            AxisRef::Places(names) => Some(names.len()),
            AxisRef::Every(_) | AxisRef::Names(_) | AxisRef::EveryPer(..) | AxisRef::NamesPer(..) => None,
        };
        Relative { is: measured.statistic, places }
    }
}

/// True if a text of this name is that of an array: declarations say that it is a text.
fn names_array(name: &str) -> bool {
    ["scalar", "array", "arrays", "field", "fields", "magnitude", "cell_arrays", "point_arrays"]
        .contains(&name)
}

/// True if three numbers of this name are a colour.
fn is_colour(name: &str) -> bool {
    ["color", "background"].contains(&name)
}
