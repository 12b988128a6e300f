//! Errors and panics as exceptions of the family `voltet.Error`, with the same text, place and remedy.

use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::PyDict;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::OnceLock;
use voltet_core::error::{ErrorKind, Location};
use voltet_core::{Error, Result};

/// Kind of an exception, one of `voltet._errors.KINDS`.
fn kind(error: &Error) -> &'static str {
    match error.kind {
        ErrorKind::Usage => "usage",
        ErrorKind::Cancelled => "cancelled",
        ErrorKind::Panic => "bug",
        _ => "run",
    }
}

/// Exception of an error.
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
    filled()
        .and_then(|()| new_exception(py, kind(error), &error.to_string(), &fields))
        .unwrap_or_else(|error| error)
}

fn new_exception(py: Python<'_>, kind: &str, text: &str, fields: &Bound<'_, PyDict>) -> PyResult<PyErr> {
    static CLASS: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    let class = CLASS.import(py, "voltet._errors", "exception")?;
    Ok(PyErr::from_value(class.call1((kind, text, fields))?))
}

/// Runs a call. A panic becomes an exception like others.
pub fn guarded<T>(py: Python<'_>, work: impl FnOnce() -> Result<T>) -> PyResult<T> {
    match catch_unwind(AssertUnwindSafe(work)) {
        Ok(outcome) => outcome.map_err(|error| exception(py, &error)),
        Err(panic) => {
            let text = voltet::panic_message(panic.as_ref());
            let fields = PyDict::new(py);
            fields.set_item("what", &text)?;
            Err(new_exception(py, "bug", &text, &fields)?)
        }
    }
}

/// The process that began the worker threads.
static FIRST_PROCESS: OnceLock<u32> = OnceLock::new();

/// True in a process that was forked from one with worker threads. To free what they serve, such as a device, would block for ever.
pub fn is_forked() -> bool {
    FIRST_PROCESS.get().is_some_and(|&process| process != std::process::id())
}

/// Refuses to free what worker threads may serve in a forked process; does not count as a use of them.
pub fn refuse_freeing() -> Result<()> {
    if is_forked() { refuse_forked() } else { Ok(()) }
}

/// Refuses a forked process: worker threads belong to the process that began them, and work in a fork would block for ever.
pub fn refuse_forked() -> Result<()> {
    if *FIRST_PROCESS.get_or_init(std::process::id) == std::process::id() {
        return Ok(());
    }
    Err(Error::usage("this process was forked from one that had used voltet, and has none of its threads")
        .expected("multiprocessing.get_context(\"spawn\"), or voltet used in the forked processes alone"))
}
