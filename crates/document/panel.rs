//! The parameters of a node as rows of a panel: what each is, what holds now, how it is to be changed, what is typed. Made from the
//! declarations alone.

use crate::Document;
use crate::path::Path;
use voltet_core::arithmetic::decimal;
use voltet_core::{Error, Result};
use voltet_graph::pipeline::value;
use voltet_graph::{
    DefaultValue, Field, LocatedValue, Parameter, ParameterType, ParameterValue, Parameters, Range, Registry,
    VariantSchema, find_setting,
};

/// A parameter as a row.
#[derive(Debug, Clone)]
pub struct Row {
    /// Path from the node's table, for [`Edit::Set`](crate::Edit::Set) and [`Edit::Unset`](crate::Edit::Unset).
    pub path: Path,
    /// Its declaration: name, unit, help, range, standard value.
    pub parameter: &'static Parameter,
    /// Control that edits it.
    pub control: Control,
    /// Value that the file sets.
    pub set_value: Option<ParameterValue>,
    /// Default value, or the reason why there is none.
    pub default: Option<ParameterValue>,
    /// The rows within it: of a table.
    pub rows: Vec<Row>,
    /// The entries of a list of tables.
    pub entries: Vec<Entry>,
}

/// An entry of a list of tables, such as a widget.
#[derive(Debug, Clone)]
pub struct Entry {
    /// Path from the node's table.
    pub path: Path,
    /// Its kind; none where the file names none that is known.
    pub kind: Option<&'static VariantSchema>,
    /// Its parameters.
    pub rows: Vec<Row>,
}

impl Row {
    /// The value that holds: stated, else the standard one.
    pub fn value(&self) -> Option<&ParameterValue> {
        self.set_value.as_ref().or(self.default.as_ref())
    }

    /// A value to begin with; none of what is typed as text.
    pub fn begin(&self) -> Option<ParameterValue> {
        let within = |range: &Range| 1.0f64.clamp(range.min, range.max);
        let several = |one: ParameterValue, count: usize| ParameterValue::List(vec![one.into(); count]);
        match &self.control {
            Control::Integer(range) => Some(ParameterValue::Integer(within(range) as i64)),
            Control::Number { range, .. } => Some(ParameterValue::Number(within(range))),
            Control::Vector { count: Some(count), range, whole: true, .. } => {
                Some(several(ParameterValue::Integer(within(range) as i64), *count))
            }
            // Two numbers that may be negative are a range.
            Control::Vector { count: Some(2), range, .. } if range.min < 0.0 => {
                Some([0.0, 1.0].into_iter().collect())
            }
            Control::Vector { count: Some(count), range, .. } => {
                Some(several(ParameterValue::Number(within(range)), *count))
            }
            Control::Colour { .. } => Some([1.0; 3].into_iter().collect()),
            _ => None,
        }
    }

    /// True if the value is given relative to data: texts in place of numbers.
    pub fn is_relative(&self) -> bool {
        fn has_text(datum: &ParameterValue) -> bool {
            match datum {
                ParameterValue::Text(_) => true,
                ParameterValue::List(list) => list.iter().any(|part| has_text(&part.datum)),
                _ => false,
            }
        }
        match &self.control {
            Control::Number { word, relative: true, .. } => match self.value() {
                Some(ParameterValue::Text(text)) => Some(text.as_str()) != *word,
                _ => false,
            },
            Control::Vector { relative: true, .. } | Control::Rows { relative: true } => {
                self.value().is_some_and(has_text)
            }
            _ => false,
        }
    }

    /// True if the file must state it, and does not.
    pub fn is_missing(&self) -> bool {
        self.set_value.is_none() && matches!(self.parameter.default, DefaultValue::Required)
    }

    /// Default value as text: "0.5", "no widgets: an empty picture", "required".
    pub fn default_text(&self) -> String {
        self.parameter.default.to_string()
    }
}

impl Document {
    /// The rows of a node: its own parameters and, where it names a gradient filter or a variant, those of the filter or the variant. Empty where its type is
    /// not known.
    pub fn rows(&self, registry: &Registry, node: &str) -> Vec<Row> {
        let entry = self.pipeline().nodes.iter().find(|entry| entry.name == node);
        let Some((entry, node)) = entry.zip(self.node_type(registry, node)) else { return Vec::new() };
        let mut rows = rows(registry, node.parameters, &entry.settings, &Path::default());
        let word = |parameter: &Parameter| {
            let row = rows.iter().find(|row| row.parameter.name == parameter.name)?;
            LocatedValue::from(row.value()?.clone()).text().map(str::to_string)
        };
        let filter = node.method().and_then(word);
        let variant = node.registered_parameter().and_then(|parameter| {
            let word = word(parameter)?;
            let mut variants = registry.variants(parameter.name);
            Some(variants.find(|variant| variant.schema.name == word)?.schema.parameters)
        });
        let filter = filter.and_then(|word| Some(registry.find_filter(&word).ok()?.declaration().parameters));
        for declared in [variant, filter].into_iter().flatten() {
            rows.extend(self::rows(registry, declared, &entry.settings, &Path::default()));
        }
        rows
    }
}

fn rows(registry: &Registry, declared: &'static [Parameter], stated: &[Field], path: &Path) -> Vec<Row> {
    let row = |parameter: &'static Parameter| {
        let setting = find_setting(stated, parameter.name);
        let path = path.with(parameter.name);
        let (mut inner, mut entries) = (Vec::new(), Vec::new());
        if let ParameterType::Table(declared) = parameter.parameter_type {
            inner =
                rows(registry, declared, setting.and_then(LocatedValue::table).unwrap_or_default(), &path);
        }
        if let ParameterType::Kinds(kinds) = parameter.parameter_type {
            let list = setting.and_then(LocatedValue::list).unwrap_or_default();
            entries =
                list.iter().enumerate().map(|(i, one)| entry(registry, kinds, one, path.with(i))).collect();
        }
        Row {
            path,
            parameter,
            control: Control::of_type(&parameter.parameter_type, parameter.name, false, registry),
            set_value: setting.map(|setting| setting.datum.clone()),
            default: parameter.default.datum(),
            rows: inner,
            entries,
        }
    };
    declared.iter().map(row).collect()
}

fn entry(registry: &Registry, kinds: &'static [VariantSchema], setting: &LocatedValue, path: Path) -> Entry {
    let fields = setting.table().unwrap_or_default();
    let word = find_setting(fields, "kind").and_then(LocatedValue::text);
    let kind = kinds.iter().find(|kind| Some(kind.name) == word);
    let rows = kind.map(|kind| rows(registry, kind.parameters, fields, &path)).unwrap_or_default();
    Entry { path, kind, rows }
}

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

/// Control that edits a parameter. `relative`: it may be given relative to data, as a text.
#[derive(Debug, Clone)]
#[allow(missing_docs, reason = "the fields' names say what they are")]
pub enum Control {
    /// On or off.
    Toggle,
    /// A whole number.
    Integer(Range),
    /// A number, or the word where there is one.
    Number { range: Range, scale: Scale, word: Option<&'static str>, relative: bool },
    /// One of some words, each with its meaning.
    Choice(Vec<(&'static str, &'static str)>),
    /// Any text.
    Text,
    /// The name of an array of the data; its choices are in the data.
    Array,
    /// Names of arrays.
    Arrays,
    /// An expression over arrays.
    Expression,
    /// Several texts.
    Texts,
    /// A file to read.
    InputFile,
    /// A file to write.
    OutputFile,
    /// Linear red, green and blue; `most`: the largest that each may be, infinite for what glows brighter than white.
    Colour { most: f64 },
    /// Several numbers, any number of them where `count` is none; `whole`: integers.
    Vector { count: Option<usize>, range: Range, whole: bool, relative: bool },
    /// Rows of numbers.
    Rows { relative: bool },
    /// A table; its rows are in [`Row::rows`].
    Table,
    /// A list of tables of these kinds; they are in [`Row::entries`].
    Entries(&'static [VariantSchema]),
}

impl Control {
    fn of_type(parameter_type: &ParameterType, name: &str, relative: bool, registry: &Registry) -> Control {
        let number =
            |range: Range, word| Control::Number { range, scale: Scale::from_range(&range), word, relative };
        match *parameter_type {
            ParameterType::Boolean => Control::Toggle,
            ParameterType::Integer(range) | ParameterType::IntegerOr(range, _) => Control::Integer(range),
            ParameterType::Number(range) => number(range, None),
            ParameterType::NumberOr(range, word) => number(range, Some(word)),
            ParameterType::ArrayName => Control::Array,
            ParameterType::Expression => Control::Expression,
            ParameterType::Text | ParameterType::NewArrayName => Control::Text,
            ParameterType::Choice(words) => Control::Choice(words.to_vec()),
            ParameterType::InputPath | ParameterType::ChoiceOrPath(..) => Control::InputFile,
            ParameterType::OutputPath => Control::OutputFile,
            ParameterType::Color(range) => Control::Colour { most: range.max },
            ParameterType::Numbers(count, range) => Control::Vector { count, range, whole: false, relative },
            ParameterType::Integers(count, range) => {
                Control::Vector { count: Some(count), range, whole: true, relative }
            }
            ParameterType::Rows(_) | ParameterType::RowsOr(..) => Control::Rows { relative },
            ParameterType::ArrayNames => Control::Arrays,
            ParameterType::Texts => Control::Texts,
            ParameterType::Table(_) => Control::Table,
            ParameterType::Kinds(kinds) => Control::Entries(kinds),
            ParameterType::Measured(measured) => Self::of_type(&measured.plain, name, true, registry),
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
        if range.min >= 0.0 && is_wide { Scale::Logarithmic } else { Scale::Linear }
    }
}

/// Extent and view of the data that first values are found by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DataExtent {
    /// Least and greatest coordinates of the data, world units.
    pub bounds: [[f64; 3]; 2],
    /// Direction in which the data are seen.
    pub forward: [f64; 3],
}

impl DataExtent {
    /// Point at shares of the bounds, as finely as a thousandth of them.
    fn point(&self, shares: [f64; 3]) -> ParameterValue {
        let [low, high] = self.bounds;
        let at = |k: usize| decimal(low[k] + shares[k] * (high[k] - low[k]), 1e-3 * (high[k] - low[k]));
        (0..3).map(at).collect()
    }

    /// Unit vector along the axis that is nearest to the direction of sight.
    fn axis(&self) -> ParameterValue {
        let is_most = |k: usize| (0..3).all(|other| self.forward[other].abs() <= self.forward[k].abs());
        let axis = (0..3).find(|k| is_most(*k)).unwrap_or(0);
        (0..3).map(|k| if k == axis { 1f64.copysign(self.forward[k]) } else { 0.0 }).collect()
    }

    /// A quarter of the diagonal of the bounds.
    fn radius(&self) -> f64 {
        let [low, high] = self.bounds;
        let diagonal = (0..3).map(|k| (high[k] - low[k]).powi(2)).sum::<f64>().sqrt();
        decimal(0.25 * diagonal, 1e-3 * diagonal)
    }
}

/// A new entry of a list of tables, such as a widget: what is required has a value to begin with, in the middle of the data where it lies in
/// them, but for names of arrays and files; a normal is along the direction of sight.
pub fn default_value(kind: &VariantSchema, extent: &DataExtent) -> ParameterValue {
    let is_needed = |parameter: &&Parameter| {
        matches!(parameter.default, DefaultValue::Required) || ["sigma", "normal"].contains(&parameter.name)
    };
    let needed = kind.parameters.iter().filter(is_needed);
    let fields = needed.filter_map(|parameter| first_field(parameter, extent));
    ParameterValue::Table(std::iter::once(Field::new("kind", kind.name)).chain(fields).collect())
}

/// A parameter with a value to begin with, by its name and unit; `None` where these are not known together, or where the declaration
/// refuses the value.
pub fn first_field(parameter: &Parameter, extent: &DataExtent) -> Option<Field> {
    // Of s, of s and g, or of any fields.
    let one_or_more = |both: [&str; 2]| match parameter.parameter_type {
        ParameterType::Measured(measured) => match measured.plain {
            ParameterType::Numbers(Some(2), _) => both.into_iter().collect(),
            ParameterType::Numbers(..) => both[..1].iter().copied().collect(),
            _ => both[0].into(),
        },
        _ => both[0].into(),
    };
    let value = match (parameter.name, parameter.unit) {
        ("normal" | "direction", "world space") => extent.axis(),
        ("origin" | "centre", "world units") => extent.point([0.5; 3]),
        ("low", "world units") => extent.point([0.25; 3]),
        ("high", "world units") => extent.point([0.75; 3]),
        ("radius", "world units") => extent.radius().into(),
        ("color", "linear RGB") => [1.0, 0.6, 0.2].into_iter().collect(),
        ("extinction", "per unit_distance") => ParameterValue::Number(10.0),
        ("text", _) => "text".into(),
        ("at", "shares of width and height") => [0.5, 0.5].into_iter().collect(),
        // Texts below are relative to the data, which the type allows or not.
        ("values", _) => ["50 %"].into_iter().collect(),
        ("centre", _) => one_or_more(["50 %", "0 %"]),
        ("sigma", _) => one_or_more(["10 %", "20 %"]),
        ("period", _) => "10 %".into(),
        ("points", "(s, linear RGB, per unit_distance)") => {
            let rows = [[0.0, 0.1, 0.2, 0.9, 0.0], [1.0, 1.0, 0.6, 0.2, 10.0]];
            rows.into_iter().map(ParameterValue::from_iter).collect()
        }
        // The axes of a picture that is a table.
        ("s" | "g", _) => ["0 %", "100 %"].into_iter().collect(),
        ("range", _) => ["50 %", "100 %"].into_iter().collect(),
        ("region", _) => {
            ParameterValue::Table(vec![Field::new("s", ParameterValue::from_iter(["25 %", "75 %"]))])
        }
        _ => match parameter.parameter_type {
            ParameterType::Table(own) => {
                ParameterValue::Table(own.iter().filter_map(|own| first_field(own, extent)).collect())
            }
            _ => return None,
        },
    };
    let field = Field::new(parameter.name, value);
    let checked = Parameters::check(&[*parameter], std::slice::from_ref(&field), &Default::default(), &[]);
    checked.is_ok().then_some(field)
}

/// Value of a text typed for a row: a number as it is, "25 %" and "p90" where valid, several numbers with commas or
/// spaces between, in brackets or not, texts without quotes. Errors say in words what is wrong and what would be right.
pub fn typed(row: &Row, text: &str) -> Result<ParameterValue> {
    let text = text.trim();
    let datum = match &row.control {
        Control::Text
        | Control::Array
        | Control::Expression
        | Control::InputFile
        | Control::OutputFile
        | Control::Choice(_) => ParameterValue::Text(text.to_string()),
        Control::Toggle | Control::Integer(_) | Control::Number { .. } => read(text),
        Control::Texts | Control::Arrays => list(text, &|part| ParameterValue::Text(part.to_string())),
        Control::Colour { .. } if text.starts_with('#') => ParameterValue::Text(text.to_string()),
        Control::Colour { .. } | Control::Vector { .. } => list(text, &read),
        Control::Rows { .. } | Control::Table | Control::Entries(_) => {
            value(&text.replace(['\r', '\n'], " "))
                .map_or_else(|| ParameterValue::Text(text.to_string()), |v| v.datum)
        }
    };
    // Which gradient filters there are is not in the declaration.
    if let (Control::Choice(words), ParameterValue::Text(text)) = (&row.control, &datum)
        && !words.iter().any(|(word, _)| word == text)
    {
        let error = Error::usage(format!("'{}' does not know this word", row.parameter.name)).got(&datum);
        return Err(error.not_among(text, words.iter().map(|(word, _)| *word)));
    }
    let field = Field::new(row.parameter.name, datum.clone());
    Parameters::check(&[*row.parameter], &[field], &Default::default(), &[]).map_err(
        |error| match &datum {
            ParameterValue::Text(text)
                if text.contains(',') && text.replace(',', ".").parse::<f64>().is_ok() =>
            {
                Error::usage("a number has a point, not a comma").got(text).expected(text.replace(',', "."))
            }
            _ => error,
        },
    )?;
    Ok(datum)
}

/// A value as it is shown for typing: what [`typed`] reads again.
pub fn to_text(datum: &ParameterValue) -> String {
    match datum {
        ParameterValue::Text(text) => text.clone(),
        ParameterValue::List(list)
            if list.iter().all(|part| part.list().is_none() && part.table().is_none()) =>
        {
            list.iter().map(|part| to_text(&part.datum)).collect::<Vec<_>>().join(", ")
        }
        other => other.to_string(),
    }
}

/// A word as a number or a flag, else as a text.
fn read(text: &str) -> ParameterValue {
    match value(text) {
        Some(LocatedValue {
            datum:
                datum @ (ParameterValue::Integer(_) | ParameterValue::Number(_) | ParameterValue::Boolean(_)),
            ..
        }) => datum,
        Some(LocatedValue { datum: ParameterValue::Text(text), .. }) => ParameterValue::Text(text),
        // ".5" and "1." are no TOML, and numbers all the same.
        _ => text.parse().map_or_else(|_| ParameterValue::Text(text.to_string()), ParameterValue::Number),
    }
}

/// Parts with commas between, or spaces where there is no comma.
fn list(text: &str, part: &dyn Fn(&str) -> ParameterValue) -> ParameterValue {
    if let Some(LocatedValue { datum: datum @ ParameterValue::List(_), .. }) = value(text) {
        return datum;
    }
    let inner = text.strip_prefix('[').and_then(|text| text.strip_suffix(']')).unwrap_or(text);
    let is_separator = |c: char| if inner.contains(',') { c == ',' } else { c.is_whitespace() };
    let mut parts: Vec<String> = Vec::new();
    for word in inner.split(is_separator).map(|part| part.trim().trim_matches('"')) {
        match parts.last_mut() {
            // "25 %" is one number.
            Some(number) if word == "%" => number.push_str(" %"),
            _ if word.is_empty() => {}
            _ => parts.push(word.to_string()),
        }
    }
    parts.iter().map(|own| part(own)).collect()
}
