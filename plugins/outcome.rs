//! What comes back from a call, judged; and how messages begin.

use crate::host::State;
use crate::interface::{CANCELLED, OK};
use rayon::prelude::*;
use voltet_core::error::ErrorKind;
use voltet_core::field::{Fallback, Gradient, Plugin};
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
    /// It wrote beyond the end of the gradient.
    pub overran: bool,
}

impl Said {
    pub fn new(code: i32, state: &State) -> Said {
        Said { code, error: state.error(), fallbacks: state.fallbacks(), overran: false }
    }
}

/// Takes off what lies beyond the vectors of so many points; whether something was written there.
pub(crate) fn overran(vectors: &mut Vec<DVec3>, point_count: usize) -> bool {
    let is_unset = |v: &DVec3| v.to_array().iter().all(|x| x.to_bits() == UNSET.to_bits());
    let overran = !vectors[point_count..].iter().all(is_unset);
    vectors.truncate(point_count);
    overran
}

/// Whose call it is.
#[derive(Clone, Copy)]
pub(crate) struct Whose<'a> {
    pub filter: &'static str,
    pub plugin: &'a Plugin,
}

impl Whose<'_> {
    /// Begins a message: "the gradient filter 'x' of the plug-in 'y' (path) …".
    pub fn error(&self, what: &str) -> Error {
        Error::run(format!("the gradient filter '{}' of the {} {what}", self.filter, self.plugin))
    }

    /// What came of checking parameters.
    pub fn checked(&self, said: Said) -> Result<()> {
        match said.code {
            OK => Ok(()),
            _ => Err(Error { kind: ErrorKind::Usage, ..self.refused(said) }),
        }
    }

    /// What came of computing a gradient, with what was not written found out. `stopped`: whether the user asked for that.
    pub fn gradient(&self, grid: &Grid, said: Said, vectors: Vec<DVec3>, stopped: bool) -> Result<Gradient> {
        if said.overran {
            let error =
                self.error("wrote beyond the end of the gradient: what else it wrote over is unknown");
            return Err(error.accepted(format!("3 numbers for each of the {} points", grid.points.len())));
        }
        match said.code {
            OK => {
                let vectors = self.taken(grid, vectors)?;
                Ok(Gradient { vectors, fallbacks: said.fallbacks })
            }
            _ if stopped => Err(Error::cancelled()),
            CANCELLED => Err(self.error("stopped, and nobody asked it to")),
            _ => Err(self.refused(said)),
        }
    }

    /// What the plug-in said, or that it said nothing.
    fn refused(&self, said: Said) -> Error {
        match said.error {
            Some(text) => self.error("says").found(text),
            None => self.error("failed and did not say why").found(format!("code {}", said.code)),
        }
    }

    fn taken(&self, grid: &Grid, mut vectors: Vec<DVec3>) -> Result<Vec<DVec3>> {
        let is_unset = |v: &DVec3| v.to_array().iter().any(|x| x.to_bits() == UNSET.to_bits());
        if !vectors.par_iter().with_min_len(1 << 14).any(is_unset) {
            return Ok(vectors);
        }
        let mut used = vec![false; vectors.len()];
        grid.tetrahedra.iter().flatten().for_each(|&p| used[p as usize] = true);
        let mut unset = (0..vectors.len()).filter(|&p| used[p] && is_unset(&vectors[p]));
        if let Some(first) = unset.next() {
            let found = format!("{} without, the first of them point {first}", 1 + unset.count());
            let wanted = format!("one for each of the {} points", vectors.len());
            return Err(self.error("did not give every point a vector").found(found).accepted(wanted));
        }
        // What no cell uses may be anything.
        vectors.iter_mut().filter(|v| is_unset(v)).for_each(|v| *v = DVec3::ZERO);
        Ok(vectors)
    }
}
