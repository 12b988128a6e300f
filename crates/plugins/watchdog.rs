//! Work on a thread that can be given up: a plug-in that does not return cannot be ended.

use std::panic::AssertUnwindSafe;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

/// Stack that the interface promises (bytes).
const STACK: usize = 64 << 20;

/// Interval between two calls of `goes_on`.
const INTERVAL: Duration = Duration::from_millis(10);

/// Reason for which a call has no result.
#[derive(Debug, PartialEq, Eq)]
pub(crate) enum CallFailure {
    /// It was given up, and still runs.
    GivenUp,
    /// The system has no thread for it.
    NoThread,
    /// The thread panicked, and printed why.
    Ended,
}

/// Runs `work` on a new thread, and gives it up once `may_go_on`, called every few milliseconds, is false. Changes to the thread's
/// state (the rounding of numbers, for example) end with it.
pub(crate) fn run<T: Send + 'static>(
    work: impl FnOnce() -> T + Send + 'static,
    mut may_go_on: impl FnMut() -> bool,
) -> Result<T, CallFailure> {
    let (sender, receiver) = channel();
    let thread = std::thread::Builder::new().name("plug-in".into()).stack_size(STACK);
    let spawned = thread.spawn(move || {
        // An exception of another language ends the program here, before the receiver could take the thread for ended.
        if let Ok(outcome) = std::panic::catch_unwind(AssertUnwindSafe(work)) {
            // The receiver may have given up.
            let _ = sender.send(outcome);
        }
    });
    spawned.map_err(|_| CallFailure::NoThread)?;
    // A thread of the pool must go on with the pool's work, which may be that of the plug-in.
    let is_in_pool = rayon::current_thread_index().is_some();
    loop {
        let worked = is_in_pool && rayon::yield_now() == Some(rayon::Yield::Executed);
        match receiver.recv_timeout(if worked { Duration::ZERO } else { INTERVAL }) {
            Ok(outcome) => return Ok(outcome),
            Err(RecvTimeoutError::Disconnected) => return Err(CallFailure::Ended),
            Err(RecvTimeoutError::Timeout) if may_go_on() => {}
            Err(RecvTimeoutError::Timeout) => return Err(CallFailure::GivenUp),
        }
    }
}
