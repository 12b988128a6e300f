//! Runs in the background: the work has a thread of its own, and the caller's functions are called from the caller's thread.

use std::any::Any;
use std::panic::resume_unwind;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, TryRecvError, channel};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};
use voltet_core::{Error, Result};
use voltet_graph::Observer;
use voltet_io::memory;

/// Time between two calls of the caller's function.
const POLL_INTERVAL: Duration = Duration::from_millis(20);

/// Stack of the run's thread (bytes): that of a program's first thread.
const STACK: usize = 8 << 20;

/// Progress of a run at one moment.
#[derive(Debug, Clone, Default, PartialEq)]
#[non_exhaustive]
pub struct RunStatus {
    /// The node that runs; empty before the first.
    pub node: String,
    /// The stage of the node; empty at its beginning.
    pub stage: String,
    /// Completed part of the stage: 0 … 1.
    pub fraction: f64,
}

/// State shared by the run and the caller.
#[derive(Default)]
struct State {
    stop: AtomicBool,
    status: Mutex<RunStatus>,
}

impl Observer for State {
    fn started(&self, node: &str, _: usize, _: usize) {
        self.progress(node, "", 0.0);
    }

    fn progress(&self, node: &str, stage: &str, fraction: f64) {
        let mut status = self.status.lock().unwrap_or_else(PoisonError::into_inner);
        if (status.node.as_str(), status.stage.as_str()) != (node, stage) {
            (status.node, status.stage) = (node.into(), stage.into());
        }
        status.fraction = fraction;
    }

    fn cancelled(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    fn memory_left(&self) -> Option<u64> {
        memory::available()
    }
}

/// Runs `work`. With `stops`, in a thread of its own: meanwhile `stops` is called every 20 ms on the calling thread, and the work is
/// cancelled once it returns true. `side_work` is done on the calling thread, item by item, as long as the run goes on; an item that
/// is true cancels the run, and items that are left stay in the iterator.
///
/// # Errors
/// - those of the work;
/// - cancellation of work that was stopped.
pub fn run_in_background<T: Send>(
    work: impl FnOnce(&dyn Observer) -> Result<T> + Send,
    stops: Option<impl FnMut(&RunStatus) -> bool>,
    side_work: &mut dyn Iterator<Item = bool>,
) -> Result<T> {
    let state = State::default();
    let Some(mut stops) = stops else { return work(&state) };
    let status = || state.status.lock().unwrap_or_else(PoisonError::into_inner).clone();
    if stops(&status()) {
        return Err(Error::cancelled());
    }
    std::thread::scope(|scope| {
        let (done, is_done) = channel::<()>();
        let state = &state;
        let run = std::thread::Builder::new().name("voltet".into()).stack_size(STACK).spawn_scoped(
            scope,
            move || {
                // Dropped when the run ends, however it does.
                let _done = done;
                work(state)
            },
        );
        let run = run.map_err(|error| Error::run("no thread can be begun").got(error))?;
        let mut polled = Instant::now();
        loop {
            let (stopped, ended) = match side_work.next() {
                Some(stopped) => (stopped, is_done.try_recv() == Err(TryRecvError::Disconnected)),
                None => {
                    let rest = POLL_INTERVAL.saturating_sub(polled.elapsed());
                    (false, is_done.recv_timeout(rest) == Err(RecvTimeoutError::Disconnected))
                }
            };
            if ended {
                break;
            }
            let is_time = polled.elapsed() >= POLL_INTERVAL;
            if is_time {
                polled = Instant::now();
            }
            if stopped || is_time && stops(&status()) {
                state.stop.store(true, Ordering::Relaxed);
            }
        }
        run.join().unwrap_or_else(|panic| resume_unwind(panic))
    })
}

/// Message for a panic that was caught: it is a defect of voltet, and must not leave the library.
pub fn panic_message(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().copied();
    let text = text.or_else(|| panic.downcast_ref::<String>().map(String::as_str)).unwrap_or("no message");
    format!("this is a mistake of voltet itself: {text}; please report it")
}
