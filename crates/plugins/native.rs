//! Runner of a plug-in's functions in this process.

use crate::crash;
use crate::declaration::{Declaration, LibraryItem};
use crate::host::State;
use crate::library::Library;
use crate::runner::Runner;
use crate::status::{CallLabel, CallStatus};
use crate::task::{CheckTask, Outcome, Task};
use crate::watchdog::{self, CallFailure};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};
use voltet_core::Result;
use voltet_core::field::Plugin;
use voltet_core::progress::Progress;

/// Longest time of a plug-in to stop, and of a check.
const STOP_TIME_LIMIT: Duration = Duration::from_secs(3);

/// A loaded library with its items.
pub(crate) struct Native {
    library: Arc<Library>,
    items: Vec<LibraryItem>,
}

/// Guard of a library while one of its functions runs.
struct BusyGuard(Arc<Library>);

impl Drop for BusyGuard {
    fn drop(&mut self) {
        self.0.busy.store(false, Ordering::Release);
    }
}

impl Native {
    pub fn new(library: Library, items: Vec<LibraryItem>) -> Native {
        Native { library: Arc::new(library), items }
    }

    /// Runs a function of the plug-in, one at a time, on a thread of its own, while `may_go_on` is true.
    fn call<T: Send + 'static>(
        &self,
        label: CallLabel<'_>,
        work: impl FnOnce() -> T + Send + 'static,
        mut may_go_on: impl FnMut() -> bool,
    ) -> std::result::Result<T, CallFailure> {
        while self.library.busy.swap(true, Ordering::Acquire) {
            if !may_go_on() {
                return Err(CallFailure::GivenUp);
            }
            std::thread::sleep(Duration::from_millis(5));
        }
        let (busy, when) = (BusyGuard(self.library.clone()), format!("in the {}", label.item()));
        let work = move || crash::attribute(&busy.0.plugin, &when, work);
        watchdog::run(work, may_go_on)
    }
}

impl Runner for Native {
    fn plugin(&self) -> &Plugin {
        &self.library.plugin
    }

    fn run(
        &self,
        declaration: &Declaration,
        task: Box<dyn Task>,
        progress: &dyn Progress,
    ) -> Result<(CallStatus, Outcome)> {
        let label = CallLabel::new(declaration, &self.library.plugin);
        let item = self.items.iter().find(|item| item.declaration.schema.name == declaration.schema.name);
        let Some(item) = item.cloned() else { return Err(label.error("is not there any more")) };
        let (is_check, stage, start) =
            (task.kind().tag == CheckTask::KIND.tag, task.kind().stage, Instant::now());
        let state = Arc::new(State::default());
        let mut cancelled: Option<Instant> = None;
        let may_go_on = || {
            if is_check {
                return start.elapsed() < STOP_TIME_LIMIT;
            }
            progress.report(stage, state.fraction());
            if progress.cancelled() {
                state.cancel();
                cancelled.get_or_insert_with(Instant::now);
            }
            cancelled.is_none_or(|cancelled| cancelled.elapsed() < STOP_TIME_LIMIT)
        };
        let called = {
            let state = state.clone();
            self.call(label, move || task.run(&item, &state), may_go_on)
        };
        called.map_err(|failure| match failure {
            CallFailure::GivenUp if is_check => {
                label.error("does not come back from checking its parameters")
            }
            CallFailure::GivenUp => label.error("was asked to stop and goes on").expected(format!(
                "it to stop within {} s; only the end of the program ends it, or --plugin-process",
                STOP_TIME_LIMIT.as_secs()
            )),
            CallFailure::NoThread | CallFailure::Ended => {
                label.error("cannot be run: the system gives no thread for it")
            }
        })
    }
}
