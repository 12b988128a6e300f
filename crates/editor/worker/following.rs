//! Follows a run for what is shown of it.

use super::shared::{Shared, lock};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};
use voltet_core::progress::Progress;
use voltet_graph::Observer;
use voltet_io::memory;

/// Progress is shown no more often than a screen does.
const BETWEEN: Duration = Duration::from_millis(50);

/// Says whether a run is to stop, given what tells the node that runs; none between two.
pub(super) type Stop<'a> = &'a (dyn Fn(&dyn Fn() -> Option<String>) -> bool + Sync);

pub(super) struct Following<'a> {
    shared: &'a Shared,
    stop: Stop<'a>,
    told: bool,
    node: Mutex<Option<String>>,
    last: Mutex<Instant>,
}

impl<'a> Following<'a> {
    /// Stops where `stop` says so.
    pub fn new(shared: &'a Shared, stop: Stop<'a>) -> Self {
        Following { shared, stop, told: true, node: Mutex::default(), last: Mutex::new(Instant::now()) }
    }

    /// An observer without progress reports.
    pub fn silent(shared: &'a Shared, stop: Stop<'a>) -> Self {
        Following { told: false, ..Self::new(shared, stop) }
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
            lock(&self.shared.shown).started(node);
        }
    }

    fn finished(&self, node: &str, seconds: f64) {
        *lock(&self.node) = None;
        if self.told {
            lock(&self.shared.shown).done(node, seconds);
        }
    }

    fn progress(&self, node: &str, stage: &str, fraction: f64) {
        if !self.told {
            return;
        }
        let mut last = self.last.lock().unwrap_or_else(PoisonError::into_inner);
        if last.elapsed() < BETWEEN {
            return;
        }
        *last = Instant::now();
        drop(last);
        self.shared.show(|shown| shown.progress(node, stage, fraction));
    }

    fn cancelled(&self) -> bool {
        (self.stop)(&|| self.node())
    }

    fn memory_left(&self) -> Option<u64> {
        memory::available()
    }
}

impl Progress for Following<'_> {
    fn report(&self, _stage: &str, _fraction: f64) {}

    fn cancelled(&self) -> bool {
        (self.stop)(&|| self.node())
    }

    fn memory_left(&self) -> Option<u64> {
        memory::available()
    }
}
