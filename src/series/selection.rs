//! Selections of frames: steps, data files, values of parameters, a way of the camera, and a part of all.

use super::steps::{StepSelection, TimeSelection};
use std::path::PathBuf;
use std::str::FromStr;
use voltet_graph::ParameterValue;
use voltet_graph::pipeline::value;

/// Selection of the frames of a pipeline.
#[derive(Debug, Clone, Default)]
pub struct FrameSelection {
    /// Steps of the time series; `None`: the one that the file names.
    pub steps: Option<Steps>,
    /// Data that relative numbers refer to; `None`: a sample of the series where steps are chosen.
    pub ranges: Option<Ranges>,
    /// Files that the reader reads one after the other; none: its own.
    pub data_files: Vec<PathBuf>,
    /// Values of parameters, each with each.
    pub sweeps: Vec<Sweep>,
    /// Number of pictures of the camera's way; `None`: it goes on with the frames that there are.
    pub turn_count: Option<usize>,
    /// The part of the frames that is drawn.
    pub part: Option<Part>,
}

/// Selection of time steps.
#[derive(Debug, Clone, PartialEq)]
pub enum Steps {
    /// By number.
    Numbers(StepSelection),
    /// By time.
    Times(TimeSelection),
}

/// Data that relative numbers refer to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ranges {
    /// Each step by itself.
    Step,
    /// Up to 8 steps of the series.
    Sample,
    /// All steps of the series.
    All,
}

impl Ranges {
    /// The value of the parameter `relative_to`.
    pub fn word(self) -> &'static str {
        match self {
            Ranges::Step => "step",
            Ranges::Sample => "sample",
            Ranges::All => "series",
        }
    }
}

/// Values that a parameter takes one after the other: `look.widgets.0.extinction=[1, 2, 4]`.
#[derive(Debug, Clone, PartialEq)]
pub struct Sweep {
    /// The node.
    pub node: String,
    /// The parameter, with keys and numbers that lead to a part of it.
    pub parameter: String,
    /// Its values.
    pub values: Vec<ParameterValue>,
}

impl Sweep {
    /// Values of `node.parameter`; `None` where that names no parameter, or there are no values.
    pub fn new(path: &str, values: Vec<ParameterValue>) -> Option<Sweep> {
        let (node, parameter) = path.split_once('.')?;
        let is_sweep = !(node.is_empty() || parameter.split('.').any(str::is_empty) || values.is_empty());
        is_sweep.then(|| Sweep { node: node.into(), parameter: parameter.into(), values })
    }
}

impl FromStr for Sweep {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let form = "a sweep is node.param=[VALUE, VALUE, …], such as look.widgets.0.extinction=[1, 2, 4]";
        let read = || {
            let (path, values) = text.split_once('=')?;
            let values = value(values.trim())?;
            Sweep::new(path.trim(), values.list()?.iter().map(|part| part.datum.clone()).collect())
        };
        read().ok_or_else(|| form.to_string())
    }
}

/// Every `count`-th frame, from the `number`-th on, which counts from 1: `2/8`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Part {
    /// 1 to `count`.
    pub number: usize,
    /// At least 1.
    pub count: usize,
}

impl FromStr for Part {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parts = text.split_once('/').map(|(number, count)| (number.trim().parse(), count.trim().parse()));
        match parts {
            Some((Ok(number), Ok(count))) if (1..=count).contains(&number) => Ok(Part { number, count }),
            _ => Err("a part is NUMBER/COUNT, from 1/COUNT to COUNT/COUNT, such as 2/8".into()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_and_sweeps_are_read_or_refused() {
        assert_eq!("2/8".parse(), Ok(Part { number: 2, count: 8 }));
        for text in ["0/8", "9/8", "1/0", "2", "a/b", "-1/3", ""] {
            assert!(text.parse::<Part>().is_err(), "{text}");
        }
        let sweep: Sweep = "look.widgets.0.centre=[[1.0, 0.0], [2.0, 0.0]]".parse().unwrap();
        assert_eq!(
            (sweep.node.as_str(), sweep.parameter.as_str(), sweep.values.len()),
            ("look", "widgets.0.centre", 2)
        );
        for text in ["look.a=1", "look=[1]", "look.a=[]", ".a=[1]", "look..a=[1]", "look.a", "look.a=[1"] {
            assert!(text.parse::<Sweep>().is_err(), "{text}");
        }
    }
}
