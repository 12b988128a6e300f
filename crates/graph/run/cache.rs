//! Former outputs of nodes, and values made from a revision.

use super::plan::Done;
use crate::api::context::{FOR_THE_SESSION, Make, Preparation, RetainedValue};
use crate::api::demand::Demand;
use crate::api::node::{Node, Steps};
use crate::api::origins::{FileStamp, ResolvedPipeline, Stamp};
use crate::api::value::Revision;
use crate::build::graph::{Graph, GraphNode, NodeOverride};
use std::any::TypeId;
use std::collections::{BTreeSet, HashMap};
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};
use voltet_core::Result;
use voltet_core::field::Plugin;
use voltet_core::parameters::Parameters;

/// One node's former run.
pub(super) struct Entry {
    pub(super) node: &'static Node,
    pub(super) parameters: Parameters,
    /// The plug-in that its gradient filter came from.
    pub(super) plugin: Option<Plugin>,
    /// Work that a program did in place of its own.
    pub(super) given: Option<NodeOverride>,
    /// Revisions at its ports.
    pub(super) inputs: Vec<(usize, Revision)>,
    pub(super) demand: Demand,
    /// The files that its parameters name and those that it reads beside them, as they were after the run.
    pub(super) files: Vec<(PathBuf, Stamp)>,
    /// Text of its graph, where the node read it.
    pub(super) carried: Option<ResolvedPipeline>,
    pub(super) done: Done,
}

/// Former runs. They are found by what they were made from, not by the node's name, so that pipelines that read
/// the same grid share it.
#[derive(Default)]
pub(super) struct Cache {
    pub(super) entries: Vec<Entry>,
}

impl Cache {
    /// The former run of a node of this type with these parameters, inputs and files, for a demand that serves. `stated`: the
    /// graph that it is part of, for one that was told.
    pub(super) fn find(
        &self,
        node: &GraphNode,
        inputs: &[(usize, Revision)],
        serves: impl Fn(&Demand) -> bool,
        files: &[(PathBuf, Stamp)],
        stated: &ResolvedPipeline,
    ) -> Option<&Entry> {
        self.entries.iter().find(|e| {
            e.node.name == node.node.name
                && e.inputs == inputs
                && e.files == files
                && e.plugin.as_ref() == node.plugin()
                && e.given == node.given
                && e.carried.as_ref().is_none_or(|carried| carried == stated)
                && e.parameters == node.parameters
                && serves(&e.demand)
        })
    }

    /// Adds a run, in place of one that it makes superfluous.
    pub(super) fn add(&mut self, entry: Entry) {
        self.entries.retain(|e| {
            !(e.node.name == entry.node.name
                && e.inputs == entry.inputs
                && e.parameters == entry.parameters
                && e.given == entry.given
                && e.files.iter().map(|f| &f.0).eq(entry.files.iter().map(|f| &f.0)))
        });
        self.entries.push(entry);
    }

    /// Drops what the graph cannot use again: runs of nodes that it does not have, and what was made from them.
    pub(super) fn forget_all_but(&mut self, graph: &Graph) {
        let mut alive = BTreeSet::new();
        // Entries stand in the order in which they were made, so inputs come before what was made from them.
        self.entries.retain(|entry| {
            let wanted = graph.order.iter().map(|&i| &graph.nodes[i]).any(|n| {
                n.node.name == entry.node.name && n.parameters == entry.parameters && n.given == entry.given
            });
            let keep = wanted && entry.inputs.iter().all(|(_, r)| alive.contains(r));
            if keep {
                alive.extend(entry.done.outputs.iter().map(|o| o.1));
            }
            keep
        });
    }

    /// The revisions of all outputs held.
    pub(super) fn revisions(&self) -> BTreeSet<Revision> {
        self.entries.iter().flat_map(|e| e.done.outputs.iter().map(|o| o.1)).collect()
    }
}

/// The files that a node's parameters name, those that it reads beside them, and their state.
pub(super) fn files_of(
    graph: &Graph,
    node: &GraphNode,
    steps: Steps,
    stamp: FileStamp,
) -> Vec<(PathBuf, Stamp)> {
    let (parameters, folder) = (&node.parameters, graph.folder.as_path());
    let named = parameters.paths().into_iter().map(|named| named.from(folder));
    stamped(named.chain((node.node.files_beside)(&Preparation { parameters, folder }, steps)), stamp)
}

/// Files with their state as it is now.
pub(super) fn stamped(paths: impl IntoIterator<Item = PathBuf>, stamp: FileStamp) -> Vec<(PathBuf, Stamp)> {
    let with_state = |path: PathBuf| {
        let state = stamp(&path);
        (path, state)
    };
    paths.into_iter().map(with_state).collect()
}

/// A node's type, its parameters, what feeds which port, its files, the plug-in of its filter, what a program does in place
/// of its work, and the demand on it.
type NodeKey = (
    &'static str,
    Vec<Parameters>,
    Vec<(usize, usize, usize)>,
    Vec<(PathBuf, Stamp)>,
    Option<Plugin>,
    Option<NodeOverride>,
    Demand,
);

/// Key of a value made over all steps: everything that it was made from.
#[derive(PartialEq)]
pub(super) struct Key {
    pub(super) nodes: Vec<NodeKey>,
    pub(super) port: (usize, usize),
    pub(super) value_type: TypeId,
}

/// Values made from a revision, by the revision and their own type.
#[derive(Default)]
pub(super) struct Store {
    over_steps: Arc<Mutex<Vec<(Key, RetainedValue)>>>,
    kept: Mutex<HashMap<(Revision, TypeId), RetainedValue>>,
}

impl Store {
    /// A store for one step of a series: what is made over all steps serves every step.
    pub(super) fn for_one_step(&self) -> Store {
        Store { over_steps: self.over_steps.clone(), kept: Mutex::default() }
    }

    /// The value of this type made from this revision; made now if it is not there.
    pub(super) fn get_or_make(&self, key: (Revision, TypeId), make: Make) -> Result<RetainedValue> {
        if let Some(kept) = self.lock().get(&key) {
            return Ok(kept.clone());
        }
        let made = make()?;
        self.lock().insert(key, made.clone());
        Ok(made)
    }

    /// The value made over all steps of a time series; made now if it is not there.
    pub(super) fn keep_over_steps(&self, key: Key, make: Make) -> Result<RetainedValue> {
        let lock = || self.over_steps.lock().unwrap_or_else(PoisonError::into_inner);
        let kept = lock().iter().find(|(known, _)| *known == key).map(|(_, kept)| kept.clone());
        if let Some(kept) = kept {
            return Ok(kept);
        }
        let made = make()?;
        lock().push((key, made.clone()));
        Ok(made)
    }

    /// Number of values.
    pub(super) fn count(&self) -> usize {
        self.lock().len() + self.over_steps.lock().unwrap_or_else(PoisonError::into_inner).len()
    }

    /// Drops values made from revisions that are gone.
    pub(super) fn forget_all_but(&self, alive: &BTreeSet<Revision>) {
        self.lock().retain(|(revision, _), _| *revision == FOR_THE_SESSION || alive.contains(revision));
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, HashMap<(Revision, TypeId), RetainedValue>> {
        self.kept.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
