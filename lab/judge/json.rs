//! Reads values of a case's JSON object; errors name the key.

use serde_json::Value;
use voltet_core::{Error, Result};

pub(super) fn member<'a>(value: &'a Value, key: &str) -> Result<&'a Value> {
    value.get(key).ok_or_else(|| Error::usage(format!("a case lacks '{key}'")))
}

pub(super) fn wrong(key: &str) -> Error {
    Error::usage(format!("'{key}' of a case is of the wrong form"))
}

pub(super) fn text<'a>(value: &'a Value, key: &str) -> Result<&'a str> {
    member(value, key)?.as_str().ok_or_else(|| wrong(key))
}

pub(super) fn number(value: &Value, key: &str) -> Result<f64> {
    member(value, key)?.as_f64().ok_or_else(|| wrong(key))
}

pub(super) fn array<'a>(value: &'a Value, key: &str) -> Result<&'a Vec<Value>> {
    member(value, key)?.as_array().ok_or_else(|| wrong(key))
}

pub(super) fn numbers(value: &Value) -> Result<Vec<f64>> {
    let list = value.as_array().ok_or_else(|| wrong("a list of numbers"))?;
    list.iter().map(|v| v.as_f64().ok_or_else(|| wrong("a list of numbers"))).collect()
}

pub(super) fn fixed<const N: usize>(value: &Value) -> Result<[f64; N]> {
    numbers(value)?.try_into().map_err(|_| wrong("a list of numbers"))
}
