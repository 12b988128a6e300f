//! Processes that fail together: each message says first that its sender goes on, so that no process waits for one that has failed.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use voltet_core::error::ErrorKind;
use voltet_core::{Error, Result};
use voltet_graph::ranks::Ranks;

/// First byte of a message of a process that goes on, and of one that has failed.
const GOES_ON: u8 = 0;
const HAS_FAILED: u8 = 1;

/// Outcome of work, of which a panic is an error of that kind: other processes wait for it. Errors: those of the work.
pub fn caught<T>(work: impl FnOnce() -> Result<T>) -> Result<T> {
    let outcome = catch_unwind(AssertUnwindSafe(work));
    outcome.unwrap_or_else(|panic| Err(Error::new(ErrorKind::Panic, voltet::panic_message(panic.as_ref()))))
}

/// The processes of a simulation. Between [`Lockstep::agree`] and the next one all of them exchange equally often, or one fails.
#[derive(Debug)]
pub struct Lockstep {
    ranks: Arc<dyn Ranks>,
    /// True once another process has failed.
    is_broken: AtomicBool,
    /// Number of the process that failed, for errors.
    failed: Mutex<Option<usize>>,
}

impl Lockstep {
    /// Processes that exchange by `ranks`.
    pub fn new(ranks: Arc<dyn Ranks>) -> Lockstep {
        Lockstep { ranks, is_broken: AtomicBool::new(false), failed: Mutex::new(None) }
    }

    /// The outcome of work that all processes do, once all are done or one has failed. Errors: that of the work; another process failed.
    pub fn agree<T>(&self, outcome: Result<T>) -> Result<T> {
        self.agree_on(outcome, |_| String::new())
    }

    /// Like [`Lockstep::agree`], for work that has to come to the same on all processes. `lines`: what it comes to, in lines.
    /// Errors: as of [`Lockstep::agree`]; another process came to something else: the same error on all, with the first line that differs.
    pub fn agree_on<T>(&self, outcome: Result<T>, lines: impl Fn(&T) -> String) -> Result<T> {
        if self.count() == 1 {
            return outcome;
        }
        if self.is_broken.swap(false, Ordering::Relaxed) {
            return outcome.and(Err(self.other_failed()));
        }
        let message = match &outcome {
            Ok(value) => [&[GOES_ON], lines(value).as_bytes()].concat(),
            Err(_) => vec![HAS_FAILED],
        };
        let received = self.exchange_flags(vec![message; self.count()]);
        self.is_broken.store(false, Ordering::Relaxed);
        let (value, received) = (outcome?, received?);
        let Some(other) = received.iter().position(|message| *message != received[0]) else {
            return Ok(value);
        };
        let [first, second] = [0, other].map(|rank| String::from_utf8_lossy(&received[rank]));
        let mut both = (first.lines().map(Some).chain(std::iter::repeat(None)))
            .zip(second.lines().map(Some).chain(std::iter::repeat(None)));
        let (first, second) = both.find(|(a, b)| a != b || a.is_none()).unwrap_or_default();
        let [first, second] = [first, second].map(|line| line.unwrap_or("nothing more"));
        let error = Error::usage("the processes state different steps, pipelines or channels");
        Err(error.got(format!("rank 0: {first}; rank {other}: {second}")).expected("the same on all"))
    }

    fn other_failed(&self) -> Error {
        let failed = self.failed.lock().unwrap_or_else(PoisonError::into_inner).unwrap_or_default();
        Error::new(ErrorKind::OtherProcess, "another process failed")
            .got(format!("rank {failed} of {}, which says why", self.count()))
    }

    /// Exchanges messages that begin with a byte for what becomes of the sender; gives them without it.
    fn exchange_flags(&self, to_each: Vec<Vec<u8>>) -> Result<Vec<Vec<u8>>> {
        let mut received = self.ranks.exchange(to_each)?;
        let own = self.rank();
        let is_failure = |(rank, bytes): (usize, &Vec<u8>)| rank != own && bytes.first() != Some(&GOES_ON);
        if let Some(rank) = received.iter().enumerate().position(is_failure) {
            *self.failed.lock().unwrap_or_else(PoisonError::into_inner) = Some(rank);
            self.is_broken.store(true, Ordering::Relaxed);
            return Err(self.other_failed());
        }
        received.iter_mut().for_each(|bytes| {
            bytes.drain(..1);
        });
        Ok(received)
    }
}

impl Ranks for Lockstep {
    fn rank(&self) -> usize {
        self.ranks.rank()
    }

    fn count(&self) -> usize {
        self.ranks.count()
    }

    fn exchange(&self, to_each: Vec<Vec<u8>>) -> Result<Vec<Vec<u8>>> {
        if self.is_broken.load(Ordering::Relaxed) {
            return Err(self.other_failed());
        }
        let flagged = |bytes: Vec<u8>| [&[GOES_ON], &bytes[..]].concat();
        self.exchange_flags(to_each.into_iter().map(flagged).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_is_an_error_that_is_told_from_others() {
        let panic = caught(|| -> Result<()> { panic!("seven of {}", 6) }).unwrap_err();
        assert!(panic.kind == ErrorKind::Panic && panic.what.contains("seven of 6"), "{panic}");
        let failure = caught(|| -> Result<()> { Err(Error::run("this is a mistake of voltet itself")) });
        assert_eq!(failure.unwrap_err().kind, ErrorKind::Run);
    }
}
