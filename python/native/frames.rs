//! The pictures of a series, as `voltet run` draws them with its options.

use crate::error::{exception, guarded};
use crate::value::{datum, object};
use pyo3::prelude::*;
use std::str::FromStr;
use voltet::series::files::data_files;
use voltet::series::selection::{FrameSelection, Ranges, Steps, Sweep};
use voltet::series::{self, Frame};
use voltet_core::{Error, Result};

/// Words of the options, as Python gives them: values of a sweep stand beside `node.parameter`.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct FrameWords<'py> {
    steps: Option<String>,
    times: Option<String>,
    ranges: Option<String>,
    files: Vec<String>,
    sweeps: Vec<(String, Vec<Bound<'py, PyAny>>)>,
    turns: Option<usize>,
    part: Option<String>,
}

/// A frame for Python: label, step, time, and changes of the pipeline as (node, parameter, value), with None for what is taken out.
pub type FrameEntry<'py> = (String, usize, Option<f64>, Vec<(String, String, Option<Bound<'py, PyAny>>)>);

impl FrameWords<'_> {
    /// The selection that the words state.
    pub fn selection(&self, py: Python<'_>) -> PyResult<FrameSelection> {
        let sweep = |(path, values): &(String, Vec<Bound<'_, PyAny>>)| {
            let values: Vec<_> = values.iter().map(datum).collect::<PyResult<_>>()?;
            let (what, expected) = match values.is_empty() {
                true => ("a sweep has no values", "one or more"),
                false => ("a sweep names no parameter", "node.parameter"),
            };
            let wrong = || exception(py, &Error::usage(what).got(path).expected(expected));
            Sweep::new(path, values).ok_or_else(wrong)
        };
        let sweeps = self.sweeps.iter().map(sweep).collect::<PyResult<_>>()?;
        guarded(py, || {
            let steps = match (&self.steps, &self.times) {
                (Some(_), Some(_)) => {
                    let error = Error::usage("steps are selected by number and by time");
                    return Err(error.expected("'steps' or 'times'"));
                }
                (Some(steps), None) => Some(Steps::Numbers(read("steps", steps)?)),
                (None, times) => {
                    times.as_ref().map(|times| read("times", times).map(Steps::Times)).transpose()?
                }
            };
            let ranges = match self.ranges.as_deref() {
                None => None,
                Some("step") => Some(Ranges::Step),
                Some("sample") => Some(Ranges::Sample),
                Some("all") => Some(Ranges::All),
                Some(other) => {
                    let error = Error::usage("'ranges' is no such word").got(other);
                    return Err(error.expected("\"step\", \"sample\" or \"all\""));
                }
            };
            let data_files = data_files(&self.files)?;
            let part = self.part.as_ref().map(|part| read("part", part)).transpose()?;
            Ok(FrameSelection { steps, ranges, data_files, sweeps, turn_count: self.turns, part })
        })
    }
}

fn read<T: FromStr<Err = String>>(name: &str, words: &str) -> Result<T> {
    words.parse().map_err(|error: String| {
        Error::usage(format!("'{name}' is not understood")).got(words).expected(error)
    })
}

/// The frames of a pipeline.
pub fn entries<'py>(py: Python<'py>, frames: Vec<Frame>) -> PyResult<Vec<FrameEntry<'py>>> {
    let entry = |frame: Frame| {
        let changes = frame.changes.iter().map(|change| {
            let value = change.value.as_ref().map(|value| object(py, value)).transpose()?;
            Ok((change.node.clone(), change.parameter.clone(), value))
        });
        Ok((frame.label(), frame.marks.step, frame.marks.time, changes.collect::<PyResult<_>>()?))
    };
    frames.into_iter().map(entry).collect()
}

/// The frames of a document.
pub fn frames(state: &mut crate::state::State, selection: &FrameSelection) -> Result<Vec<Frame>> {
    let document = state.document()?;
    series::frames(&document, selection, state.pipeline.registry())
}
