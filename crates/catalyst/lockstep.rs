//! Processes that fail together: each message says first that its sender goes on, so that no process waits for one that has failed.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use voltet_core::{Error, Result};
use voltet_graph::ranks::Ranks;

/// First byte of a message of a process that goes on, and of one that has failed.
const GOES_ON: u8 = 0;
const HAS_FAILED: u8 = 1;

/// Begin of the errors for the failure of another process.
const OTHER_FAILED: &str = "another process failed";

/// True if an error is that of another process, which shows it.
pub fn is_of_other(error: &Error) -> bool {
    error.what == OTHER_FAILED
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

    /// The outcome of work that all processes do, once all are done or one has failed.
    ///
    /// # Errors
    /// - that of the work;
    /// - another process failed.
    pub fn agree<T>(&self, outcome: Result<T>) -> Result<T> {
        if self.count() == 1 {
            return outcome;
        }
        if self.is_broken.swap(false, Ordering::Relaxed) {
            return outcome.and(Err(self.other_failed()));
        }
        let byte = if outcome.is_ok() { GOES_ON } else { HAS_FAILED };
        let others = self.exchange_flags(vec![vec![byte]; self.count()]);
        self.is_broken.store(false, Ordering::Relaxed);
        outcome.and_then(|value| others.map(|_| value))
    }

    fn other_failed(&self) -> Error {
        let failed = self.failed.lock().unwrap_or_else(PoisonError::into_inner).unwrap_or_default();
        Error::run(OTHER_FAILED).got(format!("rank {failed} of {}, which says why", self.count()))
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
