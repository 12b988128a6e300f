//! Former outputs of nodes, and values made from a revision.

use super::plan::Done;
use crate::api::context::{FOR_THE_SESSION, Make, Preparation, RetainedValue};
use crate::api::demand::Demand;
use crate::api::node::{Node, Steps};
use crate::api::origins::{FileStamp, ResolvedPipeline, Stamp};
use crate::api::value::{Revision, Value};
use crate::build::graph::{Graph, GraphNode, NodeOverride};
use std::any::TypeId;
use std::collections::{BTreeSet, HashMap, HashSet};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
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
    pub(super) inputs: Vec<(usize, Revision)>,
    pub(super) demand: Demand,
    /// The files that it depends on, as they were before the run; those that it writes, after it.
    pub(super) files: Vec<(PathBuf, Stamp)>,
    /// Text of its graph, where the node read it.
    pub(super) carried: Option<ResolvedPipeline>,
    pub(super) done: Done,
    /// True until the run that it was made for, ahead of it, has used it.
    pub(super) is_ahead: bool,
}

impl Entry {
    /// True if it gives what a run for this demand would.
    pub(super) fn serves(&self, demand: &Demand) -> bool {
        // Where a value of a requested array is not finite cells are left out, for nobody but those who requested it.
        let is_grid_with_gaps =
            |value: &Value| matches!(value, Value::Grid(grid) if grid.origin.cells_not_finite > 0);
        let has_gaps = self.done.outputs.iter().any(|(value, _)| is_grid_with_gaps(value));
        self.demand.covers(demand) && (!has_gaps || self.demand.arrays == demand.arrays)
    }
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
        &mut self,
        node: &GraphNode,
        inputs: &[(usize, Revision)],
        serves: impl Fn(&Entry) -> bool,
        files: &[(PathBuf, Stamp)],
        stated: &ResolvedPipeline,
    ) -> Option<&mut Entry> {
        self.entries.iter_mut().find(|e| {
            e.node.name == node.node.name
                && e.inputs == inputs
                && e.files == files
                && e.plugin.as_ref() == node.plugin()
                && e.given == node.given
                && e.carried.as_ref().is_none_or(|carried| carried == stated)
                && e.parameters == node.parameters
                && serves(e)
        })
    }

    /// Adds a run, in place of one that it makes superfluous; with `keeps_others` of those alone whose demand it covers.
    pub(super) fn add(&mut self, entry: Entry, keeps_others: bool) {
        self.entries.retain(|e| {
            !((!keeps_others || entry.demand.covers(&e.demand))
                && e.node.name == entry.node.name
                && e.inputs == entry.inputs
                && e.parameters == entry.parameters
                && e.given == entry.given
                && e.files.iter().map(|f| &f.0).eq(entry.files.iter().map(|f| &f.0)))
        });
        self.entries.push(entry);
    }

    /// True for each run that is needed, with all that it was made from.
    pub(super) fn needed(&self, is_needed: impl Fn(&Entry) -> bool) -> Vec<bool> {
        let mut alive = BTreeSet::new();
        // Entries stand in the order in which they were made, so inputs come before what was made from them.
        let keeps = |entry: &Entry| {
            let keep = is_needed(entry) && entry.inputs.iter().all(|(_, r)| alive.contains(r));
            if keep {
                alive.extend(entry.done.outputs.iter().map(|o| o.1));
            }
            keep
        };
        self.entries.iter().map(keeps).collect()
    }

    /// Keeps these runs alone.
    pub(super) fn keep(&mut self, needed: &[bool]) {
        let mut needed = needed.iter();
        self.entries.retain(|_| needed.next().is_some_and(|needed| *needed));
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
    stamped(paths_of(graph, node, &node.parameters, steps), stamp)
}

/// The files that a node's parameters name, and those that it reads beside them.
fn paths_of(graph: &Graph, node: &GraphNode, parameters: &Parameters, steps: Steps) -> Vec<PathBuf> {
    let folder = graph.folder.as_path();
    let named = parameters.paths().into_iter().map(|named| named.from(folder));
    named.chain((node.node.files_beside)(&Preparation { parameters, folder }, steps)).collect()
}

/// Files with their state as it is now.
pub(super) fn stamped(
    paths: impl IntoIterator<Item = PathBuf>,
    stamp: impl Fn(&Path) -> Stamp,
) -> Vec<(PathBuf, Stamp)> {
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

/// Most lists of files that are kept.
const MAX_LISTINGS: usize = 64;

/// The files that a node reads, as they were when they were listed.
struct Listing {
    node: &'static str,
    parameters: Parameters,
    folder: PathBuf,
    /// Selection of steps, and the number of all of them.
    steps: (Steps, usize),
    files: Vec<(PathBuf, Stamp)>,
}

/// Values made from a revision, by the revision and their own type.
#[derive(Default)]
pub(super) struct Store {
    over_steps: Arc<Mutex<Vec<(Key, RetainedValue)>>>,
    listings: Arc<Mutex<Vec<Listing>>>,
    kept: Mutex<RetainedValues>,
    /// Notified when a value is made.
    is_made: Condvar,
}

/// Values, and the keys of those that are being made.
#[derive(Default)]
struct RetainedValues {
    values: HashMap<(Revision, TypeId), RetainedValue>,
    in_work: HashSet<(Revision, TypeId)>,
}

impl Store {
    /// A store for one step of a series: what is made over all steps serves every step.
    pub(super) fn for_one_step(&self) -> Store {
        let (over_steps, listings) = (self.over_steps.clone(), self.listings.clone());
        Store { over_steps, listings, ..Store::default() }
    }

    /// The files that a node with these parameters reads, as [`files_of`] lists them, for steps that many runs look at; `count`: of all
    /// steps. Files are opened again only where one of them changed.
    pub(super) fn listed_files(
        &self,
        graph: &Graph,
        node: &GraphNode,
        parameters: &Parameters,
        (steps, count): (Steps, usize),
        stamp: FileStamp,
    ) -> Vec<(PathBuf, Stamp)> {
        let lock = || self.listings.lock().unwrap_or_else(PoisonError::into_inner);
        let is_it = |listing: &Listing| {
            listing.node == node.node.name
                && listing.steps == (steps, count)
                && listing.folder == graph.folder
                && listing.parameters == *parameters
        };
        let known = lock().iter().find(|listing| is_it(listing)).map(|listing| listing.files.clone());
        if let Some(files) = known.filter(|files| files.iter().all(|(path, state)| stamp(path) == *state)) {
            return files;
        }
        let files = stamped(paths_of(graph, node, parameters, steps), stamp);
        let mut all = lock();
        all.retain(|listing| !is_it(listing));
        if all.len() >= MAX_LISTINGS {
            all.remove(0);
        }
        let (folder, parameters) = (graph.folder.clone(), parameters.clone());
        all.push(Listing {
            node: node.node.name,
            parameters,
            folder,
            steps: (steps, count),
            files: files.clone(),
        });
        files
    }

    /// The value of this type made from this revision; made now if it is not there, once for all threads.
    pub(super) fn get_or_make(&self, key: (Revision, TypeId), make: Make) -> Result<RetainedValue> {
        let mut kept = self.lock();
        loop {
            if let Some(value) = kept.values.get(&key) {
                return Ok(value.clone());
            }
            if kept.in_work.insert(key) {
                break;
            }
            kept = self.is_made.wait(kept).unwrap_or_else(PoisonError::into_inner);
        }
        drop(kept);
        let work = ValueInWork { store: self, key };
        let made = make()?;
        self.lock().values.insert(key, made.clone());
        drop(work);
        Ok(made)
    }

    /// The value made over all steps of a time series; made now if it is not there.
    pub(super) fn keep_over_steps(&self, key: Key, make: Make) -> Result<RetainedValue> {
        let lock = || self.over_steps.lock().unwrap_or_else(PoisonError::into_inner);
        let find = |all: &[(Key, RetainedValue)]| {
            all.iter().find(|(known, _)| *known == key).map(|(_, kept)| kept.clone())
        };
        let kept = find(&lock());
        if let Some(kept) = kept {
            return Ok(kept);
        }
        let made = make()?;
        let mut all = lock();
        // Another thread may have made it meanwhile.
        if let Some(kept) = find(&all) {
            return Ok(kept);
        }
        all.push((key, made.clone()));
        Ok(made)
    }

    pub(super) fn count(&self) -> usize {
        self.lock().values.len() + self.over_steps.lock().unwrap_or_else(PoisonError::into_inner).len()
    }

    /// Drops values made from revisions that are gone.
    pub(super) fn forget_all_but(&self, alive: &BTreeSet<Revision>) {
        let is_alive = |revision: &Revision| *revision == FOR_THE_SESSION || alive.contains(revision);
        self.lock().values.retain(|(revision, _), _| is_alive(revision));
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, RetainedValues> {
        self.kept.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// A value that is being made: other threads wait until this is dropped.
struct ValueInWork<'a> {
    store: &'a Store,
    key: (Revision, TypeId),
}

impl Drop for ValueInWork<'_> {
    fn drop(&mut self) {
        self.store.lock().in_work.remove(&self.key);
        self.store.is_made.notify_all();
    }
}
