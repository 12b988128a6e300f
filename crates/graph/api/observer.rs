//! The observer of a run, which follows it and may stop it.

use voltet_core::progress::Progress;

/// Follows a run, and may stop it. Called from any thread.
pub trait Observer: Sync {
    /// A node begins: `place` of `count`.
    fn started(&self, _node: &str, _place: usize, _count: usize) {}
    /// A stage of a node is `fraction` (0 … 1) done.
    fn progress(&self, _node: &str, _stage: &str, _fraction: f64) {}
    /// A node is done.
    fn finished(&self, _node: &str, _seconds: f64) {}
    /// True once the run should stop, and from then on.
    fn cancelled(&self) -> bool {
        false
    }
    /// Bytes that the run may still take, where somebody knows.
    fn memory_left(&self) -> Option<u64> {
        None
    }
}

/// Follows nothing and never stops.
pub struct NoObserver;

impl Observer for NoObserver {}

/// Hands the progress of one node on to the observer of the run.
pub struct NodeProgress<'a> {
    /// The observer of the run.
    pub observer: &'a dyn Observer,
    /// The node's name.
    pub node: &'a str,
}

impl Progress for NodeProgress<'_> {
    fn report(&self, stage: &str, fraction: f64) {
        self.observer.progress(self.node, stage, fraction);
    }

    fn cancelled(&self) -> bool {
        self.observer.cancelled()
    }

    fn memory_left(&self) -> Option<u64> {
        self.observer.memory_left()
    }
}
