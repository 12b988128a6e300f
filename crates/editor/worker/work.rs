//! The thread's own work: the newest wish first, panics caught.

use super::coarse::FrameTimeModel;
use super::output::PendingQuery;
use super::pixels::Pixels;
use super::query::QueryRun;
use super::request::RenderRequest;
use super::shared::{Following, Shared, lock};
use super::superseding::Pass;
use super::values;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::PoisonError;
use std::time::{Duration, Instant};
use voltet_core::{Error, Result};
use voltet_graph::{Registry, Session};

/// A session whose widgets a hand moves.
fn session() -> Session {
    voltet_nodes::session().widgets_move()
}

/// The thread's own state.
pub(super) struct WorkerState<'a> {
    shared: &'a Shared,
    registry: &'a Registry,
    session: Session,
    pace: FrameTimeModel,
}

impl<'a> WorkerState<'a> {
    pub fn new(shared: &'a Shared, registry: &'a Registry) -> Self {
        WorkerState { shared, registry, session: session(), pace: FrameTimeModel::default() }
    }

    /// Works at the newest request, and at queries where there is none.
    pub fn until_the_end(&mut self) {
        loop {
            let mut state = lock(&self.shared.state);
            if state.ends {
                return;
            }
            if let Some(wanted) = state.picture.take() {
                let number = self.shared.newest();
                drop(state);
                self.picture(number, &wanted);
            } else if let Some(job) = state.output.next_job() {
                drop(state);
                self.query(job);
            } else {
                drop(self.shared.changed.wait(state).unwrap_or_else(PoisonError::into_inner));
            }
        }
    }

    /// Draws what is wanted: coarse first where the full picture takes longer than a person waits for, and from what the engine kept of
    /// the view where it can; at last the picture that a run gives.
    fn picture(&mut self, number: u64, wanted: &RenderRequest) {
        self.pace.look_from(wanted.cameras());
        let mut is_full = false;
        // The first picture of a wish is for a hand that moves, whether it is coarse or quick enough to have all pixels.
        if wanted.coarse_first {
            let divisor = self.pace.divisor(wanted.pixels());
            let outcome = self.pass(number, wanted, divisor, Some(self.pace.patience(divisor)));
            match self.keep(number, outcome) {
                Some(found) => is_full = found,
                None => return,
            }
        }
        if !is_full {
            if self.shared.newest() != number {
                return;
            }
            let outcome = self.pass(number, wanted, 1, None);
            if self.keep(number, outcome).is_none() {
                return;
            }
        }
        self.shared.show(|shown| shown.settled(number));
    }

    /// Result of a pass; shows the error of one that failed.
    fn keep<T>(&self, number: u64, outcome: Result<T>) -> Option<T> {
        outcome.map_err(|error| self.shared.show(|shown| shown.failed(number, error))).ok()
    }

    /// One run, with so many pixels less along each side; `patience`: how long it goes on while a hand moves, for one that may be
    /// a passing one. Returns true if its picture is the full one.
    fn pass(
        &mut self,
        number: u64,
        wanted: &RenderRequest,
        divisor: u32,
        patience: Option<Duration>,
    ) -> Result<bool> {
        let start = Instant::now();
        let graph = wanted.graph(self.registry, divisor)?;
        let pass = Pass::new(self.shared, number, wanted, patience);
        let stop = |running: &dyn Fn() -> Option<String>| pass.stops(running);
        let following = Following::new(self.shared, &stop, true);
        let report = self.guarded(&following, |session| match patience {
            Some(_) => session.run_preview(&graph, &following),
            None => session.run(&graph, &following),
        })?;
        let seconds = start.elapsed().as_secs_f64();
        let drew_alone = report.nodes.iter().all(|node| node.reused || wanted.is_cheap(&node.name));
        let drawn = Pixels::new(wanted.picture_of(&report)?, wanted.background, divisor, number);
        let pixels = Pixels { is_passing: report.is_passing, ..drawn };
        match report.is_passing {
            _ if !drew_alone => {}
            true => self.pace.learn_of_kept(pixels.count(), seconds),
            false => self.pace.learn(divisor, pixels.count(), seconds),
        }
        if pass.is_stale() {
            return Err(Error::cancelled());
        }
        let is_full = pixels.is_full();
        let values = is_full.then(|| values::seen(&mut self.session, &graph)).flatten();
        self.shared.show(|shown| shown.finished(pixels, &report, values, seconds));
        Ok(is_full)
    }

    /// Works with the session; a panic is the error of the node that ran, and costs the session's memory.
    fn guarded<T>(
        &mut self,
        following: &Following,
        work: impl FnOnce(&mut Session) -> Result<T>,
    ) -> Result<T> {
        let known = &mut self.session;
        catch_unwind(AssertUnwindSafe(|| work(known))).unwrap_or_else(|payload| {
            self.session = session();
            let text = payload.downcast_ref::<&str>().map(|text| (*text).to_string());
            let text = text.or_else(|| payload.downcast_ref::<String>().cloned()).unwrap_or_default();
            let error = Error::run("the node ended by a mistake of its own").got(text);
            Err(following.node().into_iter().fold(error, |error, node| error.at_node(node)))
        })
    }

    /// Answers a query; it is given up for a newer picture.
    fn query(&mut self, mut job: Box<dyn PendingQuery>) {
        let (shared, registry) = (self.shared, self.registry);
        let before = shared.newest();
        let stop = |_: &dyn Fn() -> Option<String>| shared.newest() != before;
        let following = Following::new(shared, &stop, false);
        let outcome = self.guarded(&following, |session| {
            job.work(&mut QueryRun { session, registry, observer: &following })
        });
        shared.show(|output| job.settle(outcome, output));
    }
}
