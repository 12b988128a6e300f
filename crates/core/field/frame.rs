//! Parallel loop over points with progress and cancellation, shared by the filters that work point by point.

use crate::progress::Progress;
use crate::{Error, Result};
use glam::DVec3;
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};

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
    let done = AtomicUsize::new(0);
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
            let done = done.fetch_add(task_points, Ordering::Relaxed) + task_points;
            progress.report("gradient", done as f64 / count as f64);
            counts
        })
        .reduce(|| [0; N], |a, b| std::array::from_fn(|i| a[i] + b[i]));
    if progress.cancelled() { Err(Error::cancelled()) } else { Ok((vectors, counts)) }
}
