//! Queries to the worker beside pictures: of each kind the newest query and the newest answer.

use voltet_core::Result;
use voltet_core::error::ErrorKind;
use voltet_graph::{Observer, Registry, Session};

/// A question that is answered while no picture is wanted.
pub(crate) trait Query: Clone + PartialEq + 'static {
    type Reply;

    /// True if it is asked again after the picture that it was given up for.
    const WAITS: bool;

    /// The answer, found on the worker's thread. Errors: a newer picture is wanted; those of a run.
    fn answer(&self, run: &mut QueryRun) -> Result<Self::Reply>;
}

/// Means to answer a query.
pub(crate) struct QueryRun<'a> {
    pub session: &'a mut Session,
    pub registry: &'a Registry,
    /// Reports that a newer picture is wanted.
    pub observer: &'a dyn Observer,
}

/// The newest query of a kind, and the newest answer.
pub(crate) struct Exchange<Q: Query> {
    asked: Option<Q>,
    /// Number of the newest query.
    number: u64,
    is_open: bool,
    answer: Option<(u64, Result<Q::Reply>)>,
}

impl<Q: Query> Default for Exchange<Q> {
    fn default() -> Self {
        Exchange { asked: None, number: 0, is_open: false, answer: None }
    }
}

impl<Q: Query> Exchange<Q> {
    /// The newest query.
    pub fn asked(&self) -> Option<&Q> {
        self.asked.as_ref()
    }

    /// The answer to the newest query.
    pub fn answer(&self) -> Option<&Result<Q::Reply>> {
        self.answer.as_ref().filter(|(number, _)| *number == self.number).map(|(_, found)| found)
    }

    /// The newest answer, whatever was asked since.
    pub fn last(&self) -> Option<&Result<Q::Reply>> {
        self.answer.as_ref().map(|(_, found)| found)
    }

    /// True if an answer is to come.
    pub fn is_waiting(&self) -> bool {
        self.asked.is_some() && self.answer().is_none()
    }

    pub(super) fn ask(&mut self, query: Q) {
        if self.asked.as_ref() != Some(&query) {
            self.asked = Some(query);
            self.number += 1;
            self.is_open = true;
        }
    }

    /// As if nothing had been asked; the answer stays.
    pub(super) fn forget_query(&mut self) {
        (self.asked, self.is_open) = (None, false);
    }

    /// Takes over what was found for the query of a number.
    pub(super) fn settle(&mut self, number: u64, found: Result<Q::Reply>) {
        match found {
            Err(error) if error.kind == ErrorKind::Cancelled => match Q::WAITS {
                true => self.is_open = self.asked.is_some(),
                false if number == self.number => self.forget_query(),
                false => {}
            },
            found => self.answer = Some((number, found)),
        }
    }

    /// The query to be answered next, with its number, if it is open.
    pub(super) fn take(&mut self) -> Option<(u64, Q)> {
        let query = self.asked.clone().filter(|_| std::mem::take(&mut self.is_open))?;
        Some((self.number, query))
    }
}
