//! Grids that are read and drawn part after part, because they do not fit into memory: which pieces of the file make up a part, which
//! nodes run once for each, and their outputs for the part that is at hand.

use super::node_run::NodeRun;
use super::plan::{Done, inputs_of};
use crate::api::context::{Make, Preparation, RetainedValue};
use crate::api::demand::Demand;
use crate::api::node::PartWork;
use crate::api::parts::GridPart;
use crate::api::value::{PortType, Revision, Value};
use crate::build::graph::Graph;
use std::any::TypeId;
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::sync::{Arc, Mutex, PoisonError};
use voltet_core::diagnostics::Diagnostics;
use voltet_core::{Error, Result, counted};

/// Rings of cells around a part that means of cell values look at.
const MEAN_LAYERS: usize = 1;

/// Further rings that the filter of each node with gradients may look at: those of the neighbours of neighbours.
const GRADIENT_LAYERS: usize = 2;

/// Division of a grid into parts.
#[derive(Debug)]
pub(super) struct Division {
    /// True for each node of the graph that runs once for each part.
    pub is_mapped: Vec<bool>,
    pub parts: Vec<GridPart>,
}

impl Division {
    /// The division by which each part takes at most `memory` bytes, as far as pieces of a file allow; `None` where the whole grid does.
    ///
    /// # Errors
    /// - a node that works on whole grids alone;
    /// - two files in pieces.
    pub fn new(graph: &Graph, memory: u64) -> Result<Option<Division>> {
        let mut source = None;
        for &place in &graph.order {
            let node = &graph.nodes[place];
            let preparation = Preparation { parameters: &node.parameters, folder: &graph.folder };
            let sizes = (node.node.piece_bytes)(&preparation).map_err(|error| node.locate(error))?;
            if sizes.iter().sum::<u64>() <= memory || sizes.len() < 2 {
                continue;
            }
            if let Some((other, _)) = source.replace((place, sizes)) {
                let other = &graph.nodes[other].name;
                let error = Error::usage("two grids are larger than the memory that may be taken");
                let error = error.got(format!("those of '{other}' and '{}'", node.name));
                return Err(node.locate(error.expected("one such grid, or a larger --memory")));
            }
        }
        let Some((source, sizes)) = source else { return Ok(None) };
        let groups = grouped(&sizes, memory);
        let mut is_mapped = vec![false; graph.nodes.len()];
        let mut layers = MEAN_LAYERS;
        for &place in &graph.order {
            let node = &graph.nodes[place];
            let is_fed = node.inputs.iter().any(|edge| is_mapped[edge.node]);
            if place != source && !is_fed {
                continue;
            }
            match node.node.part_work {
                PartWork::Each => {
                    is_mapped[place] = true;
                    layers += if node.node.method().is_some() { GRADIENT_LAYERS } else { 0 };
                }
                PartWork::All => {}
                PartWork::None => {
                    let what = format!("a node of type \"{}\" works on whole grids", node.node.name);
                    let found = format!("a grid in {} (--memory)", counted(groups.len(), "part"));
                    let accepted = "a larger --memory, or a pipeline of reader, gradient-magnitude, calculator, threshold, \
                                    transfer-function, camera and renderer";
                    return Err(node.locate(Error::usage(what).got(found).expected(accepted)));
                }
            }
        }
        let parts = groups.into_iter().map(|pieces| GridPart { pieces, layers }).collect();
        Ok(Some(Division { is_mapped, parts }))
    }
}

/// Pieces that follow each other, as many as fit together; one that fits not even alone stands alone.
fn grouped(sizes: &[u64], memory: u64) -> Vec<Vec<usize>> {
    let mut groups: Vec<Vec<usize>> = Vec::new();
    let mut filled = 0;
    for (piece, &size) in sizes.iter().enumerate() {
        match groups.last_mut() {
            Some(group) if filled + size <= memory => {
                group.push(piece);
                filled += size;
            }
            _ => {
                groups.push(vec![piece]);
                filled = size;
            }
        }
    }
    groups
}

/// Runs of the nodes that give parts, by one run of a session.
pub(super) struct PartRuns<'a> {
    pub graph: &'a Graph,
    pub demands: &'a [Demand],
    pub division: &'a Division,
    state: Mutex<PartState>,
}

/// Outputs of the nodes that ran for a part; `None` where the part has no cells.
type PartOutputs = Option<Vec<Option<Done>>>;

#[derive(Default)]
struct PartState {
    /// The part at hand.
    latest: Option<(usize, Arc<PartOutputs>)>,
    /// Values that nodes keep for all parts.
    shared: HashMap<(usize, TypeId), RetainedValue>,
    /// Parts that ran, for what is counted once.
    counted: BTreeSet<usize>,
    notes: BTreeMap<usize, Diagnostics>,
}

impl<'a> PartRuns<'a> {
    /// Before any part is read.
    pub fn new(graph: &'a Graph, demands: &'a [Demand], division: &'a Division) -> PartRuns<'a> {
        PartRuns { graph, demands, division, state: Mutex::default() }
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, PartState> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The numbers of the parts, that at hand first.
    pub fn order(&self) -> Vec<usize> {
        let count = self.division.parts.len();
        let first = self.lock().latest.as_ref().map_or(0, |(part, _)| *part);
        if first + 1 == count { (0..count).rev().collect() } else { (0..count).collect() }
    }

    /// Outputs of the nodes for a part. `run`: of the node that asks for them.
    pub fn outputs(&self, part: usize, run: &NodeRun) -> Result<Arc<PartOutputs>> {
        if let Some((_, known)) = self.lock().latest.as_ref().filter(|(latest, _)| *latest == part) {
            return Ok(known.clone());
        }
        // Two parts are not held at a time.
        self.lock().latest = None;
        let outputs = Arc::new(self.run(part, run)?);
        self.lock().latest = Some((part, outputs.clone()));
        Ok(outputs)
    }

    fn run(&self, part: usize, run: &NodeRun) -> Result<PartOutputs> {
        let store = run.store.for_one_step();
        let mut revision = 0;
        let mut all_done: Vec<Option<Done>> = run.done.to_vec();
        let is_first = self.lock().counted.insert(part);
        for &place in self.graph.order.iter().filter(|&&place| self.division.is_mapped[place]) {
            let node = &self.graph.nodes[place];
            let grid_part = Some(&self.division.parts[part]);
            let own = NodeRun { place, done: &all_done, store: &store, part: grid_part, ..*run };
            own.check_cancelled()?;
            let inputs = inputs_of(node, &all_done);
            let mut call = own.context(&node.parameters, &self.demands[place], inputs, (false, false));
            let values = node.run(&mut call)?;
            if is_first {
                let notes = std::mem::take(&mut call.notes);
                self.lock().notes.entry(place).or_default().add_part(notes);
            }
            if values.is_empty() {
                return Ok(None);
            }
            let outputs = values.into_iter().map(|value| {
                revision += 1;
                (value, Revision(revision))
            });
            all_done[place] = Some(Done { outputs: outputs.collect(), ..Done::default() });
        }
        let is_mapped = &self.division.is_mapped;
        let of_parts =
            all_done.into_iter().zip(is_mapped).map(|(done, &is_mapped)| done.filter(|_| is_mapped));
        Ok(Some(of_parts.collect()))
    }

    /// A value that a node keeps for all parts, made at the first.
    pub fn keep(&self, key: (usize, TypeId), make: Make) -> Result<RetainedValue> {
        if let Some(kept) = self.lock().shared.get(&key) {
            return Ok(kept.clone());
        }
        let made = make()?;
        self.lock().shared.insert(key, made.clone());
        Ok(made)
    }

    /// Diagnostics of the nodes that ran for parts, by their places, over all parts.
    pub fn notes(self) -> BTreeMap<usize, Diagnostics> {
        self.state.into_inner().unwrap_or_else(PoisonError::into_inner).notes
    }
}

/// The outputs of a node that runs for parts, in a run in which it does not run for the whole.
pub(super) fn in_parts(
    outputs: impl Iterator<Item = PortType>,
    mut revision: impl FnMut() -> Revision,
) -> Done {
    Done {
        outputs: outputs.map(|port_type| (Value::InParts(port_type), revision())).collect(),
        ..Done::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_that_follow_each_other_fill_a_part() {
        assert_eq!(grouped(&[3, 3, 3, 3, 3], 6), [vec![0, 1], vec![2, 3], vec![4]]);
        assert_eq!(grouped(&[9, 1, 1, 9], 6), [vec![0], vec![1, 2], vec![3]]);
        assert_eq!(grouped(&[0, 0, 5], 6), [vec![0, 1, 2]]);
    }
}
