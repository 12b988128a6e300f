//! Work on a thread of its own, which can be given up: what a plug-in does not end, nobody can end for it.

use std::panic::AssertUnwindSafe;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

/// The stack that the interface promises: bytes.
const STACK: usize = 64 << 20;

/// How often the one who waits looks around.
const PAUSE: Duration = Duration::from_millis(10);

/// Why there is no outcome.
#[derive(Debug, PartialEq, Eq)]
pub(crate) enum Lost {
    /// It was given up, and goes on.
    GivenUp,
    /// The system has no thread for it.
    NoThread,
    /// The thread ended without one: a mistake of ours, which was shown.
    Ended,
}

/// Does `work` on a new thread and waits for it while `waits` says so, which is asked every few milliseconds. What the work
/// changes of its thread (the rounding of numbers, say) ends with it.
pub(crate) fn run<T: Send + 'static>(
    work: impl FnOnce() -> T + Send + 'static,
    mut waits: impl FnMut() -> bool,
) -> Result<T, Lost> {
    let (sender, receiver) = channel();
    let thread = std::thread::Builder::new().name("plug-in".into()).stack_size(STACK);
    let begun = thread.spawn(move || {
        // An exception of another language ends the program here, before anybody takes the thread for ended.
        if let Ok(outcome) = std::panic::catch_unwind(AssertUnwindSafe(work)) {
            // Nobody may wait any more.
            let _ = sender.send(outcome);
        }
    });
    begun.map_err(|_| Lost::NoThread)?;
    // A thread of the pool must go on with the pool's work, which may be that of the plug-in.
    let of_pool = rayon::current_thread_index().is_some();
    loop {
        let worked = of_pool && rayon::yield_now() == Some(rayon::Yield::Executed);
        match receiver.recv_timeout(if worked { Duration::ZERO } else { PAUSE }) {
            Ok(outcome) => return Ok(outcome),
            Err(RecvTimeoutError::Disconnected) => return Err(Lost::Ended),
            Err(RecvTimeoutError::Timeout) if waits() => {}
            Err(RecvTimeoutError::Timeout) => return Err(Lost::GivenUp),
        }
    }
}
