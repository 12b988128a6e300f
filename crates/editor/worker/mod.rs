//! The worker: one thread that owns a session and draws the picture at a node of a graph, apart from any window.
//!
//! It takes the newest request alone. A picture is drawn coarse at once (fewer pixels) and in full when nothing newer is
//! wanted; a newer request stops what is being drawn, but for two things that would only be lost (see `work::Pass`): a node
//! that the change does not touch, and the first picture while a hand moves. Nothing is written: a preview runs what feeds the
//! picture, and a node that writes feeds nothing. Each query waits until no picture is wanted, and is given up for one.

mod comparison;
mod crowding;
mod distribution;
mod frame_times;
mod hits;
mod output;
mod probing;
mod query;
mod request;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod tests_superseding;
mod work;

use crate::threads;
pub(crate) use comparison::{Estimate, PreviewQuery, Share, ShareQuery, difference};
#[cfg(test)]
pub(crate) use distribution::Spread;
pub(crate) use distribution::{DataScales, Distribution, DistributionQuery, HISTOGRAM};
pub(crate) use hits::{Hit, HitCell};
pub use output::WorkerOutput;
pub(crate) use output::{NodeState, NodeStatus, Preview};
pub(crate) use probing::{PixelProbe, ProbeQuery, Section, SectionQuery};
use query::{Exchange, Query};
pub use request::{Pixels, RenderRequest};
pub(crate) use request::{
    VolumeSource, retain_widgets, short, short_by, size_of, widget_count, without_zeros,
};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::thread::JoinHandle;
use voltet_core::{Error, Result};
use voltet_graph::Registry;
pub(crate) use work::BETWEEN;
pub use work::RepaintCallback;
use work::{Shared, lock};

/// The handle of the thread; dropped, it stops what runs and waits for its end.
pub struct Worker {
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
}

impl Worker {
    /// Begins the thread. `registry`: the node types and filters that graphs may name.
    pub fn start(registry: &Registry, wake: RepaintCallback) -> Result<Worker> {
        let shared = Arc::new(Shared::new(with_wires(registry)?, wake));
        let of_thread = shared.clone();
        let work = move || work::run(&of_thread);
        let spawned = threads::begin("worker", work);
        let thread = spawned.map_err(|error| Error::run("no thread can be started to draw").got(error))?;
        Ok(Worker { shared, thread: Some(thread) })
    }

    /// Has what is asked from now on name these node types and filters. Errors: they contradict the worker's own.
    pub(crate) fn use_registry(&self, registry: &Registry) -> Result<()> {
        lock(&self.shared.state).registry = with_wires(registry)?;
        Ok(())
    }

    /// Asks for a picture, in place of any that was asked for before; gives the request's number.
    pub fn draw(&self, wanted: RenderRequest) -> u64 {
        self.draw_and_read(wanted, None)
    }

    /// Asks for a picture as [`Worker::draw`] does; meanwhile, where memory is ample, the data are read of the one that will be
    /// asked for next.
    pub(crate) fn draw_and_read(&self, wanted: RenderRequest, next: Option<RenderRequest>) -> u64 {
        let mut state = lock(&self.shared.state);
        let number = self.shared.newest.fetch_add(1, Ordering::SeqCst) + 1;
        state.output.begin(number, &wanted);
        state.reads_ahead = next.is_some();
        (state.picture, state.next, state.has_news) = (Some(wanted), next, true);
        drop(state);
        self.shared.changed.notify_one();
        number
    }

    /// Ends the reading of data ahead, which what is asked next would wait for, and frees them.
    pub(crate) fn read_no_further(&self) {
        let mut state = lock(&self.shared.state);
        (state.reads_ahead, state.next) = (false, None);
    }

    /// Asks something beside pictures, unless it was asked last; `of`: the place of such queries.
    pub(crate) fn ask<Q: Query>(&self, of: impl FnOnce(&mut WorkerOutput) -> &mut Exchange<Q>, query: Q) {
        let mut state = lock(&self.shared.state);
        of(&mut state.output).ask(query);
        state.has_news = true;
        drop(state);
        self.shared.changed.notify_one();
    }

    /// Asks for what is seen at a place, unless a probe of the same tells it.
    pub(crate) fn ask_hover(&self, query: ProbeQuery) {
        let mut state = lock(&self.shared.state);
        let WorkerOutput { probe, hover, .. } = &mut state.output;
        if probe.asked() != Some(&query) {
            drop(state);
            return self.ask(|output| &mut output.hover, query);
        }
        match probe.answer().cloned() {
            Some(_) if hover.asked() == Some(&query) && hover.answer().is_some() => {}
            Some(found) => hover.adopt(query, found),
            None => hover.forget(),
        }
    }

    /// Forgets which queries about the data were asked, so that they can be asked again; their answers stay.
    pub(crate) fn forget_queries(&self) {
        let output = &mut lock(&self.shared.state).output;
        output.distribution.forget_query();
        output.section.forget_query();
        output.previews.values_mut().for_each(Exchange::forget_query);
    }

    /// Forgets all output and stops what is being drawn, as of another document.
    pub(crate) fn forget(&self) {
        let mut state = lock(&self.shared.state);
        let first = self.shared.newest.fetch_add(1, Ordering::SeqCst) + 1;
        (state.picture, state.next, state.output) = (None, None, WorkerOutput::from(first));
    }

    /// Forgets a query and its answer; `of`: the place of such queries.
    pub(crate) fn forget_query<Q: Query>(&self, of: impl FnOnce(&mut WorkerOutput) -> &mut Exchange<Q>) {
        of(&mut lock(&self.shared.state).output).forget();
    }

    /// Has the newest query of a kind fail.
    #[cfg(test)]
    pub(crate) fn fail<Q: Query>(
        &self,
        of: impl FnOnce(&mut WorkerOutput) -> &mut Exchange<Q>,
        error: Error,
    ) {
        let mut state = lock(&self.shared.state);
        let exchange = of(&mut state.output);
        let query = exchange.asked().cloned();
        query.into_iter().for_each(|query| exchange.adopt(query, Err(error.clone())));
    }

    /// Calls a function with the worker's output.
    pub fn shown<T>(&self, look: impl FnOnce(&WorkerOutput) -> T) -> T {
        look(&lock(&self.shared.state).output)
    }
}

/// The registry with the node by which the worker looks at the values of wires.
fn with_wires(registry: &Registry) -> Result<Arc<Registry>> {
    let mut registry = registry.clone();
    registry.add(&request::WIRES)?;
    Ok(Arc::new(registry))
}

impl Drop for Worker {
    fn drop(&mut self) {
        let mut state = lock(&self.shared.state);
        (state.ends, state.has_news) = (true, true);
        drop(state);
        self.shared.newest.fetch_add(1, Ordering::SeqCst);
        self.shared.changed.notify_one();
        if let Some(thread) = self.thread.take() {
            // A panic of the thread was shown when it happened.
            let _ = thread.join();
        }
    }
}
