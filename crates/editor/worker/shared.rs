//! State shared by the window's thread and the worker's.

use super::queries::{DistributionQuery, ProbeQuery, SectionQuery, ShareQuery};
use super::request::RenderRequest;
use super::states::WorkerOutput;
use std::collections::BTreeMap;
use std::sync::atomic::AtomicU64;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};

/// Wakes whoever shows what changed; called from any thread.
pub type RepaintCallback = Arc<dyn Fn() + Send + Sync>;

/// State shared by both threads.
pub(super) struct Shared {
    pub wanted: Mutex<Queue>,
    pub changed: Condvar,
    /// The number of the newest request for a picture.
    pub newest: AtomicU64,
    pub shown: Mutex<WorkerOutput>,
    pub wake: RepaintCallback,
}

#[derive(Default)]
pub(super) struct Queue {
    pub picture: Option<RenderRequest>,
    pub distribution: Option<DistributionQuery>,
    pub probing: Option<ProbeQuery>,
    pub section: Option<SectionQuery>,
    pub estimate: Option<(u64, RenderRequest)>,
    pub share: Option<ShareQuery>,
    /// By their nodes.
    pub previews: BTreeMap<String, RenderRequest>,
    pub ends: bool,
}

pub(super) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Shared {
    /// Changes what is shown, and has it shown.
    pub fn show(&self, change: impl FnOnce(&mut WorkerOutput)) {
        change(&mut lock(&self.shown));
        (self.wake)();
    }
}
