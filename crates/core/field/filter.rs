//! Gradient filters: the trait, the gradient that one returns, the loop over points that filters share, and a filter with its parameters.

use super::length;
use crate::grid::Grid;
use crate::parameters::{Parameters, VariantSchema};
use crate::progress::{Progress, StageProgress};
use crate::{Error, Result, counted};
use glam::DVec3;
use rayon::prelude::*;
use std::fmt;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::SystemTime;

/// Gradients at the points, and how often the filter had to do with less than it promises.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Gradient {
    /// ∇s at every point of the grid, or at each that was asked for.
    pub vectors: Vec<DVec3>,
    /// Points at which the filter fell back, by what it did there instead; empty where it never had to.
    pub fallbacks: Vec<Fallback>,
}

/// A kind of fall-back, and at how many points it was taken.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fallback {
    /// Substitute method and its reason, a clause that can follow "at 12 points".
    pub what: String,
    /// Number of points, > 0.
    pub point_count: u64,
}

impl fmt::Display for Fallback {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} at {}", self.what, counted(self.point_count, "point"))
    }
}

impl Fallback {
    /// Fallbacks with a count above zero.
    pub fn list(taken: impl IntoIterator<Item = (&'static str, u64)>) -> Vec<Fallback> {
        taken
            .into_iter()
            .filter(|&(_, point_count)| point_count > 0)
            .map(|(what, point_count)| Fallback { what: what.into(), point_count })
            .collect()
    }
}

/// The plug-in that a filter was loaded from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Plugin {
    /// Its own name.
    pub name: String,
    /// Its version, in any form.
    pub version: String,
    /// Its file, as it was given.
    pub path: PathBuf,
    /// The file's size when it was loaded: bytes.
    pub bytes: u64,
    /// A number made of all its bytes then: what was damaged or compiled again has another.
    pub fingerprint: u64,
    /// Modification time of the file when it was loaded.
    pub modified: Option<SystemTime>,
}

impl Plugin {
    /// The fingerprint as people are told of it: 16 hexadecimal digits.
    pub fn fingerprint_text(&self) -> String {
        format!("{:016x}", self.fingerprint)
    }
}

/// Hash of all bytes. Each step is a bijection, so that a change in one word of 8 bytes always shows; a change in several, except
/// for a chance of 2⁻⁶⁴.
pub fn fingerprint(bytes: &[u8]) -> u64 {
    let mix = |sum: u64, word: u64| (sum.rotate_left(29) ^ word).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let (words, rest) = bytes.as_chunks::<8>();
    let mut last = [0; 8];
    last[..rest.len()].copy_from_slice(rest);
    let all = words.iter().chain([&last]).map(|word| u64::from_le_bytes(*word));
    all.fold(bytes.len() as u64, mix)
}

/// "plug-in 'name' (path)".
impl fmt::Display for Plugin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "plug-in '{}' ({})", self.name, self.path.display())
    }
}

/// Computes ∇s at the points of a grid.
pub trait GradientFilter: Send + Sync {
    /// Its name in pipeline files (`method = "least-squares"`), what it does in a sentence, and what can be set.
    fn declaration(&self) -> VariantSchema;

    /// The plug-in that it was loaded from; `None` for one that the program was built with.
    fn plugin(&self) -> Option<&Plugin> {
        None
    }

    /// Checks what single declarations cannot say (parameters that exclude each other). Touches no file.
    fn check(&self, parameters: &Parameters) -> Result<()> {
        let _ = parameters;
        Ok(())
    }

    /// Names of the point arrays that it reads with these parameters. The grid then has them.
    fn arrays(&self, parameters: &Parameters) -> Result<Vec<String>> {
        let _ = parameters;
        Ok(Vec::new())
    }

    /// ∇s at every point of `grid` for the values `scalar`, one a point. Finite at every point of a cell whose position and
    /// value are finite.
    fn gradient(
        &self,
        grid: &Grid,
        scalar: &[f64],
        parameters: &Parameters,
        progress: &dyn Progress,
    ) -> Result<Gradient>;

    /// Gradient at some points alone: a vector each, in their order, equal to [`GradientFilter::gradient`] there. `None`
    /// where this takes as long as all of them.
    fn gradient_at(
        &self,
        grid: &Grid,
        scalar: &[f64],
        points: &[u32],
        parameters: &Parameters,
        progress: &dyn Progress,
    ) -> Option<Result<Gradient>> {
        let _ = (grid, scalar, points, parameters, progress);
        None
    }
}

/// The error for a scalar whose number of values is not the grid's number of points.
pub fn check_scalar(grid: &Grid, scalar: &[f64]) -> Result<()> {
    grid.check_values("the scalar", scalar)
}

/// Points that one task handles.
const TASK: usize = 512;

/// Calls `f(scratch, point)` for every point, on all cores; `f` gives the gradient and the number of the fall-back
/// taken, if any. `scratch` makes what one thread works with. Returns the gradients and how often each of the `N`
/// fall-backs was taken ([`Fallback::list`](super::Fallback::list) makes a list of them).
///
/// Errors: a stopped run.
pub fn for_points<S: Send, const N: usize>(
    point_count: usize,
    progress: &dyn Progress,
    scratch: impl Fn() -> S + Sync + Send,
    f: impl Fn(&mut S, usize) -> (DVec3, Option<usize>) + Sync,
) -> Result<(Vec<DVec3>, [u64; N])> {
    for_these((point_count, None), progress, scratch, f)
}

/// Runs the loop for all points, or for those of a list.
pub(super) fn for_these<S: Send, const N: usize>(
    (point_count, points): (usize, Option<&[u32]>),
    progress: &dyn Progress,
    scratch: impl Fn() -> S + Sync + Send,
    f: impl Fn(&mut S, usize) -> (DVec3, Option<usize>) + Sync,
) -> Result<(Vec<DVec3>, [u64; N])> {
    let count = points.map_or(point_count, <[u32]>::len);
    let mut vectors = vec![DVec3::ZERO; count];
    let fitted = StageProgress::new(progress, "gradient", count);
    let counts = vectors
        .par_chunks_mut(TASK)
        .enumerate()
        .map_init(&scratch, |scratch, (task, vectors)| {
            let mut counts = [0; N];
            if progress.cancelled() {
                return counts;
            }
            let task_points = vectors.len();
            for (i, vector) in vectors.iter_mut().enumerate() {
                let place = task * TASK + i;
                let (gradient, fallback) = f(scratch, points.map_or(place, |points| points[place] as usize));
                *vector = gradient;
                if let Some(which) = fallback {
                    counts[which] += 1;
                }
            }
            fitted.advance(task_points);
            counts
        })
        .reduce(|| [0; N], |a, b| std::array::from_fn(|i| a[i] + b[i]));
    progress.check_cancelled()?;
    Ok((vectors, counts))
}

/// A gradient filter with its parameters. Whatever it gives was checked.
#[derive(Clone)]
pub struct Method {
    filter: Arc<dyn GradientFilter>,
    parameters: Parameters,
}

impl fmt::Debug for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Method").field("name", &self.name()).field("parameters", &self.parameters).finish()
    }
}

impl Method {
    /// The filter with these parameters, which were checked against what it declares.
    ///
    /// Errors: what the filter's own check says of them.
    pub fn new(filter: Arc<dyn GradientFilter>, parameters: Parameters) -> Result<Method> {
        filter.check(&parameters)?;
        Ok(Method { filter, parameters })
    }

    /// The filter with its standard values.
    ///
    /// Errors: a parameter that must be given.
    pub fn with_defaults(filter: Arc<dyn GradientFilter>) -> Result<Method> {
        let parameters = Parameters::from_values(filter.declaration().parameters, [])?;
        Self::new(filter, parameters)
    }

    /// The filter's name.
    pub fn name(&self) -> &'static str {
        self.filter.declaration().name
    }

    /// Parameter schema of the filter.
    pub fn declaration(&self) -> VariantSchema {
        self.filter.declaration()
    }

    /// The values that it goes by.
    pub fn parameters(&self) -> &Parameters {
        &self.parameters
    }

    /// The plug-in that the filter was loaded from.
    pub fn plugin(&self) -> Option<&Plugin> {
        self.filter.plugin()
    }

    /// The filter as messages call it.
    fn describe(&self) -> String {
        let of = self.plugin().map(|plugin| format!(" of the {plugin}")).unwrap_or_default();
        format!("the gradient filter '{}'{of}", self.name())
    }

    /// Names of the point arrays that it reads.
    pub fn arrays(&self) -> Result<Vec<String>> {
        self.filter.arrays(&self.parameters)
    }

    /// ∇s at every point of `grid` for the values `scalar`, one a point.
    ///
    /// Errors: those of the filter; vectors in another number than points, or not finite where position and value are.
    pub fn gradient(&self, grid: &Grid, scalar: &[f64], progress: &dyn Progress) -> Result<Gradient> {
        let grid = &*grid.with_ghosts();
        check_scalar(grid, scalar)?;
        self.checked(grid, scalar, None, self.filter.gradient(grid, scalar, &self.parameters, progress)?)
    }

    /// Gradient at some points alone, a vector each, in their order; `None` where that takes as long as all of them.
    ///
    /// Errors: those of [`Method::gradient`].
    pub fn gradient_at(
        &self,
        grid: &Grid,
        scalar: &[f64],
        points: &[u32],
        progress: &dyn Progress,
    ) -> Option<Result<Gradient>> {
        let grid = &*grid.with_ghosts();
        let found = self.filter.gradient_at(grid, scalar, points, &self.parameters, progress)?;
        Some(found.and_then(|found| self.checked(grid, scalar, Some(points), found)))
    }

    /// Checks that there is a vector for each point, finite where it must be. The length counts, which overflows before the components
    /// do: it is what widgets look at. Points that no cell uses may hold anything: the reader left out what is not finite.
    fn checked(
        &self,
        grid: &Grid,
        scalar: &[f64],
        points: Option<&[u32]>,
        found: Gradient,
    ) -> Result<Gradient> {
        let vectors = &found.vectors;
        let wanted = points.map_or(grid.points.len(), <[u32]>::len);
        if vectors.len() != wanted {
            let what = format!("{} did not give one vector a point", self.describe());
            return Err(Error::run(what).got(counted(vectors.len(), "vector")).expected(wanted));
        }
        let point_of = |place: usize| points.map_or(place, |points| points[place] as usize);
        let is_bad = |place: usize| {
            let p = point_of(place);
            !length(vectors[place]).is_finite() && grid.points[p].is_finite() && scalar[p].is_finite()
        };
        let places = (0..vectors.len()).into_par_iter().with_min_len(1 << 14);
        if !places.clone().any(is_bad) {
            return Ok(found);
        }
        let mut used = vec![false; grid.points.len()];
        grid.tetrahedra.iter().flatten().for_each(|&p| used[p as usize] = true);
        let is_found = |&place: &usize| used[point_of(place)] && is_bad(place);
        let Some(place) = places.find_first(is_found) else { return Ok(found) };
        let p = point_of(place);
        let (v, at) = (vectors[place], grid.points[p]);
        let what = format!("{} gave a vector that is not finite", self.describe());
        let value = format!(
            "({}, {}, {}) at point {p}, which lies at ({}, {}, {}) and has the value {}",
            v.x, v.y, v.z, at.x, at.y, at.z, scalar[p]
        );
        Err(Error::run(what).got(value).expected("a finite length wherever position and value are finite"))
    }
}
