//! Runs without the interpreter's lock, that call-backs follow and Ctrl-C stops.

use crate::error::{exception, guarded};
use crate::filter::{self, Run};
use pyo3::prelude::*;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::OnceLock;
use voltet_core::{Error, Result};
use voltet_embed::{Moment, follow};
use voltet_graph::Observer;

/// Does work that may be long. Every 20 ms signals are looked for (Ctrl-C raises `KeyboardInterrupt`, on the main thread) and
/// `progress(node, stage, fraction)` is called; what either raises stops the work, interrupts a filter in Python, and is raised here.
pub fn followed<T: Send>(
    py: Python<'_>,
    progress: Option<&Py<PyAny>>,
    work: impl FnOnce(&dyn Observer) -> Result<T> + Send,
) -> PyResult<T> {
    followed_beside(py, progress, &mut std::iter::empty(), work)?
}

/// The same with work `beside` it, as [`voltet_embed::follow`] has it: what came of the work, apart from what was raised on the
/// way.
pub fn followed_beside<T: Send>(
    py: Python<'_>,
    progress: Option<&Py<PyAny>>,
    beside: &mut (dyn Iterator<Item = bool> + Send),
    work: impl FnOnce(&dyn Observer) -> Result<T> + Send,
) -> PyResult<PyResult<T>> {
    guarded(py, refuse_forked)?;
    let mut raised: Option<PyErr> = None;
    let run = Run::new();
    let stops = |moment: &Moment| {
        Python::attach(|py| {
            let told = py.check_signals().and_then(|()| match progress.filter(|_| raised.is_none()) {
                Some(progress) => {
                    let Moment { node, stage, fraction } = moment;
                    progress.call1(py, (node, stage, *fraction)).map(drop)
                }
                None => Ok(()),
            });
            let Err(error) = told else { return raised.is_some() };
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
    let outcome = py.detach(|| catch_unwind(AssertUnwindSafe(|| follow(work, Some(stops), beside))));
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

/// The threads that compute belong to the process that began them: in a fork there are none, and work would wait for ever.
fn refuse_forked() -> Result<()> {
    static FIRST: OnceLock<u32> = OnceLock::new();
    if *FIRST.get_or_init(std::process::id) == std::process::id() {
        return Ok(());
    }
    Err(Error::usage("this process was forked from one that had used voltet, and has none of its threads")
        .expected("multiprocessing.get_context(\"spawn\"), or voltet used in the forked processes alone"))
}
