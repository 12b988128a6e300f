//! What the window's thread and the worker's both see.

use super::asked::{Distribution, Probing, Sectioning, Sharing};
use super::request::Wanted;
use super::states::Shown;
use std::collections::BTreeMap;
use std::sync::atomic::AtomicU64;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};

/// Wakes whoever shows what changed; called from any thread.
pub type Wake = Arc<dyn Fn() + Send + Sync>;

/// What both threads see.
pub(super) struct Shared {
    pub wanted: Mutex<Queue>,
    pub changed: Condvar,
    /// The number of the newest request for a picture.
    pub newest: AtomicU64,
    pub shown: Mutex<Shown>,
    pub wake: Wake,
}

#[derive(Default)]
pub(super) struct Queue {
    pub picture: Option<Wanted>,
    pub distribution: Option<Distribution>,
    pub probing: Option<Probing>,
    pub section: Option<Sectioning>,
    pub estimate: Option<(u64, Wanted)>,
    pub share: Option<Sharing>,
    /// By their nodes.
    pub previews: BTreeMap<String, Wanted>,
    pub ends: bool,
}

pub(super) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Shared {
    /// Changes what is shown, and has it shown.
    pub fn show(&self, change: impl FnOnce(&mut Shown)) {
        change(&mut lock(&self.shown));
        (self.wake)();
    }
}
