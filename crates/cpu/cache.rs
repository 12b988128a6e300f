//! Caches between frames: values that are computed once, and buffers that are used again.

use std::sync::{Arc, Mutex, PoisonError};

/// Free list of buffers of one kind: fresh pages cost as much as projecting a cell does. No picture depends on which buffer one gets.
#[derive(Debug, Default)]
pub(crate) struct FreeList<T>(Mutex<Vec<T>>);

impl<T: Default> FreeList<T> {
    /// The buffer that was returned last, or a new one.
    pub fn take(&self) -> T {
        self.with(Vec::pop).unwrap_or_default()
    }

    pub fn put(&self, buffer: T) {
        self.with(|buffers| buffers.push(buffer));
    }

    fn with<U>(&self, act: impl FnOnce(&mut Vec<T>) -> U) -> U {
        // A buffer is whole in the list whatever panicked elsewhere.
        act(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

/// Returns the value in a slot if it is valid, else computes it and stores it there. An invalid one is dropped before: both may be large.
/// No thread blocks while another computes.
pub(crate) fn get_or_compute<T>(
    slot: &Mutex<Option<Arc<T>>>,
    is_valid: impl Fn(&T) -> bool,
    compute: impl FnOnce() -> T,
) -> Arc<T> {
    let mut cached = slot.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(cached) = cached.as_ref().filter(|cached| is_valid(cached)) {
        return cached.clone();
    }
    *cached = None;
    drop(cached);
    let computed = Arc::new(compute());
    *slot.lock().unwrap_or_else(PoisonError::into_inner) = Some(computed.clone());
    computed
}
