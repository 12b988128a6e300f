//! Values to begin with, where the file states none and none holds.

use super::{Control, Row};
use voltet_graph::{
    DefaultValue, Field, LocatedValue, Parameter, ParameterType, ParameterValue, Range, VariantSchema,
};

impl Row {
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
            Control::Vector { count: Some(2), range, .. } if range.min < 0.0 => Some(numbers(&[0.0, 1.0])),
            Control::Vector { count: Some(count), range, .. } => {
                Some(several(ParameterValue::Number(within(range)), *count))
            }
            Control::Colour { .. } => Some(numbers(&[1.0; 3])),
            Control::Toggle
            | Control::Choice(_)
            | Control::Text
            | Control::Array
            | Control::Arrays
            | Control::Texts
            | Control::InputFile
            | Control::OutputFile
            | Control::Vector { count: None, .. }
            | Control::Rows { .. }
            | Control::Table
            | Control::Entries(_) => None,
        }
    }
}

/// A new entry of a list of tables, such as a widget: what is required has a value to begin with, in the middle of the data
/// where it lies in them; but for names of arrays and files.
pub fn default_value(kind: &VariantSchema) -> ParameterValue {
    let field = |name: &str, datum: ParameterValue| Field {
        name: name.into(),
        origin: Default::default(),
        setting: datum.into(),
    };
    let is_needed = |parameter: &&Parameter| {
        matches!(parameter.default, DefaultValue::Required) || (parameter.name == "sigma")
    };
    let needed = kind.parameters.iter().filter(is_needed);
    let values = needed.filter_map(|parameter| Some(field(parameter.name, value(parameter)?)));
    ParameterValue::Table(std::iter::once(field("kind", text(kind.name))).chain(values).collect())
}

fn value(parameter: &Parameter) -> Option<ParameterValue> {
    // Of s, of s and g, or of any fields.
    let one_or_more = |both: [&str; 2]| match parameter.parameter_type {
        ParameterType::Measured(measured) => match measured.plain {
            ParameterType::Numbers(Some(2), _) => texts(&both),
            ParameterType::Numbers(..) => texts(&both[..1]),
            _ => text(both[0]),
        },
        _ => text(both[0]),
    };
    Some(match parameter.name {
        "color" => numbers(&[1.0, 0.6, 0.2]),
        "extinction" => ParameterValue::Number(10.0),
        "centre" => one_or_more(["50 %", "0 %"]),
        "sigma" => one_or_more(["10 %", "20 %"]),
        "period" => text("10 %"),
        "points" => ParameterValue::List(vec![
            numbers(&[0.0, 0.1, 0.2, 0.9, 0.0]).into(),
            numbers(&[1.0, 1.0, 0.6, 0.2, 10.0]).into(),
        ]),
        // The axes of a picture that is a table.
        "s" | "g" => texts(&["0 %", "100 %"]),
        "region" => ParameterValue::Table(vec![Field {
            name: "s".into(),
            origin: Default::default(),
            setting: texts(&["25 %", "75 %"]).into(),
        }]),
        _ => return None,
    })
}

fn text(text: &str) -> ParameterValue {
    ParameterValue::Text(text.into())
}

fn texts(list: &[&str]) -> ParameterValue {
    ParameterValue::List(list.iter().map(|one| LocatedValue::from(text(one))).collect())
}

fn numbers(list: &[f64]) -> ParameterValue {
    ParameterValue::List(list.iter().map(|&x| LocatedValue::from(ParameterValue::Number(x))).collect())
}
