//! Progress, cancellation and memory limit of long work.

use crate::{Error, Result};
use std::sync::atomic::{AtomicUsize, Ordering};

/// Receives progress and says whether the work should stop. Shared by all threads of a stage.
pub trait Progress: Sync {
    /// A stage is `fraction` (0 … 1) done. May be called from any thread, often; cheap when ignored.
    fn report(&self, stage: &str, fraction: f64);
    /// True once the user asked to stop, and from then on: each thread of a stage may leave out the rest of its part. Long loops call
    /// [`Progress::check_cancelled`] now and then.
    fn cancelled(&self) -> bool {
        false
    }
    /// The error of a stopped run, once the user asked to stop.
    fn check_cancelled(&self) -> Result<()> {
        if self.cancelled() { Err(Error::cancelled()) } else { Ok(()) }
    }
    /// Bytes that the work may still take, where somebody knows.
    fn memory_left(&self) -> Option<u64> {
        None
    }
}

/// Refuses work that takes more memory than is left. `what` takes it, as a clause that "takes about 3 GiB" can follow.
pub fn refuse_beyond_memory(
    progress: &dyn Progress,
    what: impl FnOnce() -> String,
    bytes: u64,
) -> Result<()> {
    let Some(left) = progress.memory_left().filter(|left| *left < bytes) else { return Ok(()) };
    let mebibytes = |bytes: u64| format!("{:.0} MiB", bytes as f64 / f64::from(1 << 20));
    Err(Error::run("memory ends before the work does")
        .got(format!("{} takes about {}, {} are left", what(), mebibytes(bytes), mebibytes(left)))
        .expected("a smaller grid or picture, or more memory"))
}

/// Ignores progress and never stops.
pub struct NoProgress;

impl Progress for NoProgress {
    fn report(&self, _stage: &str, _fraction: f64) {}
}

/// Hands on that the work should stop, and no progress: for parts of a work whose own progress says nothing of the whole.
pub struct CancelOnly<'a>(pub &'a dyn Progress);

impl Progress for CancelOnly<'_> {
    fn report(&self, _stage: &str, _fraction: f64) {}

    fn cancelled(&self) -> bool {
        self.0.cancelled()
    }

    fn memory_left(&self) -> Option<u64> {
        self.0.memory_left()
    }
}

/// Counter of the items of a stage, shared by its threads, which reports the share that is done.
pub struct StageProgress<'a> {
    progress: &'a dyn Progress,
    stage: &'static str,
    done: AtomicUsize,
    count: usize,
}

impl<'a> StageProgress<'a> {
    /// A stage of `count` items, none of which is done.
    pub fn new(progress: &'a dyn Progress, stage: &'static str, count: usize) -> Self {
        StageProgress { progress, stage, done: AtomicUsize::new(0), count }
    }

    /// Counts some more items as done.
    pub fn advance(&self, items: usize) {
        let done = self.done.fetch_add(items, Ordering::Relaxed) + items;
        self.progress.report(self.stage, (done as f64 / self.count.max(1) as f64).min(1.0));
    }
}

/// Progress of a part of a stage, handed on as progress of all of it.
pub struct PartProgress<'a> {
    /// Progress of all of the stage.
    pub whole: &'a dyn Progress,
    /// The stage that is reported.
    pub stage: &'static str,
    /// Shares of the stage that are done before the part and after it.
    pub range: [f64; 2],
}

impl Progress for PartProgress<'_> {
    fn report(&self, _stage: &str, fraction: f64) {
        let [before, after] = self.range;
        self.whole.report(self.stage, before + (after - before) * fraction);
    }

    fn cancelled(&self) -> bool {
        self.whole.cancelled()
    }

    fn memory_left(&self) -> Option<u64> {
        self.whole.memory_left()
    }
}
