//! Errors and panics as exceptions of the family `voltet.Error`, with the same text, place and remedy.

use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::PyDict;
use std::panic::{AssertUnwindSafe, catch_unwind};
use voltet_core::error::{ErrorKind, Location};
use voltet_core::{Error, Result};

/// Whose mistake an exception is: `voltet._errors.KINDS`.
fn kind(error: &Error) -> &'static str {
    match error.kind {
        ErrorKind::Usage => "usage",
        ErrorKind::Run => "run",
        ErrorKind::Cancelled => "cancelled",
    }
}

/// The exception that stands for an error.
pub fn exception(py: Python<'_>, error: &Error) -> PyErr {
    let Location { file, span: _, line_column, node, item } = &*error.location;
    let fields = PyDict::new(py);
    let filled = || -> PyResult<()> {
        fields.set_item("what", &error.what)?;
        fields.set_item("found", &error.got)?;
        fields.set_item("expected", &error.expected)?;
        fields.set_item("file", file)?;
        fields.set_item("line", line_column.map(|place| place.0))?;
        fields.set_item("column", line_column.map(|place| place.1))?;
        fields.set_item("node", node)?;
        fields.set_item("item", item)
    };
    filled().and_then(|()| made(py, kind(error), &error.to_string(), &fields)).unwrap_or_else(|error| error)
}

fn made(py: Python<'_>, kind: &str, text: &str, fields: &Bound<'_, PyDict>) -> PyResult<PyErr> {
    static MAKE: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    let make = MAKE.get_or_try_init(py, || {
        Ok::<_, PyErr>(py.import("voltet._errors")?.getattr("exception")?.unbind())
    })?;
    Ok(PyErr::from_value(make.bind(py).call1((kind, text, fields))?))
}

/// Does what a call asks for. A panic is an exception like others.
pub fn guarded<T>(py: Python<'_>, work: impl FnOnce() -> Result<T>) -> PyResult<T> {
    match catch_unwind(AssertUnwindSafe(work)) {
        Ok(outcome) => outcome.map_err(|error| exception(py, &error)),
        Err(panic) => {
            let text = voltet_embed::said(panic.as_ref());
            let fields = PyDict::new(py);
            fields.set_item("what", &text)?;
            Err(made(py, "bug", &text, &fields)?)
        }
    }
}
