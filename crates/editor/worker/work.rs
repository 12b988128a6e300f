//! The thread's own work: the newest request first, panics caught; the state that it shares with the window's thread; when a pass is
//! stopped for a newer request.

use super::crowding::Crowding;
use super::frame_times::FrameTimeModel;
use super::output::WorkerOutput;
use super::query::{Exchange, Query, QueryRun};
use super::request::{Change, Pixels, RenderRequest, wire_values};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};
use voltet_core::error::ErrorKind;
use voltet_core::{Error, Result};
use voltet_graph::{Observer, Registry, Session};
use voltet_io::memory;

/// A session whose widgets a hand moves.
fn session() -> Session {
    voltet_nodes::session().widgets_move()
}

struct WorkerState<'a> {
    shared: &'a Shared,
    registry: Arc<Registry>,
    session: Session,
    /// The session that read data ahead, which keeps them until they are drawn.
    ahead: Option<Session>,
    pace: FrameTimeModel,
    crowding: Crowding,
}

/// Works at the newest request, and at queries where there is none, until the worker ends.
pub(super) fn run(shared: &Shared) {
    let registry = lock(&shared.state).registry.clone();
    let (pace, crowding) = (FrameTimeModel::default(), Crowding::default());
    let mut own = WorkerState { shared, registry, session: session(), ahead: None, pace, crowding };
    loop {
        let mut state = lock(&shared.state);
        while !std::mem::take(&mut state.has_news) {
            state = shared.changed.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
        drop(state);
        while own.work() {}
        if lock(&shared.state).ends {
            return;
        }
    }
}

impl WorkerState<'_> {
    /// Draws the picture that is wanted, else answers a query: what a hand asks for first. False if there is nothing to do.
    fn work(&mut self) -> bool {
        let mut state = lock(&self.shared.state);
        if state.ends {
            return false;
        }
        self.registry = state.registry.clone();
        if let Some(wanted) = state.picture.take() {
            let (number, next) = (self.shared.newest(), state.next.take());
            drop(state);
            self.picture_and_data(number, &wanted, next.as_ref());
            return true;
        }
        let previews: Vec<String> = state.output.previews.keys().cloned().collect();
        let newest = self.shared.newest();
        drop(state);
        self.query(newest, |output| &mut output.probe)
            || self.query(newest, |output| &mut output.section)
            || self.query(newest, |output| &mut output.estimate)
            || self.query(newest, |output| &mut output.distribution)
            || self.query(newest, |output| &mut output.share)
            || previews.iter().any(|node| self.query(newest, |output| output.preview(node)))
            || self.query(newest, |output| &mut output.hover)
    }

    /// Draws what is wanted, and reads the data of the next picture meanwhile.
    fn picture_and_data(&mut self, number: u64, wanted: &RenderRequest, next: Option<&RenderRequest>) {
        let Some(next) = next.filter(|_| memory::has_room_ahead()) else {
            self.ahead = None;
            return self.picture(number, wanted);
        };
        let (shared, registry, mut session) = (self.shared, self.registry.clone(), self.session.beside());
        std::thread::scope(|scope| {
            scope.spawn(|| read_ahead(shared, &registry, &mut session, next));
            self.picture(number, wanted);
        });
        self.ahead = Some(session).filter(|_| lock(&shared.state).reads_ahead);
    }

    /// Draws what is wanted: coarse first where the full picture takes longer than a person waits for, and from what the engine kept of
    /// the view where it can; at last the picture that a run gives.
    fn picture(&mut self, number: u64, wanted: &RenderRequest) {
        self.pace.look_from(wanted.cameras());
        let outcome = match self.first_picture(number, wanted) {
            // What is newer comes before the full picture.
            Ok(false) if self.shared.newest() != number => return,
            Ok(false) => self.pass(number, wanted, 1, None),
            first => first,
        };
        self.shared.show(|shown| match outcome {
            Ok(_) => shown.settled(number),
            Err(error) => shown.failed(number, error),
        });
    }

    /// Draws the first picture of a request: for a hand that moves, whether it is coarse or quick enough to have all pixels. Returns true if it
    /// is the full one.
    fn first_picture(&mut self, number: u64, wanted: &RenderRequest) -> Result<bool> {
        if !wanted.coarse_first {
            return Ok(false);
        }
        // A hand at a grip may move what a node makes of the data, such as a slice.
        let stale = || 2.0 * lock(&self.shared.state).output.stale_seconds(wanted);
        let others = Duration::from_secs_f64(if wanted.grip_moves { stale() } else { 0.0 });
        let first = self.pace.divisor(wanted.pixels());
        let mut crowding = std::mem::take(&mut self.crowding);
        let drawn = crowding.finer_where_crowded(wanted, [first, 1], |divisor| {
            let patience = self.pace.patience(divisor, wanted.pixels()) + others;
            self.pass(number, wanted, divisor, Some(patience))
        });
        self.crowding = crowding;
        drawn
    }

    /// One run, with so many pixels less along each side; `patience`: how long it goes on while a hand moves, for one that may be
    /// a preview. Returns true if its picture is the full one.
    fn pass(
        &mut self,
        number: u64,
        wanted: &RenderRequest,
        divisor: u32,
        patience: Option<Duration>,
    ) -> Result<bool> {
        let start = Instant::now();
        let graph = wanted.graph(&self.registry, divisor)?;
        let (shared, begun) = (self.shared, Instant::now());
        let pass = Pass { shared, number, wanted, begun, patience, judged: Mutex::default() };
        let stop = |running: &dyn Fn() -> Option<String>| pass.stops(running);
        let following = Following::new(shared, &stop, RunView::Nodes);
        let report = self.guarded(&following, |session| match patience {
            Some(_) => session.run_preview(&graph, &following),
            None => session.run(&graph, &following),
        })?;
        let seconds = start.elapsed().as_secs_f64();
        let drew_alone = report.nodes.iter().all(|node| node.reused || wanted.is_cheap(&node.name));
        let drawn = Pixels::new(wanted.picture_of(&report)?, wanted, divisor, number);
        let pixels = Pixels { is_preview: report.is_preview, ..drawn };
        match report.is_preview {
            _ if !drew_alone => {}
            true => self.pace.learn_of_kept(pixels.count(), seconds),
            false => self.pace.learn(divisor, pixels.count(), seconds),
        }
        if pass.is_stale() {
            return Err(Error::cancelled());
        }
        let is_full = pixels.is_full();
        let values = is_full.then(|| wire_values(&mut self.session, &graph)).flatten();
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
            let what = "the node panicked, which is a fault of its program";
            let error = Error::new(ErrorKind::Panic, what).got(text);
            Err(following.node().into_iter().fold(error, |error, node| error.at_node(node)))
        })
    }

    /// Answers the open query of a kind, unless there is none; it is given up for a newer picture, and one that is not asked again for a newer
    /// query.
    fn query<Q: Query>(
        &mut self,
        newest: u64,
        of: impl Fn(&mut WorkerOutput) -> &mut Exchange<Q> + Sync,
    ) -> bool {
        let (shared, registry) = (self.shared, &*self.registry.clone());
        // Queries of another document than that of the newest request are none of this document's.
        let taken = lock(&shared.state).output.since(newest).and_then(|output| of(output).take());
        let Some((number, query)) = taken else { return false };
        let is_superseded = || {
            let mut state = lock(&shared.state);
            state.output.since(newest).is_none_or(|output| of(output).numbers()[0] != number)
        };
        let stop =
            |_: &dyn Fn() -> Option<String>| shared.newest() != newest || (!Q::WAITS && is_superseded());
        let advance = |output: &mut WorkerOutput, stage: &str, fraction: f64| {
            if let Some(output) = output.since(newest) {
                of(output).advance(number, stage, fraction);
            }
        };
        let following = Following::new(shared, &stop, RunView::Query(&advance));
        let mut crowding = std::mem::take(&mut self.crowding);
        let outcome = self.guarded(&following, |session| {
            let (observer, crowding) = (&following, &mut crowding);
            query.answer(&mut QueryRun { session, registry, observer, crowding })
        });
        self.crowding = crowding;
        shared.show(|output| {
            if let Some(output) = output.since(newest) {
                of(output).settle(number, outcome);
            }
        });
        true
    }
}

/// Reads what a picture will be drawn from, until another one is wanted. What is wrong with the data is said when they are drawn.
fn read_ahead(shared: &Shared, registry: &Registry, session: &mut Session, next: &RenderRequest) {
    let stop = |_: &dyn Fn() -> Option<String>| {
        let state = lock(&shared.state);
        state.ends
            || !state.reads_ahead
            || state.picture.as_ref().is_some_and(|now| !Change::between(next, now).moves)
    };
    let following = Following::new(shared, &stop, RunView::Nothing);
    let read = || next.graph(registry, 1).and_then(|graph| session.read_ahead(&graph, &following));
    drop(catch_unwind(AssertUnwindSafe(read)));
}

/// Progress is shown no more often than a screen does.
pub(crate) const BETWEEN: Duration = Duration::from_millis(50);

/// Wakes whoever shows what changed; called from any thread.
pub type RepaintCallback = Arc<dyn Fn() + Send + Sync>;

pub(super) struct Shared {
    pub state: Mutex<SharedState>,
    pub changed: Condvar,
    pub newest: AtomicU64,
    wake: RepaintCallback,
}

#[derive(Default)]
pub(super) struct SharedState {
    /// The newest request, until it is worked at.
    pub picture: Option<RenderRequest>,
    /// The one that will be requested after it, as far as is known.
    pub next: Option<RenderRequest>,
    /// False once nobody waits for the data of the next one any more.
    pub reads_ahead: bool,
    pub output: WorkerOutput,
    /// Node types and filters that graphs may name.
    pub registry: Arc<Registry>,
    /// True if something was requested since the thread waited.
    pub has_news: bool,
    pub ends: bool,
}

impl Shared {
    pub fn new(registry: Arc<Registry>, wake: RepaintCallback) -> Shared {
        let state = Mutex::new(SharedState { registry, ..SharedState::default() });
        Shared { state, changed: Condvar::new(), newest: AtomicU64::new(0), wake }
    }

    /// Changes what is shown, and has it shown.
    pub fn show(&self, change: impl FnOnce(&mut WorkerOutput)) {
        change(&mut lock(&self.state).output);
        (self.wake)();
    }

    pub fn newest(&self) -> u64 {
        self.newest.load(Ordering::SeqCst)
    }
}

pub(super) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Says whether a run is to stop, given what tells the node that runs; none between two.
pub(super) type Stop<'a> = &'a (dyn Fn(&dyn Fn() -> Option<String>) -> bool + Sync);

/// Parts of a run's progress that the window shows.
#[derive(Clone, Copy)]
pub(super) enum RunView<'a> {
    /// States of the nodes: of a picture.
    Nodes,
    /// Stage, and how much of it is done (0 … 1): of a query, recorded by this function.
    Query(&'a (dyn Fn(&mut WorkerOutput, &str, f64) + Sync)),
    Nothing,
}

pub(super) struct Following<'a> {
    shared: &'a Shared,
    stop: Stop<'a>,
    shown: RunView<'a>,
    node: Mutex<Option<String>>,
    last: Mutex<Instant>,
    /// True once the run was told to stop: parts of its work are left out from then on, so that is not taken back.
    is_stopped: AtomicBool,
}

impl<'a> Following<'a> {
    pub fn new(shared: &'a Shared, stop: Stop<'a>, shown: RunView<'a>) -> Self {
        let last = Mutex::new(Instant::now());
        Following { shared, stop, shown, node: Mutex::default(), last, is_stopped: AtomicBool::new(false) }
    }

    pub fn node(&self) -> Option<String> {
        lock(&self.node).clone()
    }
}

impl Observer for Following<'_> {
    fn started(&self, node: &str, _place: usize, _count: usize) {
        *lock(&self.node) = Some(node.to_string());
        if matches!(self.shown, RunView::Nodes) {
            lock(&self.shared.state).output.started(node);
        }
    }

    fn finished(&self, node: &str, seconds: f64) {
        *lock(&self.node) = None;
        if matches!(self.shown, RunView::Nodes) {
            lock(&self.shared.state).output.done(node, seconds);
        }
    }

    fn progress(&self, node: &str, stage: &str, fraction: f64) {
        // One of several threads is enough to show it, and none waits for another.
        let Ok(mut last) = self.last.try_lock() else { return };
        if last.elapsed() < BETWEEN {
            return;
        }
        *last = Instant::now();
        drop(last);
        match self.shown {
            RunView::Nodes => self.shared.show(|shown| shown.progress(node, stage, fraction)),
            RunView::Query(advance) => self.shared.show(|shown| advance(shown, stage, fraction)),
            RunView::Nothing => {}
        }
    }

    fn cancelled(&self) -> bool {
        let is_stopped = self.is_stopped.load(Ordering::SeqCst) || (self.stop)(&|| self.node());
        if is_stopped {
            self.is_stopped.store(true, Ordering::SeqCst);
        }
        is_stopped
    }

    fn memory_left(&self) -> Option<u64> {
        memory::available()
    }
}

/// A pass that may be superseded: it is stopped for a newer request at once, but for two cases:
///
/// - The node that runs is not touched by the change: its output will serve, and the pass ends after it.
/// - The picture is the first of its request, coarse or quick, and the change is a hand's movement (see [`Change::moves`]): stopped each time, a steady drag would never show any. It has about the time that such a picture takes.
///
/// A picture that was drawn to its end after another kind of change is not shown.
struct Pass<'a> {
    shared: &'a Shared,
    number: u64,
    wanted: &'a RenderRequest,
    begun: Instant,
    /// Time limit while the user moves on; `None` for a picture after a coarse one.
    patience: Option<Duration>,
    /// Changes of the newest request, by its number.
    judged: Mutex<Option<(u64, Arc<Change>)>>,
}

impl Pass<'_> {
    /// True if the pass is to stop. `running`: the node that runs; none between two.
    pub fn stops(&self, running: &dyn Fn() -> Option<String>) -> bool {
        let newest = self.shared.newest();
        if newest == self.number {
            return false;
        }
        let Some(change) = self.change(newest) else { return true };
        if change.moves && self.patience.is_some_and(|patience| self.begun.elapsed() < patience) {
            return false;
        }
        running().is_none_or(|node| change.touched.contains(&node))
    }

    /// True if its picture is useless, even during a movement.
    pub fn is_stale(&self) -> bool {
        let newest = self.shared.newest();
        newest != self.number && self.change(newest).is_none_or(|change| !change.moves)
    }

    /// Changes of the newest request; `None` if the worker ends or the picture is of a forgotten document.
    fn change(&self, newest: u64) -> Option<Arc<Change>> {
        let mut judged = lock(&self.judged);
        if let Some((number, change)) = &*judged
            && *number == newest
        {
            return Some(change.clone());
        }
        let mut state = lock(&self.shared.state);
        state.output.since(self.number)?;
        let change = Arc::new(Change::between(self.wanted, state.picture.as_ref()?));
        *judged = Some((newest, change.clone()));
        Some(change)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use voltet_graph::pipeline::Pipeline;
    use voltet_graph::{LocatedValue, ParameterValue};

    fn wanted() -> RenderRequest {
        let nodes = Pipeline::parse(include_str!("../ui_tests/scene.toml")).unwrap().nodes;
        RenderRequest { coarse_first: true, ..RenderRequest::of_picture(nodes) }
    }

    fn with(node: &str, key: &str, datum: ParameterValue) -> RenderRequest {
        let mut wanted = wanted();
        let node = wanted.nodes.iter_mut().find(|entry| entry.name == node).unwrap();
        node.set(key, &[], LocatedValue::from(datum)).unwrap();
        wanted
    }

    fn touched(now: &RenderRequest) -> (Vec<String>, bool) {
        let change = Change::between(&wanted(), now);
        (change.touched.into_iter().collect(), change.moves)
    }

    #[test]
    fn a_moved_camera_or_widget_touches_what_follows_and_is_a_movement() {
        let of = |names: &[&str]| names.iter().map(|name| name.to_string()).collect::<Vec<_>>();
        assert_eq!(touched(&wanted()), (of(&[]), true));
        assert_eq!(
            touched(&with("view", "fov_y", ParameterValue::Number(20.0))),
            (of(&["picture", "view"]), true)
        );
        assert_eq!(
            touched(&with("look", "unit_distance", ParameterValue::Number(2.0))),
            (of(&["look", "picture"]), true)
        );
        // What a hand moves by a grip is a movement, what is typed is none, be it the same parameter.
        let typed = with("picture", "clip", ParameterValue::List(Vec::new()));
        assert_eq!(touched(&typed), (of(&["picture"]), false));
        let dragged = RenderRequest { grip_moves: true, ..typed };
        assert_eq!(touched(&dragged), (of(&["picture"]), true));
        let other = with("gradient", "method", ParameterValue::Text("cell-average".into()));
        assert_eq!(touched(&other), (of(&["gradient", "picture"]), false));
        let elsewhere = RenderRequest { folder: "elsewhere".into(), ..wanted() };
        assert_eq!(touched(&elsewhere).0.len(), 5);
        let other_node = RenderRequest { node: "gradient".into(), ..wanted() };
        assert_eq!(touched(&other_node), (of(&["look", "picture", "view"]), false));
    }
}
