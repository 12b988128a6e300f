//! Grids that are read and drawn part after part, because they do not fit into memory: which pieces of the file make up a part, which
//! nodes run once for each, and their outputs for the part that is at hand.

use super::plan::Done;
use crate::api::context::{Make, Preparation, RetainedValue};
use crate::api::demand::Demand;
use crate::api::node::PartWork;
use crate::api::parts::{GRADIENT_LAYERS, GridPart, SweptParts};
use crate::api::ranks::Ranks;
use crate::api::value::{Edge, PortType, Revision, Value};
use crate::build::graph::Graph;
use glam::DVec3;
use std::any::TypeId;
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::ops::Range;
use std::sync::{Arc, Mutex, PoisonError};
use voltet_core::diagnostics::Diagnostics;
use voltet_core::grid::extent;
use voltet_core::{Error, Result};

/// Division of a grid into parts.
#[derive(Debug)]
pub(super) struct Division {
    /// True for each node of the graph that runs once for each part.
    pub is_mapped: Vec<bool>,
    /// Parts of this process; none where it has no pieces.
    pub parts: Vec<GridPart>,
}

impl Division {
    /// The parts of one process, each of which takes at most `memory` bytes, as far as pieces of a file allow; `None` where the whole
    /// grid does, and there is one process.
    ///
    /// # Errors
    /// - a node that works on whole grids alone;
    /// - two files in pieces.
    pub fn new(graph: &Graph, memory: Option<u64>, ranks: &dyn Ranks) -> Result<Option<Division>> {
        let mut source: Option<(usize, Vec<u64>)> = None;
        if memory.is_none() && ranks.count() == 1 {
            return Ok(None);
        }
        let memory = memory.unwrap_or(u64::MAX);
        for &place in &graph.order {
            let node = &graph.nodes[place];
            let preparation = Preparation { parameters: &node.parameters, folder: &graph.folder };
            let sizes = match &node.given {
                // Larger than any file, which each process reads whole beside it.
                Some(given) if given.is_piece => vec![u64::MAX / ranks.count() as u64; ranks.count()],
                _ => (node.node.piece_bytes)(&preparation).map_err(|error| node.locate(error))?,
            };
            if sizes.len() < 2 || (sizes.iter().sum::<u64>() <= memory && ranks.count() == 1) {
                continue;
            }
            // Several processes share out the largest, and read the others whole.
            if let Some((_, larger)) = source.as_ref().filter(|_| memory == u64::MAX) {
                let total = |sizes: &[u64]| sizes.iter().fold(0, |sum: u64, size| sum.saturating_add(*size));
                if total(larger) < total(&sizes) {
                    source = Some((place, sizes));
                }
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
        let groups = grouped(&sizes, own_pieces(&sizes, ranks), memory);
        let mut is_mapped = vec![false; graph.nodes.len()];
        let mut is_cut = vec![false; graph.nodes.len()];
        let mut layers = 0;
        for &place in &graph.order {
            let node = &graph.nodes[place];
            let is_fed = node.inputs.iter().any(|edge| is_mapped[edge.node]);
            if place != source && !is_fed {
                continue;
            }
            match node.node.part_work {
                PartWork::Each => {
                    let is_whole = |edge: &Edge| !is_mapped[edge.node];
                    if let Some(edge) = node.inputs.iter().find(|edge| place != source && is_whole(edge)) {
                        let found = format!("'{}' at its input '{}'", graph.nodes[edge.node].name, edge.name);
                        let error = Error::usage(
                            "the node runs for each part of a grid, and an input is of a whole one",
                        );
                        let accepted = "inputs of one file, or a larger --memory and one process";
                        return Err(node.locate(error.got(found).expected(accepted)));
                    }
                    if let Some(number) = node.parameters.relative_numbers().first() {
                        let error = Error::usage(
                            "the node runs for each part of a grid (--memory, or several processes), and its numbers are relative to the whole",
                        );
                        let accepted = "a number in place of each that is relative or not stated, or a larger --memory and one process";
                        let error = number.locate(error.got(&number.setting.datum).expected(accepted));
                        return Err(node.locate(error));
                    }
                    is_mapped[place] = true;
                    let has_filter = node.node.method().is_some();
                    is_cut[place] = node.node.drops_cells || node.inputs.iter().any(|edge| is_cut[edge.node]);
                    if has_filter && is_cut[place] {
                        let error =
                            Error::usage("gradients after cells were dropped are found in whole grids");
                        let accepted =
                            "the gradient before the threshold, or a larger --memory and one process";
                        return Err(node.locate(error.got("a grid in parts").expected(accepted)));
                    }
                    layers += if has_filter { GRADIENT_LAYERS } else { 0 };
                }
                PartWork::All => {}
                PartWork::None => {
                    let what = format!("a node of type \"{}\" works on whole grids", node.node.name);
                    let found = "a grid in parts (--memory, or several processes)";
                    let accepted = "a larger --memory and one process, or a pipeline of reader, gradient-magnitude, calculator, \
                                    threshold, transfer-function, camera and renderer";
                    return Err(node.locate(Error::usage(what).got(found).expected(accepted)));
                }
            }
        }
        let parts = groups.into_iter().map(|pieces| GridPart { pieces, layers }).collect();
        Ok(Some(Division { is_mapped, parts }))
    }
}

/// The pieces of one of several processes: such as follow each other, with about the same share of the bytes for each process.
fn own_pieces(sizes: &[u64], ranks: &dyn Ranks) -> Range<usize> {
    let total: u128 = sizes.iter().map(|&size| u128::from(size)).sum();
    let mut before = 0;
    // A piece is of the process in whose share its middle lies.
    let rank_of = |before: u128, size: u64| {
        let middle = 2 * before + u128::from(size);
        (middle * ranks.count() as u128 / (2 * total).max(1)).min(ranks.count() as u128 - 1) as usize
    };
    let mut of_each: Vec<usize> = Vec::with_capacity(sizes.len());
    for &size in sizes {
        of_each.push(rank_of(before, size));
        before += u128::from(size);
    }
    let first = of_each.partition_point(|&rank| rank < ranks.rank());
    first..of_each.partition_point(|&rank| rank <= ranks.rank())
}

/// Pieces that follow each other, as many as fit together; one that fits not even alone stands alone.
fn grouped(sizes: &[u64], pieces: Range<usize>, memory: u64) -> Vec<Vec<usize>> {
    let mut groups: Vec<Vec<usize>> = Vec::new();
    let mut filled: u64 = 0;
    for piece in pieces {
        let size = sizes[piece];
        match groups.last_mut() {
            Some(group) if filled.saturating_add(size) <= memory => {
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
    pub demands: &'a [Demand],
    pub division: &'a Division,
    state: Mutex<PartState>,
}

/// Outputs of the nodes that ran for a part; `None` of those to which nothing of it is left, and of nodes that run for the whole.
pub(super) type PartOutputs = Vec<Option<Done>>;

#[derive(Default)]
struct PartState {
    /// The part at hand.
    latest: Option<(usize, Arc<PartOutputs>)>,
    /// Values that nodes keep for all parts.
    shared: HashMap<(usize, TypeId), RetainedValue>,
    /// Diagonal of the bounding box of all parts, where a node found it.
    diagonal: Option<f64>,
    /// Parts that ran, for what is counted once.
    counted: BTreeSet<usize>,
    /// True once the nodes that read parts have prepared for it.
    has_begun: bool,
    /// True once all parts were gone through.
    has_ended: bool,
    /// Bounds of the grids of all parts that ran, by the node's place and its output.
    bounds: HashMap<(usize, usize), Option<[DVec3; 2]>>,
    notes: BTreeMap<usize, Diagnostics>,
}

impl<'a> PartRuns<'a> {
    /// Before any part is read.
    pub fn new(demands: &'a [Demand], division: &'a Division) -> PartRuns<'a> {
        PartRuns { demands, division, state: Mutex::default() }
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

    /// Outputs of the nodes for a part, where it is at hand; otherwise the outputs of another one are dropped, so that two are not held at
    /// a time.
    pub fn latest(&self, part: usize) -> Option<Arc<PartOutputs>> {
        let mut state = self.lock();
        let known =
            state.latest.as_ref().filter(|(latest, _)| *latest == part).map(|(_, known)| known.clone());
        if known.is_none() {
            state.latest = None;
        }
        known
    }

    pub fn set_latest(&self, part: usize, outputs: Arc<PartOutputs>) {
        self.lock().latest = Some((part, outputs));
    }

    /// Diagonal of the whole grid's bounding box, world units; `None` where no node looked at it.
    pub fn diagonal(&self) -> Option<f64> {
        self.lock().diagonal
    }

    pub fn set_diagonal(&self, diagonal: f64) {
        self.lock().diagonal = Some(diagonal);
    }

    /// True the first time that it is called.
    pub fn begins(&self) -> bool {
        !std::mem::replace(&mut self.lock().has_begun, true)
    }

    /// Notes that all parts were gone through.
    pub fn end(&self) {
        self.lock().has_ended = true;
    }

    /// Adds the bounds of a part's grid at an output.
    pub fn add_bounds(&self, output: (usize, usize), value: &Value) {
        let own = match value {
            Value::Grid(grid) => grid.bounds(),
            Value::Volume(volume) => volume.grid.bounds(),
            _ => return,
        };
        let mut state = self.lock();
        let known = state.bounds.entry(output).or_default();
        *known = extent::joined(*known, own);
    }

    /// Findings about all parts at an output; `None` until all parts were gone through.
    pub fn swept(&self, output: (usize, usize)) -> Option<SweptParts> {
        let state = self.lock();
        state.has_ended.then(|| SweptParts { bounds: state.bounds.get(&output).copied().flatten() })
    }

    /// True the first time that a part runs, for what is counted once.
    pub fn is_first_run(&self, part: usize) -> bool {
        self.lock().counted.insert(part)
    }

    /// Adds the diagnostics of a node's run for a part.
    pub fn add_notes(&self, place: usize, notes: Diagnostics) {
        self.lock().notes.entry(place).or_default().add_part(notes);
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

    /// Takes the diagnostics of the nodes that ran for parts, by their places, over all parts.
    pub fn take_notes(&self) -> BTreeMap<usize, Diagnostics> {
        std::mem::take(&mut self.lock().notes)
    }
}

/// Counts and warnings of a node on another process.
type OtherNotes = (BTreeMap<String, u64>, Vec<String>);

/// Adds to the diagnostics of nodes that work on parts those of the other processes, on the first one.
pub(super) fn gather_notes(notes: &mut BTreeMap<usize, Diagnostics>, ranks: &dyn Ranks) -> Result<()> {
    if ranks.count() == 1 {
        return Ok(());
    }
    let broken = |error| Error::run("another process sent a broken report").got(error);
    let of_node = |(place, own): (&usize, &Diagnostics)| {
        let counts = own.counts.iter().map(|(name, count)| (name.to_string(), *count)).collect();
        (*place, (counts, own.warnings.clone()))
    };
    let own: BTreeMap<usize, OtherNotes> = notes.iter().map(of_node).collect();
    let mut to_each = vec![Vec::new(); ranks.count()];
    if ranks.rank() > 0 {
        to_each[0] = serde_json::to_vec(&own).map_err(broken)?;
    }
    for bytes in ranks.exchange(to_each)?.iter().filter(|bytes| !bytes.is_empty()) {
        let others: BTreeMap<usize, OtherNotes> = serde_json::from_slice(bytes).map_err(broken)?;
        for (place, (counts, warnings)) in others {
            let counts = counts.into_iter().map(|(name, count)| (lasting(name), count)).collect();
            let mut other = Diagnostics::default();
            (other.counts, other.warnings) = (counts, warnings);
            notes.entry(place).or_default().add_part(other);
        }
    }
    Ok(())
}

/// A name of a count that lives as long as those in the program do; one memory for all runs.
fn lasting(name: String) -> &'static str {
    static NAMES: Mutex<BTreeSet<&'static str>> = Mutex::new(BTreeSet::new());
    let mut names = NAMES.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(known) = names.get(name.as_str()) {
        return known;
    }
    let name: &'static str = name.leak();
    names.insert(name);
    name
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
        assert_eq!(grouped(&[3, 3, 3, 3, 3], 0..5, 6), [vec![0, 1], vec![2, 3], vec![4]]);
        assert_eq!(grouped(&[9, 1, 1, 9], 0..4, 6), [vec![0], vec![1, 2], vec![3]]);
        assert_eq!(grouped(&[0, 0, 5], 0..3, 6), [vec![0, 1, 2]]);
        assert_eq!(grouped(&[9, 3, 3, 9], 1..3, 6), [vec![1, 2]]);
    }

    #[test]
    fn names_of_counts_are_kept_once() {
        let [first, again] = [(); 2].map(|()| lasting("cells".into()));
        assert!(std::ptr::eq(first, again) && first == "cells");
    }

    /// One of so many processes.
    #[derive(Debug)]
    struct One(usize, usize);

    impl Ranks for One {
        fn rank(&self) -> usize {
            self.0
        }

        fn count(&self) -> usize {
            self.1
        }

        fn exchange(&self, _to_each: Vec<Vec<u8>>) -> Result<Vec<Vec<u8>>> {
            Err(Error::run("nothing is sent"))
        }
    }

    #[test]
    fn processes_share_the_pieces_by_their_bytes() {
        let shares = |sizes: &[u64], count: usize| {
            (0..count).map(|rank| own_pieces(sizes, &One(rank, count))).collect::<Vec<_>>()
        };
        assert_eq!(shares(&[1; 6], 3), [0..2, 2..4, 4..6]);
        assert_eq!(shares(&[3, 1, 1, 1], 2), [0..1, 1..4]);
        // More processes than pieces: some have nothing.
        let many = shares(&[5, 5], 5);
        assert_eq!(many.iter().map(|own| own.len()).sum::<usize>(), 2);
        assert!(many.windows(2).all(|pair| pair[0].end == pair[1].start));
        assert_eq!(shares(&[0, 0], 2).iter().map(|own| own.len()).sum::<usize>(), 2);
    }
}
