//! A run that the caller follows: it goes on in a thread of its own, and the caller's functions are called from the caller's.

use crate::session::{Drawing, Session};
use crate::structs::Follow;
use std::ffi::CString;
use std::panic::resume_unwind;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;
use voltet_core::graph::Observer;
use voltet_core::picture::Picture;
use voltet_core::{Error, Result};
use voltet_nodes::memory;

/// How often the caller is called.
const BETWEEN: Duration = Duration::from_millis(20);

/// Bytes of the run's stack: as many as a program's first thread has.
const STACK: usize = 8 << 20;

/// Where a run is.
#[derive(Default)]
struct State {
    stop: AtomicBool,
    place: Mutex<(String, String, f64)>,
}

impl Observer for State {
    fn started(&self, node: &str, _: usize, _: usize) {
        self.progress(node, "", 0.0);
    }

    fn progress(&self, node: &str, stage: &str, fraction: f64) {
        let mut place = self.place.lock().unwrap_or_else(PoisonError::into_inner);
        if (place.0.as_str(), place.1.as_str()) != (node, stage) {
            (place.0, place.1) = (node.into(), stage.into());
        }
        place.2 = fraction;
    }

    fn cancelled(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    fn memory_left(&self) -> Option<u64> {
        memory::left()
    }
}

/// Draws, and calls the caller's functions meanwhile.
///
/// # Safety
/// The functions may be called with their address.
pub(crate) unsafe fn draw(
    session: &mut Session,
    drawing: &Drawing,
    follow: Option<&Follow>,
) -> Result<Arc<Picture>> {
    let state = State::default();
    let Some(follow) = follow.filter(|follow| follow.progress.is_some() || follow.cancelled.is_some()) else {
        return session.draw(drawing, &state);
    };
    // SAFETY: the caller's promise.
    let call = || unsafe { call(follow, &state) };
    if call() {
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
                session.draw(drawing, state)
            },
        );
        let run = run.map_err(|error| Error::run("no thread can be begun").found(error))?;
        while is_done.recv_timeout(BETWEEN) == Err(RecvTimeoutError::Timeout) {
            if call() {
                state.stop.store(true, Ordering::Relaxed);
            }
        }
        run.join().unwrap_or_else(|panic| resume_unwind(panic))
    })
}

/// Says where the run is, and asks whether to stop.
///
/// # Safety
/// As of [`draw`].
unsafe fn call(follow: &Follow, state: &State) -> bool {
    if let Some(progress) = follow.progress {
        let (node, stage, fraction) = state.place.lock().unwrap_or_else(PoisonError::into_inner).clone();
        let [node, stage] = [node, stage].map(|text| CString::new(text).unwrap_or_default());
        // SAFETY: the caller's promise; the texts live during the call.
        unsafe { progress(follow.user, node.as_ptr(), stage.as_ptr(), fraction) };
    }
    // SAFETY: the caller's promise.
    follow.cancelled.is_some_and(|cancelled| unsafe { cancelled(follow.user) } != 0)
}
