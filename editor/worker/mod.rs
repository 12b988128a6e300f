//! The worker: one thread that owns a session and draws the picture at a node of a graph, apart from any window.
//!
//! It takes the newest request alone. A picture is drawn coarse at once (fewer pixels) and in full when nothing newer is
//! wanted; a newer request stops a full picture that is being drawn. A coarse one is let run to its end, else a steady drag
//! would never show any; what is not done within [`PATIENCE`] is stopped all the same. Nothing is written: a preview runs what
//! feeds the picture, and a node that writes feeds nothing.

mod coarse;
mod estimate;
mod following;
mod look_on;
mod pixels;
mod probing;
mod request;
mod shared;
mod states;
#[cfg(test)]
mod tests;

pub use look_on::short;
pub use pixels::Pixels;
pub use probing::{Probed, Probing};
pub(crate) use request::size_of;
pub use request::{Distribution, Wanted};
pub use shared::Wake;
pub use states::{NodeState, NodeStatus, Shown};

use coarse::Pace;
use following::Following;
use look_on::Values;
use shared::{Shared, lock};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};
use voltet_core::error::ErrorKind;
use voltet_core::graph::{Demand, Graph, Registry, RunReport, Session, Unobserved, Value};
use voltet_core::{Error, Result};

/// How long a coarse picture that is no longer wanted may still take.
const PATIENCE: Duration = Duration::from_millis(200);

/// The handle of the thread; dropped, it stops what runs and waits for its end.
pub struct Worker {
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
}

impl Worker {
    /// Begins the thread. `registry`: the node types and filters that graphs may name.
    pub fn start(registry: &Registry, wake: Wake) -> Result<Worker> {
        let registry = look_on::with_own(registry)?;
        let shared = Arc::new(Shared {
            wanted: Mutex::default(),
            changed: Condvar::new(),
            newest: AtomicU64::new(0),
            shown: Mutex::default(),
            wake,
        });
        let of_thread = shared.clone();
        let spawned = std::thread::Builder::new().name("worker".into()).spawn(move || {
            let session = voltet_nodes::session();
            Work { shared: &of_thread, registry: &registry, session, pace: Pace::default() }.until_the_end();
        });
        let thread = spawned.map_err(|error| Error::run("no thread can be had to draw with").found(error))?;
        Ok(Worker { shared, thread: Some(thread) })
    }

    /// Asks for a picture, in place of any that was asked for before; gives the request's number.
    pub fn draw(&self, wanted: Wanted) -> u64 {
        let mut queue = lock(&self.shared.wanted);
        let number = self.shared.newest.fetch_add(1, Ordering::SeqCst) + 1;
        lock(&self.shared.shown).begin(number, &wanted);
        queue.picture = Some(wanted);
        drop(queue);
        self.shared.changed.notify_one();
        number
    }

    /// Asks for the distribution of the data, made when no picture is wanted.
    pub fn find_distribution(&self, wanted: Distribution) {
        lock(&self.shared.wanted).distribution = Some(wanted);
        self.shared.changed.notify_one();
    }

    /// Asks what lies at a place of the picture, in place of any that was asked for before.
    pub fn probe(&self, wanted: Probing) {
        lock(&self.shared.wanted).probing = Some(wanted);
        self.shared.changed.notify_one();
    }

    /// Asks how wrong a picture is; `key` tells it from others.
    pub fn estimate(&self, wanted: Wanted, key: u64) {
        lock(&self.shared.wanted).estimate = Some((key, wanted));
        self.shared.changed.notify_one();
    }

    /// What there is to show.
    pub fn shown<T>(&self, look: impl FnOnce(&Shown) -> T) -> T {
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

enum Task {
    Picture(u64, Wanted),
    Distribution(Distribution),
    Probing(Probing),
    Estimate(u64, Wanted),
}

/// The thread's own.
struct Work<'a> {
    shared: &'a Shared,
    registry: &'a Registry,
    session: Session,
    pace: Pace,
}

impl Work<'_> {
    fn until_the_end(&mut self) {
        while let Some(task) = self.next() {
            match task {
                Task::Picture(number, wanted) => self.picture(number, &wanted),
                Task::Distribution(wanted) => self.distribution(wanted),
                Task::Probing(wanted) => self.probe(&wanted),
                Task::Estimate(key, wanted) => self.estimate(key, &wanted),
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
                return Some(Task::Probing(wanted));
            }
            if let Some((key, wanted)) = queue.estimate.take() {
                return Some(Task::Estimate(key, wanted));
            }
            if let Some(wanted) = queue.distribution.take() {
                return Some(Task::Distribution(wanted));
            }
            queue = self.shared.changed.wait(queue).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Draws what is wanted, coarse first where the full picture takes longer than a person waits for.
    fn picture(&mut self, number: u64, wanted: &Wanted) {
        let newest = || self.shared.newest.load(Ordering::SeqCst);
        let coarse = if wanted.coarse_first { self.pace.divisor(wanted.pixels()) } else { 1 };
        if coarse > 1 {
            let deadline = Instant::now() + PATIENCE;
            let outcome =
                self.pass(number, wanted, coarse, &|| newest() != number && Instant::now() > deadline);
            if !self.keep(number, outcome) || newest() != number {
                return;
            }
        }
        let outcome = self.pass(number, wanted, 1, &|| newest() != number);
        if self.keep(number, outcome) {
            self.shared.show(|shown| shown.settled(number));
        }
    }

    /// Shows the error of a pass, if it has one; whether it has none.
    fn keep(&self, number: u64, outcome: Result<()>) -> bool {
        match outcome {
            Ok(()) => true,
            Err(error) => {
                self.shared.show(|shown| shown.failed(number, error));
                false
            }
        }
    }

    /// One run, with so many pixels less along each side.
    fn pass(
        &mut self,
        number: u64,
        wanted: &Wanted,
        divisor: u32,
        cancelled: &(dyn Fn() -> bool + Sync),
    ) -> Result<()> {
        let start = Instant::now();
        let graph = wanted.graph(self.registry, divisor)?;
        let following = Following::new(self.shared, cancelled);
        let report = self.guarded(&following, |session| session.run(&graph, &following))?;
        let seconds = start.elapsed().as_secs_f64();
        let drew_alone = report.nodes.iter().all(|node| node.reused || wanted.is_cheap(&node.name));
        let picture = report.pictures.iter().rev().find(|(node, _)| *node == wanted.node);
        let Some((_, picture)) = picture else {
            return Err(Error::run("the node gives no picture").at_node(&wanted.node));
        };
        let pixels = Pixels::of(picture.clone(), wanted.background, divisor, number);
        if drew_alone {
            self.pace.learn(divisor, pixels.count(), seconds);
        }
        let values = if divisor == 1 { self.values(&graph) } else { Values::default() };
        self.shared.show(|shown| shown.finished(pixels, &report, values, seconds));
        Ok(())
    }

    /// What runs through the wires, in words; the session has all of it.
    fn values(&mut self, graph: &Graph) -> Values {
        let Some(place) = graph.nodes.iter().position(|node| node.node.name == look_on::NAME) else {
            return Values::default();
        };
        let fed = self.session.feed(graph, place, &Demand::default(), &Unobserved);
        let Ok((values, _)) = fed else { return Values::default() };
        look_on::seen(graph, place, &values)
    }

    /// Runs something of the session; a panic is the error of the node that ran, and costs the session's memory.
    fn guarded<T>(
        &mut self,
        following: &Following,
        work: impl FnOnce(&mut Session) -> Result<T>,
    ) -> Result<T> {
        let session = &mut self.session;
        catch_unwind(AssertUnwindSafe(|| work(session))).unwrap_or_else(|payload| {
            self.session = voltet_nodes::session();
            let text = payload.downcast_ref::<&str>().map(|text| (*text).to_string());
            let text = text.or_else(|| payload.downcast_ref::<String>().cloned()).unwrap_or_default();
            let error = Error::run("the node ended by a mistake of its own").found(text);
            Err(following.node().into_iter().fold(error, |error, node| error.at_node(node)))
        })
    }

    /// The distribution over (s, g); given up for a picture, and begun again after it.
    fn distribution(&mut self, wanted: Distribution) {
        let before = self.shared.newest.load(Ordering::SeqCst);
        let stop = || self.shared.newest.load(Ordering::SeqCst) != before;
        let outcome = self.found(&wanted, &stop);
        match outcome {
            Err(error) if error.kind == ErrorKind::Cancelled => {
                let mut queue = lock(&self.shared.wanted);
                queue.distribution.get_or_insert(wanted);
            }
            outcome => self.shared.show(|shown| shown.distribution = Some((wanted.key, outcome))),
        }
    }

    /// How wrong a picture is; given up for a newer picture.
    fn estimate(&mut self, key: u64, wanted: &Wanted) {
        let before = self.shared.newest.load(Ordering::SeqCst);
        let stop = || self.shared.newest.load(Ordering::SeqCst) != before;
        let following = Following::silent(self.shared, &stop);
        let found = estimate::graphs(wanted, self.registry).and_then(|graphs| {
            let mut pictures = Vec::new();
            for graph in &graphs {
                let report = self.guarded(&following, |session| session.run(graph, &following))?;
                let picture = report.pictures.iter().rev().find(|(node, _)| *node == wanted.node);
                let picture =
                    picture.ok_or_else(|| Error::run("the node gives no picture").at_node(&wanted.node))?;
                pictures.push(picture.1.clone());
            }
            Ok(estimate::difference(&pictures[0], &pictures[1]))
        });
        self.shared.show(|shown| shown.estimate = Some((key, found)));
    }

    /// What lies at a place of the picture; given up for a newer picture, in which it lies elsewhere.
    fn probe(&mut self, wanted: &Probing) {
        let before = self.shared.newest.load(Ordering::SeqCst);
        let stop = || self.shared.newest.load(Ordering::SeqCst) != before;
        let following = Following::silent(self.shared, &stop);
        let found = wanted.graph(self.registry).and_then(|(graph, place)| {
            let demand = Demand::default();
            let fed = self.guarded(&following, |session| session.feed(&graph, place, &demand, &following));
            wanted.walk(&fed?.0, &following).map(Arc::new)
        });
        match found {
            Err(error) if error.kind == ErrorKind::Cancelled => {}
            found => self.shared.show(|shown| shown.probed = Some((wanted.key, found))),
        }
    }

    fn found(
        &mut self,
        wanted: &Distribution,
        stop: &(dyn Fn() -> bool + Sync),
    ) -> Result<Arc<voltet_core::probing::Histogram>> {
        let (graph, place) = wanted.graph(self.registry)?;
        let following = Following::silent(self.shared, stop);
        let (values, _): (Vec<Value>, RunReport) =
            self.guarded(&following, |session| session.feed(&graph, place, &Demand::default(), &following))?;
        let volume = values.first().and_then(Value::volume);
        let volume = volume.ok_or_else(|| Error::run("the node gives no volume").at_node(&wanted.node))??;
        request::histogram_of(&volume, &following).map(Arc::new)
    }
}
