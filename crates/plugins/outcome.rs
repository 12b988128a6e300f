//! What comes back from a call, judged; and how messages begin.

use crate::describe::Declared;
use crate::foreign::Wrong;
use crate::grids::Fresh;
use crate::host::State;
use crate::interface::{CANCELLED, ERROR, OK};
use rayon::prelude::*;
use voltet_core::error::ErrorKind;
use voltet_core::field::{Fallback, Plugin};
use voltet_core::glam::DVec3;
use voltet_core::grid::Grid;
use voltet_core::{Error, Result};

/// What the gradient holds before the filter writes: a number that is none, with digits that no computation gives.
pub(crate) const UNSET: f64 = f64::from_bits(0x7ff7_766f_6c74_6574);

/// What a function of a plug-in returned and said.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Said {
    pub code: i32,
    pub error: Option<String>,
    pub fallbacks: Vec<Fallback>,
    /// It wrote beyond the end of what it was given to write to.
    pub beyond: Option<Beyond>,
    /// What it told the host cannot be.
    pub wrong: Option<Wrong>,
}

/// Beyond the end of what something was written.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Beyond {
    /// "the gradient".
    pub what: String,
    /// How much there was to write: "3 numbers for each of the 64 points".
    pub accepted: String,
}

impl Beyond {
    /// The gradient at so many points.
    pub fn gradient(point_count: usize) -> Beyond {
        let accepted = format!("3 numbers for each of the {point_count} points");
        Beyond { what: "the gradient".into(), accepted }
    }
}

impl Said {
    pub fn new(code: i32, state: &State) -> Said {
        Said { code, error: state.error(), fallbacks: state.fallbacks(), beyond: None, wrong: state.wrong() }
    }

    /// Of a call that the host did not make, and why.
    pub fn not_called(wrong: Wrong, state: &State) -> Said {
        state.complain(wrong);
        Said::new(ERROR, state)
    }
}

/// Whose call it is.
#[derive(Clone, Copy)]
pub(crate) struct Whose<'a> {
    declared: &'a Declared,
    plugin: &'a Plugin,
}

impl<'a> Whose<'a> {
    pub fn new(declared: &'a Declared, plugin: &'a Plugin) -> Whose<'a> {
        Whose { declared, plugin }
    }

    /// The name that it declares.
    #[cfg(feature = "wasm")]
    pub fn name(&self) -> &'static str {
        self.declared.kind.name
    }

    /// "gradient filter 'x'".
    pub fn piece(&self) -> String {
        format!("{} '{}'", self.declared.family.name(), self.declared.kind.name)
    }

    /// Begins a message: "the gradient filter 'x' of the plug-in 'y' (path) …".
    pub fn error(&self, what: &str) -> Error {
        Error::run(format!("the {} of the {} {what}", self.piece(), self.plugin))
    }

    /// What came of checking parameters.
    pub fn checked(&self, said: Said) -> Result<()> {
        match said.code {
            OK => Ok(()),
            _ => Err(Error { kind: ErrorKind::Usage, ..self.refused(&said) }),
        }
    }

    /// Whether it did its work. `stopped`: whether the user asked it to stop.
    pub fn worked(&self, said: &Said, stopped: bool) -> Result<()> {
        if let Some(Beyond { what, accepted }) = &said.beyond {
            let what = format!("wrote beyond the end of {what}: what else it wrote over is unknown");
            return Err(self.error(&what).expected(accepted));
        }
        if let Some(wrong) = &said.wrong {
            return Err(self.error("is refused").got(wrong));
        }
        match said.code {
            OK => Ok(()),
            _ if stopped => Err(Error::cancelled()),
            CANCELLED => Err(self.error("stopped, and nobody asked it to")),
            _ => Err(self.refused(said)),
        }
    }

    /// What the plug-in said, or that it said nothing.
    fn refused(&self, said: &Said) -> Error {
        match &said.error {
            Some(text) => self.error("says").got(text),
            None => self.error("failed and did not say why").got(format!("code {}", said.code)),
        }
    }

    /// What it did with less than it promises, as sentences.
    pub fn warnings(&self, said: &Said) -> impl Iterator<Item = String> {
        said.fallbacks.iter().map(|Fallback { what, point_count }| {
            format!("The {} of the {}: {what} at {point_count} points.", self.piece(), self.plugin)
        })
    }

    /// A gradient's vectors, if every point of a cell got one.
    pub fn every_point(&self, grid: &Grid, mut vectors: Vec<DVec3>) -> Result<Vec<DVec3>> {
        let is_unset = |v: &DVec3| v.to_array().iter().any(Fresh::is_unset);
        if !vectors.par_iter().with_min_len(1 << 14).any(is_unset) {
            return Ok(vectors);
        }
        let mut used = vec![false; vectors.len()];
        grid.tetrahedra.iter().flatten().for_each(|&p| used[p as usize] = true);
        let mut unset = (0..vectors.len()).filter(|&p| used[p] && is_unset(&vectors[p]));
        if let Some(first) = unset.next() {
            let found = format!("{} without, the first of them point {first}", 1 + unset.count());
            let wanted = format!("one for each of the {} points", vectors.len());
            return Err(self.error("did not give every point a vector").got(found).expected(wanted));
        }
        // What no cell uses may be anything.
        vectors.iter_mut().filter(|v| is_unset(v)).for_each(|v| *v = DVec3::ZERO);
        Ok(vectors)
    }
}
