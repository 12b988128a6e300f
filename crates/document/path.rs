//! Paths: keys and numbers of entries that lead to a part of a file.

use std::fmt;
use voltet_core::parameters::key_text;

/// One step of a path.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Step {
    /// A key of a table.
    Key(String),
    /// An entry of a list, counted from 0.
    Entry(usize),
}

/// Path to a part of a file, or of a node: `widgets.0.centre`.
#[derive(Debug, Clone, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Path(pub Vec<Step>);

impl Path {
    /// The path one step on.
    pub fn with(&self, step: impl Into<Step>) -> Path {
        Path(self.0.iter().cloned().chain([step.into()]).collect())
    }

    /// This path and then another.
    pub fn and(&self, other: &Path) -> Path {
        Path(self.0.iter().chain(&other.0).cloned().collect())
    }
}

impl Step {
    /// The step as a key: a table may have a number as its key.
    pub fn key(&self) -> std::borrow::Cow<'_, str> {
        match self {
            Step::Key(key) => key.into(),
            Step::Entry(number) => number.to_string().into(),
        }
    }
}

impl From<&str> for Step {
    fn from(key: &str) -> Self {
        Step::Key(key.to_string())
    }
}

impl From<usize> for Step {
    fn from(number: usize) -> Self {
        Step::Entry(number)
    }
}

impl From<&str> for Path {
    /// Keys and numbers with points between: `widgets.0.centre`.
    fn from(text: &str) -> Self {
        let step = |part: &str| part.parse().map_or_else(|_| Step::from(part), Step::Entry);
        Path(text.split('.').filter(|part| !part.is_empty()).map(step).collect())
    }
}

impl<const N: usize> From<[&str; N]> for Path {
    /// Keys as they are, points and digits included.
    fn from(keys: [&str; N]) -> Self {
        Path(keys.into_iter().map(Step::from).collect())
    }
}

impl fmt::Display for Path {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, step) in self.0.iter().enumerate() {
            let point = if i > 0 { "." } else { "" };
            match step {
                Step::Key(key) => write!(f, "{point}{}", key_text(key))?,
                Step::Entry(number) => write!(f, "{point}{number}")?,
            }
        }
        Ok(())
    }
}
