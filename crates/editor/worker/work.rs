//! The thread's own work: the newest wish first, panics caught.

use super::coarse::FrameTimeModel;
use super::following::Following;
use super::pixels::Pixels;
use super::preview_observer::{self, Values};
use super::queries::{DistributionQuery, ProbeQuery, SectionQuery, ShareQuery};
use super::request::RenderRequest;
use super::shared::{Shared, lock};
use super::superseding::Pass;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::Ordering;
use std::sync::{Arc, PoisonError};
use std::time::{Duration, Instant};
use voltet_core::error::ErrorKind;
use voltet_core::picture::Picture;
use voltet_core::{Error, Result};
use voltet_graph::{Demand, Graph, NoObserver, Registry, RunReport, Session};

enum Task {
    Picture(u64, RenderRequest),
    ProbeQuery(ProbeQuery),
    Section(SectionQuery),
    Estimate(u64, RenderRequest),
    DistributionQuery(DistributionQuery),
    Share(ShareQuery),
    Preview(RenderRequest),
}

/// The thread's own.
pub(super) struct WorkerState<'a> {
    pub shared: &'a Shared,
    pub registry: &'a Registry,
    session: Session,
    pace: FrameTimeModel,
}

/// One whose widgets a hand moves.
fn session() -> Session {
    voltet_nodes::session().widgets_move()
}

impl<'a> WorkerState<'a> {
    pub fn new(shared: &'a Shared, registry: &'a Registry) -> Self {
        WorkerState { shared, registry, session: session(), pace: FrameTimeModel::default() }
    }

    pub fn until_the_end(&mut self) {
        while let Some(task) = self.next() {
            match task {
                Task::Picture(number, wanted) => self.picture(number, &wanted),
                Task::ProbeQuery(wanted) => self.probe(&wanted),
                Task::Section(wanted) => self.section(wanted),
                Task::Estimate(key, wanted) => self.estimate(key, &wanted),
                Task::DistributionQuery(wanted) => self.distribution(wanted),
                Task::Share(wanted) => self.share(&wanted),
                Task::Preview(wanted) => self.preview(wanted),
            }
        }
    }

    fn next(&self) -> Option<Task> {
        let mut queue = lock(&self.shared.wanted);
        loop {
            if queue.ends {
                return None;
            }
            if let Some(wanted) = queue.picture.take() {
                return Some(Task::Picture(self.shared.newest.load(Ordering::SeqCst), wanted));
            }
            if let Some(wanted) = queue.probing.take() {
                return Some(Task::ProbeQuery(wanted));
            }
            if let Some(wanted) = queue.section.take() {
                return Some(Task::Section(wanted));
            }
            if let Some((key, wanted)) = queue.estimate.take() {
                return Some(Task::Estimate(key, wanted));
            }
            if let Some(wanted) = queue.distribution.take() {
                return Some(Task::DistributionQuery(wanted));
            }
            if let Some(wanted) = queue.share.take() {
                return Some(Task::Share(wanted));
            }
            if let Some((_, wanted)) = queue.previews.pop_first() {
                return Some(Task::Preview(wanted));
            }
            queue = self.shared.changed.wait(queue).unwrap_or_else(PoisonError::into_inner);
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
            if self.shared.newest.load(Ordering::SeqCst) != number {
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
    /// a passing one. Whether its picture is the full one.
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
        let following = Following::new(self.shared, &stop);
        let report = self.guarded(&following, |session| match patience {
            Some(_) => session.run_preview(&graph, &following),
            None => session.run(&graph, &following),
        })?;
        let seconds = start.elapsed().as_secs_f64();
        let drew_alone = report.nodes.iter().all(|node| node.reused || wanted.is_cheap(&node.name));
        let drawn = Pixels::new(picture_of(&report, wanted)?, wanted.background, divisor, number);
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
        let values = if is_full { self.values(&graph) } else { Values::default() };
        self.shared.show(|shown| shown.finished(pixels, &report, values, seconds));
        Ok(is_full)
    }

    /// Descriptions of the values on the wires, from the session's cache.
    fn values(&mut self, graph: &Graph) -> Values {
        let Some(place) = graph.nodes.iter().position(|node| node.node.name == preview_observer::NAME) else {
            return Values::default();
        };
        let fed = self.session.feed(graph, place, &Demand::default(), &NoObserver);
        let Ok((values, _)) = fed else { return Values::default() };
        preview_observer::seen(graph, place, &values)
    }

    /// Works with the session; a panic is the error of the node that ran, and costs the session's memory.
    pub fn guarded<T>(
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

    /// Works with the session at something beside pictures; `None` where it was given up for a newer one.
    pub fn aside<T>(
        &mut self,
        work: impl FnOnce(&mut Session, &Following) -> Result<T>,
    ) -> Option<Result<T>> {
        let shared = self.shared;
        let before = shared.newest.load(Ordering::SeqCst);
        let stop = |_: &dyn Fn() -> Option<String>| shared.newest.load(Ordering::SeqCst) != before;
        let following = Following::silent(shared, &stop);
        match self.guarded(&following, |session| work(session, &following)) {
            Err(error) if error.kind == ErrorKind::Cancelled => None,
            found => Some(found),
        }
    }
}

/// The picture that was wanted of a run.
pub(super) fn picture_of(report: &RunReport, wanted: &RenderRequest) -> Result<Arc<Picture>> {
    let picture = report.pictures.iter().rev().find(|(node, _)| *node == wanted.node);
    let none = || Error::run("the node gives no picture").at_node(&wanted.node);
    picture.map(|(_, picture)| picture.clone()).ok_or_else(none)
}
