//! A run that the program follows: it goes on in a thread of its own, and the program is asked from the thread that called.

use std::panic::resume_unwind;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, TryRecvError, channel};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};
use voltet_core::{Error, Result};
use voltet_graph::Observer;
use voltet_io::memory;

/// How often the program is asked.
const BETWEEN: Duration = Duration::from_millis(20);

/// Bytes of the run's stack: as many as a program's first thread has.
const STACK: usize = 8 << 20;

/// Where a run is.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Moment {
    /// The node that runs; empty before the first.
    pub node: String,
    /// The stage of the node; empty at its beginning.
    pub stage: String,
    /// How much of the stage is done: 0 … 1.
    pub fraction: f64,
}

/// What the run tells and is told.
#[derive(Default)]
struct State {
    stop: AtomicBool,
    moment: Mutex<Moment>,
}

impl Observer for State {
    fn started(&self, node: &str, _: usize, _: usize) {
        self.progress(node, "", 0.0);
    }

    fn progress(&self, node: &str, stage: &str, fraction: f64) {
        let mut moment = self.moment.lock().unwrap_or_else(PoisonError::into_inner);
        if (moment.node.as_str(), moment.stage.as_str()) != (node, stage) {
            (moment.node, moment.stage) = (node.into(), stage.into());
        }
        moment.fraction = fraction;
    }

    fn cancelled(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    fn memory_left(&self) -> Option<u64> {
        memory::available()
    }
}

impl State {
    fn moment(&self) -> Moment {
        self.moment.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}

/// Does `work`. With `stops`, in a thread of its own: meanwhile `stops` is called every 20 ms, on the thread that called, and the
/// work is stopped once it says so. So it is by an item of `beside` that is true: these are work for that thread, done one after
/// another as long as the run goes on; the others are left. Errors: those of the work; of a work that was stopped that it was.
pub fn follow<T: Send>(
    work: impl FnOnce(&dyn Observer) -> Result<T> + Send,
    stops: Option<impl FnMut(&Moment) -> bool>,
    beside: &mut dyn Iterator<Item = bool>,
) -> Result<T> {
    let state = State::default();
    let Some(mut stops) = stops else { return work(&state) };
    if stops(&state.moment()) {
        return Err(Error::cancelled());
    }
    std::thread::scope(|scope| {
        let (done, is_done) = channel::<()>();
        let state = &state;
        let run = std::thread::Builder::new().name("voltet".into()).stack_size(STACK).spawn_scoped(
            scope,
            move || {
                // Goes when the run ends, however it does.
                let _done = done;
                work(state)
            },
        );
        let run = run.map_err(|error| Error::run("no thread can be begun").got(error))?;
        let mut asked = Instant::now();
        loop {
            let (stopped, ended) = match beside.next() {
                Some(stopped) => (stopped, is_done.try_recv() == Err(TryRecvError::Disconnected)),
                None => {
                    let left = BETWEEN.saturating_sub(asked.elapsed());
                    (false, is_done.recv_timeout(left) == Err(RecvTimeoutError::Disconnected))
                }
            };
            if ended {
                break;
            }
            let is_time = asked.elapsed() >= BETWEEN;
            if is_time {
                asked = Instant::now();
            }
            if stopped || is_time && stops(&state.moment()) {
                state.stop.store(true, Ordering::Relaxed);
            }
        }
        run.join().unwrap_or_else(|panic| resume_unwind(panic))
    })
}
