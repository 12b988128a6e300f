//! A gradient filter of a library, run in this process.

use crate::apart::{self, Lost};
use crate::crash;
use crate::host::State;
use crate::library::{Filter, Library};
use crate::outcome::Whose;
use crate::values::{Owned, array_names};
use crate::work::{Given, check};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};
use voltet_core::field::{Gradient, GradientFilter, Plugin, check_scalar};
use voltet_core::grid::Grid;
use voltet_core::parameters::{Kind, Parameters};
use voltet_core::progress::Progress;
use voltet_core::{Error, Result};

/// How long a filter may take to stop, and a check to say something.
const GRACE: Duration = Duration::from_secs(3);

/// A filter of a loaded library.
pub(crate) struct Native {
    library: Arc<Library>,
    filter: Filter,
}

/// A function of the library runs, or is about to.
struct Busy(Arc<Library>);

impl Drop for Busy {
    fn drop(&mut self) {
        self.0.busy.store(false, Ordering::Release);
    }
}

impl Native {
    pub fn new(library: Arc<Library>, filter: Filter) -> Native {
        Native { library, filter }
    }

    fn whose(&self) -> Whose<'_> {
        Whose { filter: self.filter.declared.kind.name, plugin: &self.library.plugin }
    }

    /// Runs a function of the plug-in, one at a time, on a thread of its own, while `waits` says so.
    fn call<T: Send + 'static>(
        &self,
        work: impl FnOnce() -> T + Send + 'static,
        mut waits: impl FnMut() -> bool,
    ) -> std::result::Result<T, Lost> {
        while self.library.busy.swap(true, Ordering::Acquire) {
            if !waits() {
                return Err(Lost::GivenUp);
            }
            std::thread::sleep(Duration::from_millis(5));
        }
        let (busy, name) = (Busy(self.library.clone()), self.filter.declared.kind.name);
        let work = move || crash::during(&busy.0.plugin, &format!("in the gradient filter '{name}'"), work);
        apart::run(work, waits)
    }

    fn lost(&self, lost: &Lost) -> Error {
        match lost {
            Lost::GivenUp => self.whose().error("was asked to stop and goes on").accepted(format!(
                "it to stop within {} s; only the end of the program ends it, or --plugin-process",
                GRACE.as_secs()
            )),
            Lost::NoThread | Lost::Ended => {
                self.whose().error("cannot be run: the system gives no thread for it")
            }
        }
    }
}

impl GradientFilter for Native {
    fn declaration(&self) -> Kind {
        self.filter.declared.kind
    }

    fn plugin(&self) -> Option<&Plugin> {
        Some(&self.library.plugin)
    }

    fn check(&self, parameters: &Parameters) -> Result<()> {
        let values = Owned::new(&self.filter.declared, parameters)?;
        let Some(function) = self.filter.check else { return Ok(()) };
        let start = Instant::now();
        let said = self.call(move || check(function, &values, &State::default()), || start.elapsed() < GRACE);
        match said {
            Ok(said) => self.whose().checked(said),
            Err(Lost::GivenUp) => Err(self.whose().error("does not come back from checking its parameters")),
            Err(lost) => Err(self.lost(&lost)),
        }
    }

    fn arrays(&self, parameters: &Parameters) -> Result<Vec<String>> {
        Ok(array_names(&self.filter.declared, parameters))
    }

    fn gradient(
        &self,
        grid: &Grid,
        scalar: &[f64],
        parameters: &Parameters,
        progress: &dyn Progress,
    ) -> Result<Gradient> {
        check_scalar(grid, scalar)?;
        let given = Given::new(&self.filter.declared, grid, scalar, parameters)?;
        let (function, needs) = (self.filter.gradient, self.filter.declared.needs);
        let state = Arc::new(State::default());
        let mut asked: Option<Instant> = None;
        let waits = || {
            progress.report("gradient", state.fraction());
            if progress.cancelled() {
                state.cancel();
                asked.get_or_insert_with(Instant::now);
            }
            asked.is_none_or(|asked| asked.elapsed() < GRACE)
        };
        let called = {
            let state = state.clone();
            self.call(move || given.compute(function, needs, &state), waits)
        };
        let (said, vectors) = called.map_err(|lost| self.lost(&lost))?;
        self.whose().gradient(grid, said, vectors, progress.cancelled())
    }
}
