//! Values of parameters: from Python and to it.

use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyList, PyString, PyTuple};
use voltet_core::Error;
use voltet_graph::{Field, LocatedValue, ParameterValue};

/// Lists in lists: deeper ones hold themselves, or are no parameter of anything.
const DEEPEST: usize = 16;

/// The value that a Python object stands for: of the types that TOML has, of numpy, paths, mappings.
pub fn datum(object: &Bound<'_, PyAny>) -> PyResult<ParameterValue> {
    nested(object, 0)
}

fn nested(object: &Bound<'_, PyAny>, depth: usize) -> PyResult<ParameterValue> {
    let py = object.py();
    let wrong = |what: &str| {
        let found = object.repr().map(|text| shortened(&text.to_string())).unwrap_or_default();
        let error = Error::usage(what).got(found);
        let error = error.expected("a bool, number, text, path, or a list, array or dict of these");
        crate::error::exception(py, &error)
    };
    if depth > DEEPEST {
        return Err(wrong("the value of a parameter is nested too deeply"));
    }
    let list = |items: Vec<Bound<'_, PyAny>>| -> PyResult<ParameterValue> {
        let settings: PyResult<Vec<LocatedValue>> =
            items.iter().map(|item| nested(item, depth + 1).map(LocatedValue::from)).collect();
        settings.map(ParameterValue::List)
    };
    if let Ok(flag) = object.cast::<PyBool>() {
        return Ok(ParameterValue::Boolean(flag.is_true()));
    }
    if object.is_instance_of::<PyInt>() {
        let whole = object.extract::<i64>();
        return whole
            .map(ParameterValue::Integer)
            .map_err(|_| wrong("a whole number does not fit into 64 bits"));
    }
    if let Ok(number) = object.cast::<PyFloat>() {
        return Ok(ParameterValue::Number(number.value()));
    }
    if let Ok(text) = object.cast::<PyString>() {
        return Ok(ParameterValue::Text(text.to_cow()?.into_owned()));
    }
    if let Ok(items) = object.cast::<PyList>() {
        return list(items.iter().collect());
    }
    if let Ok(items) = object.cast::<PyTuple>() {
        return list(items.iter().collect());
    }
    if let Ok(table) = object.cast::<PyDict>() {
        return fields(table, depth + 1).map(ParameterValue::Table);
    }
    // Arrays and numbers of numpy.
    if let Ok(plain) = object.call_method0("tolist") {
        return nested(&plain, depth + 1);
    }
    match object.call_method0("__fspath__") {
        Ok(path) => nested(&path, depth + 1),
        Err(_) => Err(wrong("the value of a parameter has a type that pipelines do not know")),
    }
}

/// The settings that a dictionary states.
pub fn settings(table: &Bound<'_, PyDict>) -> PyResult<Vec<Field>> {
    fields(table, 0)
}

fn fields(table: &Bound<'_, PyDict>, depth: usize) -> PyResult<Vec<Field>> {
    let field = |(key, value): (Bound<'_, PyAny>, Bound<'_, PyAny>)| {
        let name = key.extract::<String>().map_err(|_| {
            let error = Error::usage("the name of a parameter is no text").got(key.to_string());
            crate::error::exception(key.py(), &error)
        })?;
        Ok(Field::new(name, nested(&value, depth)?))
    };
    table.iter().map(field).collect()
}

/// The Python object that stands for a value.
pub fn object<'py>(py: Python<'py>, datum: &ParameterValue) -> PyResult<Bound<'py, PyAny>> {
    Ok(match datum {
        ParameterValue::Boolean(flag) => PyBool::new(py, *flag).to_owned().into_any(),
        ParameterValue::Integer(n) => n.into_pyobject(py)?.into_any(),
        ParameterValue::Number(x) => PyFloat::new(py, *x).into_any(),
        ParameterValue::Text(text) => PyString::new(py, text).into_any(),
        ParameterValue::List(list) => {
            let items: PyResult<Vec<_>> = list.iter().map(|setting| object(py, &setting.datum)).collect();
            PyList::new(py, items?)?.into_any()
        }
        ParameterValue::Table(fields) => table(py, fields)?.into_any(),
    })
}

/// The dictionary that stands for settings.
pub fn table<'py>(py: Python<'py>, fields: &[Field]) -> PyResult<Bound<'py, PyDict>> {
    let table = PyDict::new(py);
    for field in fields {
        table.set_item(&field.name, object(py, &field.setting.datum)?)?;
    }
    Ok(table)
}

/// A text as messages show it.
fn shortened(text: &str) -> String {
    match text.char_indices().nth(60) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_string(),
    }
}
