//! State shared by the window's thread and the worker's, and the observer that reports a run to it.

use super::output::WorkerOutput;
use super::request::RenderRequest;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};
use voltet_graph::Observer;
use voltet_io::memory;

/// Progress is shown no more often than a screen does.
const BETWEEN: Duration = Duration::from_millis(50);

/// Wakes whoever shows what changed; called from any thread.
pub type RepaintCallback = Arc<dyn Fn() + Send + Sync>;

/// State shared by both threads.
pub(super) struct Shared {
    pub state: Mutex<SharedState>,
    pub changed: Condvar,
    /// The number of the newest request for a picture.
    pub newest: AtomicU64,
    wake: RepaintCallback,
}

#[derive(Default)]
pub(super) struct SharedState {
    /// The newest request, until it is worked at.
    pub picture: Option<RenderRequest>,
    pub output: WorkerOutput,
    pub ends: bool,
}

impl Shared {
    pub fn new(wake: RepaintCallback) -> Shared {
        Shared { state: Mutex::default(), changed: Condvar::new(), newest: AtomicU64::new(0), wake }
    }

    /// Changes what is shown, and has it shown.
    pub fn show(&self, change: impl FnOnce(&mut WorkerOutput)) {
        change(&mut lock(&self.state).output);
        (self.wake)();
    }

    pub fn newest(&self) -> u64 {
        self.newest.load(Ordering::SeqCst)
    }
}

pub(super) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Says whether a run is to stop, given what tells the node that runs; none between two.
pub(super) type Stop<'a> = &'a (dyn Fn(&dyn Fn() -> Option<String>) -> bool + Sync);

/// Observer of a run.
pub(super) struct Following<'a> {
    shared: &'a Shared,
    stop: Stop<'a>,
    /// True if progress is shown.
    told: bool,
    node: Mutex<Option<String>>,
    last: Mutex<Instant>,
}

impl<'a> Following<'a> {
    /// Stops where `stop` says so.
    pub fn new(shared: &'a Shared, stop: Stop<'a>, told: bool) -> Self {
        Following { shared, stop, told, node: Mutex::default(), last: Mutex::new(Instant::now()) }
    }

    /// The node that runs.
    pub fn node(&self) -> Option<String> {
        lock(&self.node).clone()
    }
}

impl Observer for Following<'_> {
    fn started(&self, node: &str, _place: usize, _count: usize) {
        *lock(&self.node) = Some(node.to_string());
        if self.told {
            lock(&self.shared.state).output.started(node);
        }
    }

    fn finished(&self, node: &str, seconds: f64) {
        *lock(&self.node) = None;
        if self.told {
            lock(&self.shared.state).output.done(node, seconds);
        }
    }

    fn progress(&self, node: &str, stage: &str, fraction: f64) {
        let mut last = lock(&self.last);
        if self.told && last.elapsed() >= BETWEEN {
            *last = Instant::now();
            drop(last);
            self.shared.show(|shown| shown.progress(node, stage, fraction));
        }
    }

    fn cancelled(&self) -> bool {
        (self.stop)(&|| self.node())
    }

    fn memory_left(&self) -> Option<u64> {
        memory::available()
    }
}
