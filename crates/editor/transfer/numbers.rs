//! Numbers of a widget's table, as they are read and written.

use voltet_graph::{Field, LocatedValue, ParameterValue};

pub(super) fn find<'a>(fields: &'a [Field], name: &str) -> Option<&'a LocatedValue> {
    fields.iter().find(|field| field.name == name).map(|field| &field.setting)
}

pub(super) fn array<const N: usize>(fields: &[Field], name: &str) -> Option<[f64; N]> {
    find(fields, name)?.numbers()?.try_into().ok()
}

pub(super) fn number(fields: &[Field], name: &str) -> Option<f64> {
    find(fields, name).and_then(LocatedValue::number)
}

/// A change of a widget's table: a key, and its value or none to take it out.
pub(super) type Change = (&'static str, Option<ParameterValue>);

pub(super) fn list(numbers: &[f64]) -> ParameterValue {
    ParameterValue::List(
        numbers.iter().map(|&x| LocatedValue::from(ParameterValue::Number(rounded(x)))).collect(),
    )
}

pub(super) fn rows<const N: usize>(rows: &[[f64; N]]) -> ParameterValue {
    ParameterValue::List(rows.iter().map(|row| LocatedValue::from(list(row))).collect())
}

pub(super) fn rows_of(rows: &[Vec<f64>]) -> ParameterValue {
    ParameterValue::List(rows.iter().map(|row| LocatedValue::from(list(row))).collect())
}

/// Six digits: finer than a pixel of any screen.
pub(super) fn rounded(x: f64) -> f64 {
    if x.is_finite() { format!("{x:.5e}").parse().unwrap_or(x) } else { x }
}
