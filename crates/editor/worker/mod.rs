//! The worker: one thread that owns a session and draws the picture at a node of a graph, apart from any window.
//!
//! It takes the newest request alone. A picture is drawn coarse at once (fewer pixels) and in full when nothing newer is
//! wanted; a newer request stops what is being drawn, but for two things that would only be lost (see [`superseding`]): a node
//! that the change does not touch, and the first picture while a hand moves. Nothing is written: a preview runs what feeds the
//! picture, and a node that writes feeds nothing. What else is asked (distribution, probe, section, share, estimate) waits until
//! no picture is wanted, and is given up for one.
//!
//! | file | what |
//! | --- | --- |
//! | `request`, `asked` | pictures that are wanted, and their graphs; what else is, and what is found |
//! | `work`, `superseding`, `coarse` | the thread; when a pass is stopped; how many pixels a coarse picture has |
//! | `following`, `states`, `pixels` | what is shown of it |
//! | `look_on` | nodes that look at what runs through the wires |
//! | `distribution`, `scales`, `series` | the volume over two quantities, their ranges and percentiles, those of all time steps |
//! | `probing`, `section` | the values on rays, and on a plane through the data |
//! | `share`, `estimate` | what a widget adds to the picture; how wrong it is |
//! | `previews` | small pictures of the other nodes that give one |

mod coarse;
mod distribution;
mod estimate;
mod following;
mod own_nodes;
mod pixels;
mod preview_observer;
mod previews;
mod probing;
mod queries;
mod request;
mod scales;
mod section;
mod series;
mod share;
mod shared;
mod states;
mod superseding;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod tests_superseding;
mod work;

pub use pixels::Pixels;
pub use preview_observer::{grouped, short};
pub use queries::{
    Distribution, DistributionQuery, PixelProbe, ProbeQuery, Section, SectionQuery, Share, ShareQuery,
};
pub use request::RenderRequest;
pub(crate) use request::size_of;
pub use scales::{DataScales, Spread};
pub use shared::RepaintCallback;
pub use states::{NodeState, NodeStatus, WorkerOutput};

use shared::{Shared, lock};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Condvar, Mutex};
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
        let registry = own_nodes::with_own(registry)?;
        let shared = Arc::new(Shared {
            wanted: Mutex::default(),
            changed: Condvar::new(),
            newest: AtomicU64::new(0),
            shown: Mutex::default(),
            wake,
        });
        let of_thread = shared.clone();
        let spawned = std::thread::Builder::new().name("worker".into()).spawn(move || {
            WorkerState::new(&of_thread, &registry).until_the_end();
        });
        let thread = spawned.map_err(|error| Error::run("no thread can be had to draw with").got(error))?;
        Ok(Worker { shared, thread: Some(thread) })
    }

    /// Asks for a picture, in place of any that was asked for before; gives the request's number.
    pub fn draw(&self, wanted: RenderRequest) -> u64 {
        let mut queue = lock(&self.shared.wanted);
        let number = self.shared.newest.fetch_add(1, Ordering::SeqCst) + 1;
        lock(&self.shared.shown).begin(number, &wanted);
        queue.picture = Some(wanted);
        drop(queue);
        self.shared.changed.notify_one();
        number
    }

    /// Asks for the distribution of the data, made when no picture is wanted.
    pub fn find_distribution(&self, wanted: DistributionQuery) {
        lock(&self.shared.wanted).distribution = Some(wanted);
        self.shared.changed.notify_one();
    }

    /// Asks what lies at a place of the picture, in place of any that was asked for before.
    pub fn probe(&self, wanted: ProbeQuery) {
        lock(&self.shared.wanted).probing = Some(wanted);
        self.shared.changed.notify_one();
    }

    /// Asks how wrong a picture is; `key` tells it from others.
    pub fn estimate(&self, wanted: RenderRequest, key: u64) {
        lock(&self.shared.wanted).estimate = Some((key, wanted));
        self.shared.changed.notify_one();
    }

    /// Asks what a plane through the data meets, in place of any that was asked for before.
    pub fn cut(&self, wanted: SectionQuery) {
        lock(&self.shared.wanted).section = Some(wanted);
        self.shared.changed.notify_one();
    }

    /// Asks for a small picture of a node, made when nothing else is wanted.
    pub fn preview(&self, wanted: RenderRequest) {
        lock(&self.shared.wanted).previews.insert(wanted.node.clone(), wanted);
        self.shared.changed.notify_one();
    }

    /// Drops all small pictures, as of another document.
    pub fn forget_previews(&self) {
        lock(&self.shared.wanted).previews.clear();
        lock(&self.shared.shown).previews.clear();
    }

    /// Asks what a widget adds to a picture.
    pub fn share(&self, wanted: ShareQuery) {
        lock(&self.shared.wanted).share = Some(wanted);
        self.shared.changed.notify_one();
    }

    /// Calls a function with the worker's output.
    pub fn shown<T>(&self, look: impl FnOnce(&WorkerOutput) -> T) -> T {
        look(&lock(&self.shared.shown))
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        lock(&self.shared.wanted).ends = true;
        self.shared.newest.fetch_add(1, Ordering::SeqCst);
        self.shared.changed.notify_one();
        if let Some(thread) = self.thread.take() {
            // A panic of the thread was shown when it happened.
            let _ = thread.join();
        }
    }
}
