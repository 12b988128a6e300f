//! Runs detached from the interpreter, with callbacks for progress, cancelled by Ctrl-C.

use crate::error::{exception, guarded, refuse_forked};
use crate::filter::{self, Run};
use pyo3::prelude::*;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use voltet::{RunStatus, run_in_background};
use voltet_core::Result;
use voltet_graph::Observer;

/// Runs long work. Every 20 ms signals are checked (Ctrl-C raises `KeyboardInterrupt`, on the main thread) and
/// `progress(node, stage, fraction)` is called; an exception of either cancels the work, interrupts a filter in Python, and is
/// raised here.
pub fn run_long<T: Send>(
    py: Python<'_>,
    progress: Option<&Py<PyAny>>,
    work: impl FnOnce(&dyn Observer) -> Result<T> + Send,
) -> PyResult<T> {
    run_with_side_work(py, progress, &mut std::iter::empty(), work)?
}

/// Like [`run_long`], with `side_work` as of [`run_in_background`]; the result of the work is apart from exceptions of callbacks.
pub fn run_with_side_work<T: Send>(
    py: Python<'_>,
    progress: Option<&Py<PyAny>>,
    side_work: &mut (dyn Iterator<Item = bool> + Send),
    work: impl FnOnce(&dyn Observer) -> Result<T> + Send,
) -> PyResult<PyResult<T>> {
    guarded(py, refuse_forked)?;
    let mut raised: Option<PyErr> = None;
    let run = Run::new();
    let stops = |status: &RunStatus| {
        Python::attach(|py| {
            let called = py.check_signals().and_then(|()| match progress.filter(|_| raised.is_none()) {
                Some(progress) => {
                    let RunStatus { node, stage, fraction, .. } = status;
                    progress.call1(py, (node, stage, *fraction)).map(drop)
                }
                None => Ok(()),
            });
            let Err(error) = called else { return raised.is_some() };
            raised.get_or_insert(error);
            run.interrupt(py);
            true
        })
    };
    // A filter's exception is kept by the thread that the filter ran on, which is that of the work.
    let work = |observer: &dyn Observer| {
        run.is_here();
        let outcome = work(observer);
        Ok((outcome, filter::raised()))
    };
    let outcome =
        py.detach(|| catch_unwind(AssertUnwindSafe(|| run_in_background(work, Some(stops), side_work))));
    if let Some(raised) = raised {
        return Err(raised);
    }
    Ok(match outcome {
        Ok(Ok((Err(error), Some(cause)))) => {
            let error = exception(py, &error);
            error.set_cause(py, Some(cause));
            Err(error)
        }
        Ok(Ok((outcome, _))) => guarded(py, || outcome),
        Ok(Err(error)) => Err(exception(py, &error)),
        Err(panic) => guarded(py, || resume_unwind(panic)),
    })
}
