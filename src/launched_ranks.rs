//! The processes that a launcher has started: MPI starts on a thread of its own, which takes a quarter of a second of waiting, while the
//! first pieces are read.
//!
//! While it starts MPI adds variables to the environment, and the C library does not guard readers against that. So whoever starts it reads
//! before what is needed of the environment, and nothing else may read there until MPI has started ([`Ranks::wait_for_start`]).

use crate::core::error::ErrorKind;
use crate::core::{Error, Result};
use crate::graph::ranks::Ranks;
use crate::mpi_ranks::{self, MpiRanks};
use mpi::environment::Universe;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Mutex, PoisonError};
use std::thread::JoinHandle;

type MpiTask = Box<dyn FnOnce(&Result<(MpiRanks, Universe)>) + Send>;

/// The processes of a launcher, which tells each its number before MPI has started. MPI ends with it.
pub struct LaunchedRanks {
    rank: usize,
    count: usize,
    /// Sender of tasks to the thread of MPI, which runs one after the other; `None` at the end.
    tasks: Mutex<Option<Sender<MpiTask>>>,
    thread: Option<JoinHandle<()>>,
}

impl std::fmt::Debug for LaunchedRanks {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "rank {} of {}", self.rank, self.count)
    }
}

impl LaunchedRanks {
    /// Starts MPI for the process `rank` of `count`.
    ///
    /// # Errors
    /// - the system starts no further thread.
    pub fn start(rank: usize, count: usize) -> Result<LaunchedRanks> {
        let (tasks, received) = channel();
        let thread =
            std::thread::Builder::new().name("mpi".into()).spawn(move || run_tasks([rank, count], &received));
        let thread = thread.map_err(|error| Error::run("the thread of MPI does not start").got(error))?;
        Ok(LaunchedRanks { rank, count, tasks: Mutex::new(Some(tasks)), thread: Some(thread) })
    }

    /// Result of a call of MPI, on its thread, once MPI has started. Errors: MPI does not start; the call panics, which the thread survives,
    /// so that other processes can still be told.
    fn call<T: Send + 'static>(
        &self,
        call: impl FnOnce(&MpiRanks) -> Result<T> + Send + 'static,
    ) -> Result<T> {
        let (answer, answered) = channel();
        let on_thread = move |started: &Result<(MpiRanks, Universe)>| {
            let result = match started {
                Ok((ranks, _)) => {
                    let called = catch_unwind(AssertUnwindSafe(|| call(ranks)));
                    called.unwrap_or_else(|_| Err(Error::new(ErrorKind::Panic, "a call of MPI panicked")))
                }
                Err(error) => Err(error.clone()),
            };
            // Whoever called waits for it.
            _ = answer.send(result);
        };
        let tasks = self.tasks.lock().unwrap_or_else(PoisonError::into_inner);
        let is_sent = tasks.as_ref().is_some_and(|tasks| tasks.send(Box::new(on_thread)).is_ok());
        let ended = || Error::run("the thread of MPI has ended");
        if is_sent { answered.recv().map_err(|_| ended())? } else { Err(ended()) }
    }

    /// Name of this machine, once MPI has started; `None` where it does not.
    pub fn machine(&self) -> Option<String> {
        self.call(|_| mpi::environment::processor_name().map_err(|error| Error::run("no name").got(error)))
            .ok()
    }

    /// Ends all processes, once MPI has started; where it does not, returns.
    pub fn abort(&self, exit_code: u8) {
        _ = self.call::<()>(move |_| mpi_ranks::abort(exit_code));
    }
}

impl Drop for LaunchedRanks {
    fn drop(&mut self) {
        *self.tasks.lock().unwrap_or_else(PoisonError::into_inner) = None;
        if let Some(thread) = self.thread.take() {
            // A panic there was shown.
            _ = thread.join();
        }
    }
}

impl Ranks for LaunchedRanks {
    fn rank(&self) -> usize {
        self.rank
    }

    fn count(&self) -> usize {
        self.count
    }

    fn exchange(&self, to_each: Vec<Vec<u8>>) -> Result<Vec<Vec<u8>>> {
        self.call(move |ranks| ranks.exchange(to_each))
    }

    fn wait_for_start(&self) -> Result<()> {
        self.call(|_| Ok(()))
    }
}

/// Runs tasks until there are no more.
fn run_tasks(launched: [usize; 2], tasks: &Receiver<MpiTask>) {
    let started = started(launched);
    tasks.iter().for_each(|task| task(&started));
}

fn started(launched: [usize; 2]) -> Result<(MpiRanks, Universe)> {
    let (universe, _) = mpi::initialize_with_threading(mpi::Threading::Funneled)
        .ok_or_else(|| Error::run("MPI does not start: it was started before"))?;
    let ranks = MpiRanks::world();
    let found = [ranks.rank(), ranks.count()];
    if found == launched {
        return Ok((ranks, universe));
    }
    let error = Error::run("the launcher is of another MPI than the one that the program was built with");
    let said = |[rank, count]: [usize; 2]| format!("rank {rank} of {count}");
    let found = format!("{}, which MPI says is {}", said(launched), said(found));
    Err(error.got(found).expected("mpirun of the same MPI as mpicc when it was built, or --part for each"))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// MPI starts once in a process, so this is the only test that starts it. Without a launcher the process is one of one.
    #[test]
    fn a_call_that_panics_is_an_error_and_others_follow() {
        let ranks = LaunchedRanks::start(0, 1).unwrap();
        ranks.wait_for_start().unwrap();
        let failed = ranks.call::<()>(|_| panic!("a defect")).unwrap_err();
        assert_eq!(failed.kind, ErrorKind::Panic, "{failed}");
        assert!(ranks.machine().is_some_and(|name| !name.is_empty()));
        assert_eq!(ranks.exchange(vec![vec![3]]).unwrap(), [[3]]);
    }
}
