//! Outputs that sessions of several threads share: each is made once, and held while some graph can use it.

use super::cache::{Cache, Entry, Store};
use super::plan::Done;
use crate::api::demand::Demand;
use crate::api::observer::Observer;
use crate::api::origins::{ResolvedPipeline, Stamp};
use crate::api::value::{PortType, Revision, Value};
use crate::build::graph::{Graph, GraphNode, NodeOverride};
use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use voltet_core::field::Plugin;
use voltet_core::parameters::Parameters;

/// Former outputs, and what is in work.
#[derive(Default)]
pub(super) struct SharedOutputs {
    pub(super) store: Store,
    state: Mutex<State>,
    /// Notified when a node has run.
    has_run: Condvar,
    last_revision: AtomicU64,
    last_session: AtomicU64,
}

#[derive(Default)]
struct State {
    cache: Cache,
    in_work: Vec<(u64, NodeCall)>,
    /// The nodes of the graph that each session ran last.
    of_sessions: Vec<(u64, Vec<NeededNode>)>,
    /// The nodes of graphs to come that give grids and volumes, each with the number of these graphs.
    to_come: Vec<(NeededNode, usize)>,
}

/// A node whose former outputs a graph can use.
#[derive(Clone, PartialEq)]
struct NeededNode {
    name: &'static str,
    parameters: Parameters,
    given: Option<NodeOverride>,
}

fn needed_by(graph: &Graph) -> Vec<NeededNode> {
    graph.order.iter().map(|&i| NeededNode::from_node(&graph.nodes[i])).collect()
}

impl NeededNode {
    fn from_node(node: &GraphNode) -> NeededNode {
        NeededNode { name: node.node.name, parameters: node.parameters.clone(), given: node.given.clone() }
    }

    fn is_of(&self, entry: &Entry) -> bool {
        self.name == entry.node.name && self.parameters == entry.parameters && self.given == entry.given
    }
}

/// Work of a node on given inputs and files.
#[derive(PartialEq)]
pub(super) struct NodeCall {
    node: NeededNode,
    plugin: Option<Plugin>,
    inputs: Vec<(usize, Revision)>,
    files: Vec<(PathBuf, Stamp)>,
}

impl NodeCall {
    pub(super) fn new(
        node: &GraphNode,
        inputs: &[(usize, Revision)],
        files: &[(PathBuf, Stamp)],
    ) -> NodeCall {
        let plugin = node.plugin().cloned();
        NodeCall { node: NeededNode::from_node(node), plugin, inputs: inputs.to_vec(), files: files.to_vec() }
    }
}

/// Outcome of [`SharedOutputs::claim`].
pub(super) enum Claim<'a> {
    /// A former run serves.
    Former(Box<Done>),
    /// The caller runs the node; others that need the same wait until this is dropped.
    Own {
        /// Ends the work.
        claim: WorkClaim<'a>,
        /// True if a former run was of the same, but for other places.
        was_elsewhere: bool,
    },
}

pub(super) struct WorkClaim<'a> {
    shared: &'a SharedOutputs,
    number: u64,
}

impl Drop for WorkClaim<'_> {
    fn drop(&mut self) {
        self.shared.lock().in_work.retain(|(number, _)| *number != self.number);
        self.shared.has_run.notify_all();
    }
}

/// Share of one session, which ends with it.
pub(super) struct Share {
    shared: Arc<SharedOutputs>,
    number: u64,
}

impl Share {
    /// A share of outputs, of its own where there are none.
    pub(super) fn new(shared: Arc<SharedOutputs>) -> Share {
        let number = shared.last_session.fetch_add(1, Ordering::Relaxed);
        Share { shared, number }
    }

    /// Another share of the same outputs.
    pub(super) fn another(&self) -> Share {
        Share::new(self.shared.clone())
    }

    /// Begins the run of a graph: outputs are dropped that neither it, nor the graphs of other sessions, nor those to come can use.
    /// What only those to come can use stays while it takes less memory than is left.
    pub(super) fn begin(&self, graph: &Graph, observer: &dyn Observer) {
        let mut state = self.shared.lock();
        let needed = needed_by(graph);
        for node in &needed {
            // Graphs that were not foretold may need the same.
            let known = state.to_come.iter_mut().filter(|(known, _)| known == node);
            known.for_each(|(_, count)| *count = count.saturating_sub(1));
        }
        state.to_come.retain(|(_, count)| *count > 0);
        self.need(&mut state, needed);
        state.forget(observer);
        self.shared.store.forget_all_but(&state.cache.revisions());
    }

    /// Begins work for a graph that another session will run next: nothing that it can use is dropped.
    pub(super) fn begin_ahead(&self, graph: &Graph) {
        self.need(&mut self.shared.lock(), needed_by(graph));
    }

    fn need(&self, state: &mut State, needed: Vec<NeededNode>) {
        state.of_sessions.retain(|(number, _)| *number != self.number);
        state.of_sessions.push((self.number, needed));
    }

    pub(super) fn forget(&self) {
        let mut state = self.shared.lock();
        state.of_sessions.retain(|(number, _)| *number != self.number);
        state.cache.entries.clear();
        self.shared.store.forget_all_but(&state.cache.revisions());
    }
}

impl Drop for Share {
    fn drop(&mut self) {
        self.shared.lock().of_sessions.retain(|(number, _)| *number != self.number);
    }
}

impl std::ops::Deref for Share {
    type Target = SharedOutputs;

    fn deref(&self) -> &SharedOutputs {
        &self.shared
    }
}

impl SharedOutputs {
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(super) fn next_revision(&self) -> Revision {
        Revision(self.last_revision.fetch_add(1, Ordering::Relaxed) + 1)
    }

    /// Graphs that will be run.
    pub(super) fn expect<'g>(&self, graphs: impl Iterator<Item = &'g Graph>) {
        let mut state = self.lock();
        for graph in graphs {
            let nodes = graph.order.iter().map(|&i| &graph.nodes[i]);
            for node in nodes.filter(|node| node.gives(PortType::Grid) || node.makes_volume()) {
                let node = NeededNode::from_node(node);
                match state.to_come.iter_mut().find(|(known, _)| *known == node) {
                    Some((_, count)) => *count += 1,
                    None => state.to_come.push((node, 1)),
                }
            }
        }
    }

    /// The former run that serves a demand, or the claim to run the node now. Waits while another session does the same work.
    /// `exhaustive`: no former run serves.
    pub(super) fn claim(
        &self,
        node: &GraphNode,
        work: NodeCall,
        demand: &Demand,
        stated: &ResolvedPipeline,
        exhaustive: bool,
    ) -> Claim<'_> {
        let NodeCall { inputs, files, .. } = &work;
        let mut state = self.lock();
        loop {
            let former = state.cache.find(node, inputs, |former| former.serves(demand), files, stated);
            if let Some(entry) = former.filter(|_| !exhaustive) {
                if std::mem::take(&mut entry.is_ahead) {
                    return Claim::Former(Box::new(entry.done.clone()));
                }
                let reused = Some(entry.done.seconds);
                return Claim::Former(Box::new(Done { seconds: 0.0, reused, ..entry.done.clone() }));
            }
            if !state.in_work.iter().any(|(_, other)| *other == work) {
                break;
            }
            state = self.has_run.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
        let elsewhere = |former: &Entry| former.demand.everywhere().covers(demand);
        let was_elsewhere = state.cache.find(node, inputs, elsewhere, files, stated).is_some();
        let number = self.next_revision().0;
        state.in_work.push((number, work));
        Claim::Own { claim: WorkClaim { shared: self, number }, was_elsewhere }
    }

    /// Adds a run, in place of those that it makes superfluous.
    pub(super) fn add(&self, entry: Entry) {
        let mut state = self.lock();
        let is_to_come = state.to_come.iter().any(|(node, _)| node.is_of(&entry));
        // A graph to come may ask for what this run was not asked for.
        state.cache.add(entry, is_to_come);
    }

    pub(super) fn drop_runs(&self, fits: impl Fn(&Entry) -> bool) {
        self.lock().cache.entries.retain(|entry| !fits(entry));
    }

    /// Number of former outputs that are held, and of values made from them.
    pub(super) fn held_counts(&self) -> [usize; 2] {
        [self.lock().cache.entries.len(), self.store.count()]
    }
}

impl State {
    fn forget(&mut self, observer: &dyn Observer) {
        let State { cache, of_sessions, to_come, .. } = self;
        let is_used = |entry: &Entry| of_sessions.iter().flat_map(|(_, nodes)| nodes).any(|n| n.is_of(entry));
        let is_to_come = |entry: &Entry| to_come.iter().any(|(node, _)| node.is_of(entry));
        let now = cache.needed(is_used);
        let later = cache.needed(|entry| is_used(entry) || is_to_come(entry));
        let waiting =
            cache.entries.iter().zip(later.iter().zip(&now)).filter(|(_, (later, now))| **later && !**now);
        let bytes: u64 = waiting.map(|(entry, _)| bytes_of(entry)).sum();
        let has_room = bytes == 0 || observer.memory_left().is_none_or(|left| bytes <= left);
        cache.keep(if has_room { &later } else { &now });
    }
}

/// About how much memory the outputs of a run take, bytes.
fn bytes_of(entry: &Entry) -> u64 {
    let of_value = |value: &Value| match value {
        Value::Grid(grid) => grid.points.len() * 32 + grid.tetrahedra.len() * 16,
        Value::Volume(volume) => volume.scalar.len() * 40,
        _ => 0,
    };
    entry.done.outputs.iter().map(|(value, _)| of_value(value) as u64).sum()
}
