//! Guard of blocking writes: while a reader of the output is slow, only the program's end stops it.

use std::sync::atomic::{AtomicBool, Ordering};

static WAITS: AtomicBool = AtomicBool::new(false);

/// The program waits until this goes away.
pub(super) struct WriteGuard;

/// A write begins that may have to wait for a reader: to a pipe or a terminal.
pub(super) fn begin() -> WriteGuard {
    WAITS.store(true, Ordering::Relaxed);
    WriteGuard
}

impl Drop for WriteGuard {
    fn drop(&mut self) {
        WAITS.store(false, Ordering::Relaxed);
    }
}

/// True if a write to a pipe or a terminal is on its way.
pub fn is_waiting() -> bool {
    WAITS.load(Ordering::Relaxed)
}
