//! A plug-in's functions, run in this process.

use crate::apart::{self, Lost};
use crate::crash;
use crate::describe::Declared;
use crate::host::State;
use crate::library::{Library, Piece};
use crate::outcome::{Said, Whose};
use crate::runner::Runner;
use crate::task::{Outcome, Task};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};
use voltet_core::Result;
use voltet_core::field::Plugin;
use voltet_core::progress::Progress;

/// How long a plug-in may take to stop, and a check to say something.
const GRACE: Duration = Duration::from_secs(3);

/// A loaded library with what it offers.
pub(crate) struct Native {
    library: Arc<Library>,
    pieces: Vec<Piece>,
}

/// A function of the library runs, or is about to.
struct Busy(Arc<Library>);

impl Drop for Busy {
    fn drop(&mut self) {
        self.0.busy.store(false, Ordering::Release);
    }
}

impl Native {
    pub fn new(library: Library, pieces: Vec<Piece>) -> Native {
        Native { library: Arc::new(library), pieces }
    }

    /// Runs a function of the plug-in, one at a time, on a thread of its own, while `waits` says so.
    fn call<T: Send + 'static>(
        &self,
        whose: Whose<'_>,
        work: impl FnOnce() -> T + Send + 'static,
        mut waits: impl FnMut() -> bool,
    ) -> std::result::Result<T, Lost> {
        while self.library.busy.swap(true, Ordering::Acquire) {
            if !waits() {
                return Err(Lost::GivenUp);
            }
            std::thread::sleep(Duration::from_millis(5));
        }
        let (busy, when) = (Busy(self.library.clone()), format!("in the {}", whose.piece()));
        let work = move || crash::during(&busy.0.plugin, &when, work);
        apart::run(work, waits)
    }
}

impl Runner for Native {
    fn plugin(&self) -> &Plugin {
        &self.library.plugin
    }

    fn run(&self, of: &Declared, task: Task, progress: &dyn Progress) -> Result<(Said, Outcome)> {
        let whose = Whose::new(of, &self.library.plugin);
        let piece = self.pieces.iter().find(|piece| piece.declared.kind.name == of.kind.name);
        let Some(piece) = piece.cloned() else { return Err(whose.error("is not there any more")) };
        let (is_check, stage, start) = (matches!(task, Task::Check(_)), task.stage(), Instant::now());
        let state = Arc::new(State::default());
        let mut asked: Option<Instant> = None;
        let waits = || {
            if is_check {
                return start.elapsed() < GRACE;
            }
            progress.report(stage, state.fraction());
            if progress.cancelled() {
                state.cancel();
                asked.get_or_insert_with(Instant::now);
            }
            asked.is_none_or(|asked| asked.elapsed() < GRACE)
        };
        let called = {
            let state = state.clone();
            self.call(whose, move || task.carry_out(&piece, &state), waits)
        };
        called.map_err(|lost| match lost {
            Lost::GivenUp if is_check => whose.error("does not come back from checking its parameters"),
            Lost::GivenUp => whose.error("was asked to stop and goes on").expected(format!(
                "it to stop within {} s; only the end of the program ends it, or --plugin-process",
                GRACE.as_secs()
            )),
            Lost::NoThread | Lost::Ended => whose.error("cannot be run: the system gives no thread for it"),
        })
    }
}
