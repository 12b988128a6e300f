//! The worker: one thread that owns a session and draws the picture at a node of a graph, apart from any window.
//!
//! It takes the newest request alone. A picture is drawn coarse at once (fewer pixels) and in full when nothing newer is
//! wanted; a newer request stops what is being drawn, but for two things that would only be lost (see [`superseding`]): a node
//! that the change does not touch, and the first picture while a hand moves. Nothing is written: a preview runs what feeds the
//! picture, and a node that writes feeds nothing. Each [`query`](query::Query) waits until no picture is wanted, and is given up for one.
//!
//! | file | responsibility |
//! | --- | --- |
//! | `request` | pictures that are wanted, and their graphs |
//! | `query`, `output` | questions beside pictures and their newest answers; all that is shown of the work |
//! | `shared`, `work` | state of both threads; the thread |
//! | `superseding`, `coarse` | when a pass is stopped; how many pixels a coarse picture has |
//! | `values` | a node that takes what runs through the wires, and words for it |
//! | `pixels` | a picture as a screen shows it |
//! | `distribution` | the volume over two quantities, their ranges and percentiles, those of all time steps |
//! | `probing`, `section` | the values on rays, and on a plane through the data |
//! | `comparison` | other pictures: what a widget adds, how wrong one is, small ones of other nodes |

mod coarse;
mod comparison;
mod distribution;
mod output;
mod pixels;
mod probing;
mod query;
mod request;
mod section;
mod shared;
mod superseding;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod tests_superseding;
mod values;
mod work;

pub(crate) use comparison::{Estimate, PreviewQuery, Share, ShareQuery};
#[cfg(test)]
pub(crate) use distribution::Spread;
pub(crate) use distribution::{DataScales, Distribution, DistributionQuery};
pub use output::WorkerOutput;
pub(crate) use output::{NodeState, NodeStatus, Preview};
pub use pixels::Pixels;
pub(crate) use probing::{PixelProbe, ProbeQuery};
pub use request::RenderRequest;
pub(crate) use request::{VolumeSource, size_of};
pub(crate) use section::{Section, SectionQuery};
pub use shared::RepaintCallback;
pub(crate) use values::{grouped, short};

use query::{Exchange, Query};
use shared::{Shared, lock};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::thread::JoinHandle;
use voltet_core::{Error, Result};
use voltet_graph::Registry;
use work::WorkerState;

/// The handle of the thread; dropped, it stops what runs and waits for its end.
pub struct Worker {
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
}

impl Worker {
    /// Begins the thread. `registry`: the node types and filters that graphs may name.
    pub fn start(registry: &Registry, wake: RepaintCallback) -> Result<Worker> {
        let mut registry = registry.clone();
        registry.add(&values::NODE)?;
        registry.add(&distribution::SERIES)?;
        let shared = Arc::new(Shared::new(wake));
        let of_thread = shared.clone();
        let work = move || WorkerState::new(&of_thread, &registry).until_the_end();
        let spawned = std::thread::Builder::new().name("worker".into()).spawn(work);
        let thread = spawned.map_err(|error| Error::run("no thread can be had to draw with").got(error))?;
        Ok(Worker { shared, thread: Some(thread) })
    }

    /// Asks for a picture, in place of any that was asked for before; gives the request's number.
    pub fn draw(&self, wanted: RenderRequest) -> u64 {
        let mut state = lock(&self.shared.state);
        let number = self.shared.newest.fetch_add(1, Ordering::SeqCst) + 1;
        state.output.begin(number, &wanted);
        state.picture = Some(wanted);
        drop(state);
        self.shared.changed.notify_one();
        number
    }

    /// Asks something beside pictures, unless it was asked last; `of`: the place of such queries.
    pub(crate) fn ask<Q: Query>(&self, of: impl FnOnce(&mut WorkerOutput) -> &mut Exchange<Q>, query: Q) {
        of(&mut lock(&self.shared.state).output).ask(query);
        self.shared.changed.notify_one();
    }

    /// Forgets which queries about the data were asked, so that they can be asked again; their answers stay.
    pub(crate) fn forget_queries(&self) {
        let output = &mut lock(&self.shared.state).output;
        output.distribution.forget_query();
        output.section.forget_query();
        output.previews.values_mut().for_each(Exchange::forget_query);
    }

    /// Drops all small pictures, as of another document.
    pub(crate) fn forget_previews(&self) {
        lock(&self.shared.state).output.previews.clear();
    }

    /// Calls a function with the worker's output.
    pub fn shown<T>(&self, look: impl FnOnce(&WorkerOutput) -> T) -> T {
        look(&lock(&self.shared.state).output)
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        lock(&self.shared.state).ends = true;
        self.shared.newest.fetch_add(1, Ordering::SeqCst);
        self.shared.changed.notify_one();
        if let Some(thread) = self.thread.take() {
            // A panic of the thread was shown when it happened.
            let _ = thread.join();
        }
    }
}
