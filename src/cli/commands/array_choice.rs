//! Choice of an array of a data file, as options state it and as parameters of a `reader` node.

use crate::cli::present::Bar;
use crate::graph::{NodeProgress, ParameterValue};
use crate::io::formats::{ArrayHead, ArraySummary, Association, Request, TimeStep};
use std::path::{Path, PathBuf};

/// Request that the options state.
pub(super) fn request(time_step: Option<usize>, solution: Option<&PathBuf>) -> Request {
    Request { time_step: time_step.map(TimeStep::Index), solution: solution.cloned(), ..Request::default() }
}

/// An array, as parameters of a reader name it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ArrayChoice {
    /// `scalar`: of several components the length.
    pub scalar: String,
    /// `association`: said only where an array of the other one has the name too.
    pub association: Association,
}

impl ArrayChoice {
    /// The choice of one of a file's arrays.
    pub fn from_head(array: &ArrayHead, all: &[ArrayHead]) -> ArrayChoice {
        let shadowed = |other: &ArrayHead| other.name == array.name && other.association != array.association;
        let is_shadowed = array.association == Association::Cell && all.iter().any(shadowed);
        ArrayChoice {
            scalar: scalar(array),
            association: if is_shadowed { Association::Cell } else { Association::Auto },
        }
    }

    /// The choice of an array by the name in an option; an array of several components is chosen by its length.
    pub fn by_name(name: &str, all: &[ArrayHead]) -> ArrayChoice {
        let bare = all.iter().find(|array| array.name == name && array.component_count > 1);
        let as_it_is = || ArrayChoice { scalar: name.into(), association: Association::Auto };
        bare.map_or_else(as_it_is, |array| ArrayChoice::from_head(array, all))
    }

    /// Keys of a `reader` node that reads it from the file `data`.
    pub fn keys(&self, data: &Path, time_step: Option<usize>, solution: Option<&Path>) -> String {
        let text = |text: &str| ParameterValue::Text(text.into());
        let mut keys = format!("path = {}\nscalar = {}\n", text(&data.to_string_lossy()), text(&self.scalar));
        if self.association == Association::Cell {
            keys += "association = \"cell\"\n";
        }
        if let Some(step) = time_step {
            keys += &format!("time_step = {step}\n");
        }
        if let Some(solution) = solution {
            keys += &format!("solution = {}\n", text(&solution.to_string_lossy()));
        }
        keys
    }
}

/// Name of the array as a parameter of a reader.
pub(super) fn scalar(array: &ArrayHead) -> String {
    let magnitude = if array.component_count > 1 { ":magnitude" } else { "" };
    format!("{}{magnitude}", array.name)
}

/// True if its values differ.
pub(super) fn differs(array: &ArraySummary) -> bool {
    array.range.is_some_and(|[low, high]| low < high)
}

/// Progress of work without nodes, on a bar.
pub(super) fn bar_progress(bar: &Bar) -> NodeProgress<'_> {
    NodeProgress { observer: bar, node: "" }
}
