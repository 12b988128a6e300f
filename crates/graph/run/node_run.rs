//! Services of a session to one running node: the origins of values, and the steps of the time series that feed it.

use super::cache::{Key, Store, stamped};
use super::parts::{Division, PartOutputs, PartRuns};
use super::plan::{Done, asks_of, inputs_of};
use crate::api::context::{Make, PartCallback, Preparation, RetainedValue, RunContext, RunServices};
use crate::api::demand::Demand;
use crate::api::node::Steps;
use crate::api::observer::{NodeProgress, Observer};
use crate::api::origins::{FileRead, FileStamp, Origins, Stamp};
use crate::api::parts::{GridPart, PIECES_READ, SweptParts};
use crate::api::ranks::Ranks;
use crate::api::value::{Edge, PortType, Revision, Value, diagonal};
use crate::build::graph::{Graph, GraphNode};
use std::any::TypeId;
use std::cell::Cell;
use std::collections::{BTreeSet, HashMap};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use voltet_core::diagnostics::Diagnostics;
use voltet_core::parameters::Parameters;
use voltet_core::progress::Progress;
use voltet_core::{Error, Result};

struct FeedingNode {
    place: usize,
    /// Its parameters at each step; those alone where it reads no series.
    parameters: Vec<Parameters>,
    demand: Demand,
}

pub(super) struct NodeRun<'a> {
    pub graph: &'a Graph,
    /// Index of the node in the graph.
    pub place: usize,
    /// Nodes that ran before.
    pub done: &'a [Option<Done>],
    pub store: &'a Store,
    pub file_stamp: FileStamp,
    pub observer: &'a dyn Observer,
    /// Runs of the nodes that give parts of a grid, where one is read in parts.
    pub part_runs: Option<&'a PartRuns<'a>>,
    pub part: Option<&'a GridPart>,
    pub ranks: &'a dyn Ranks,
}

impl<'a> NodeRun<'a> {
    fn node(&self) -> &'a GraphNode {
        &self.graph.nodes[self.place]
    }

    /// The context for the node's own functions.
    pub fn context<'c>(
        &'c self,
        parameters: &'c Parameters,
        demand: &'c Demand,
        inputs: Vec<(Value, Revision)>,
        (exhaustive, allows_preview): (bool, bool),
    ) -> RunContext<'c> {
        RunContext {
            parameters,
            demand,
            notes: Diagnostics::new(exhaustive),
            wiring: self.node().wiring(),
            inputs,
            folder: &self.graph.folder,
            stated: &self.graph.stated,
            progress: self.progress(),
            services: self,
            reads_pipeline: Cell::new(false),
            allows_preview,
            is_preview: Cell::new(false),
        }
    }

    /// Runs the nodes that give parts for one of them.
    fn run_part(&self, runs: &PartRuns, part: usize) -> Result<PartOutputs> {
        let (store, is_mapped) = (self.store.for_one_step(), &runs.division.is_mapped);
        let is_first = runs.is_first_run(part);
        let mut last_revision = 0;
        let whole = |(done, &is_mapped): (&Option<Done>, &bool)| done.clone().filter(|_| !is_mapped);
        let mut all_done: Vec<Option<Done>> = self.done.iter().zip(is_mapped).map(whole).collect();
        for &place in self.graph.order.iter().filter(|&&place| is_mapped[place]) {
            self.progress().check_cancelled()?;
            let node = &self.graph.nodes[place];
            // A node that leaves nothing of a part ends the way of those that look at what it gives.
            if node.inputs.iter().any(|edge| is_mapped[edge.node] && all_done[edge.node].is_none()) {
                continue;
            }
            let grid_part = Some(&runs.division.parts[part]);
            let run = NodeRun { place, done: &all_done, store: &store, part: grid_part, ..*self };
            let inputs = inputs_of(node, &all_done);
            let mut call = run.context(&node.parameters, &runs.demands[place], inputs, (false, false));
            let values = node.run(&mut call)?;
            let mut notes = std::mem::take(&mut call.notes);
            if !is_first {
                // Of what is done again, the reading alone counts again.
                let reads = notes.counts.remove(PIECES_READ);
                notes = Diagnostics::default();
                notes.counts.extend(reads.map(|reads| (PIECES_READ, reads)));
            }
            runs.add_notes(place, notes);
            if values.is_empty() {
                continue;
            }
            for (output, value) in values.iter().enumerate() {
                runs.add_bounds((place, output), value);
            }
            all_done[place] = Some(with_revisions(values, &mut last_revision));
        }
        let of_part = |(done, &is_mapped): (Option<Done>, &bool)| done.filter(|_| is_mapped);
        Ok(all_done.into_iter().zip(is_mapped).map(of_part).collect())
    }

    fn progress(&self) -> NodeProgress<'a> {
        NodeProgress { observer: self.observer, node: &self.node().name }
    }

    /// The node and the output that feed an edge.
    fn source(&self, edge: usize) -> (usize, usize) {
        let edge = &self.node().inputs[edge];
        (edge.node, edge.output)
    }

    /// The nodes upstream of an edge, in the order of work, and the number of steps.
    fn feeding(&self, edge: usize, demand: &Demand) -> Result<(Vec<FeedingNode>, usize)> {
        let graph = self.graph;
        let mut demands: Vec<Option<Demand>> = vec![None; graph.nodes.len()];
        demands[self.source(edge).0] = Some(demand.clone());
        let mut feeding = Vec::new();
        for &place in graph.order.iter().rev() {
            let Some(demand) = demands[place].take() else { continue };
            let node = &graph.nodes[place];
            let asks = asks_of(graph, node, &demand, &mut Diagnostics::default(), |_| (None, false))?;
            for (edge, ask) in node.inputs.iter().zip(asks) {
                ask.add_to(&mut demands[edge.node]);
            }
            feeding.push(FeedingNode { place, parameters: Vec::new(), demand });
        }
        feeding.reverse();
        let mut series: Option<(&str, usize, usize)> = None;
        for FeedingNode { place, parameters, .. } in &mut feeding {
            let node = &graph.nodes[*place];
            let read = graph.time_series(*place)?;
            let own_step = read.own;
            *parameters = read.steps;
            match (series, parameters.len()) {
                (_, 1) => {}
                (Some((other, count, _)), own) if own != count => {
                    let error = Error::usage("two time series have different numbers of steps");
                    let found = format!("{count} of '{other}' and {own} of '{}'", node.name);
                    return Err(node.locate(error.got(found).expected("series of the same length")));
                }
                (Some((other, _, step)), _) if own_step != step => {
                    let error = Error::usage(
                        "all steps of two time series are needed, which are read at different steps",
                    );
                    let found = format!("step {step} of '{other}' and step {own_step} of '{}'", node.name);
                    let accepted = "the same step of both, as they go on together; or numbers relative to this step alone";
                    return Err(node.locate(error.got(found).expected(accepted)));
                }
                (_, own) => series = Some((&node.name, own, own_step)),
            }
        }
        Ok((feeding, series.map_or(1, |(_, count, _)| count)))
    }

    /// Runs what feeds a port, at one step.
    fn value_at(
        &self,
        feeding: &[FeedingNode],
        (last, output): (usize, usize),
        step: usize,
    ) -> Result<Value> {
        let store = self.store.for_one_step();
        let mut last_revision = 0;
        let mut all_done: Vec<Option<Done>> = vec![None; self.graph.nodes.len()];
        for &FeedingNode { place: i, ref parameters, ref demand } in feeding {
            self.progress().check_cancelled()?;
            let node = &self.graph.nodes[i];
            let run = NodeRun { graph: self.graph, place: i, done: &all_done, store: &store, ..*self };
            let parameters = parameters.get(step).unwrap_or(&parameters[0]);
            let mut call = run.context(parameters, demand, inputs_of(node, &all_done), (false, false));
            let values = node.run(&mut call)?;
            all_done[i] = Some(with_revisions(values, &mut last_revision));
        }
        let value = all_done[last].as_ref().and_then(|done| done.outputs.get(output)).map(|o| o.0.clone());
        value.ok_or_else(|| Error::run("the node that feeds an input gave nothing"))
    }

    fn key(&self, edge: usize, feeding: Vec<FeedingNode>, value_type: TypeId) -> Key {
        let places: Vec<usize> = feeding.iter().map(|node| node.place).collect();
        let place = |node: usize| places.iter().position(|&i| i == node).unwrap_or_default();
        let of = |FeedingNode { place: i, parameters, demand }: FeedingNode| {
            let node = &self.graph.nodes[i];
            let edges = node.inputs.iter().map(|edge| (edge.port, place(edge.node), edge.output)).collect();
            let files = self.store.listed_files(
                self.graph,
                node,
                &node.parameters,
                (Steps::All, parameters.len()),
                self.file_stamp,
            );
            let (plugin, given) = (node.plugin().cloned(), node.given.clone());
            (node.node.name, parameters, edges, files, plugin, given, demand)
        };
        let (last, output) = self.source(edge);
        Key { nodes: feeding.into_iter().map(of).collect(), port: (place(last), output), value_type }
    }
}

impl RunServices for NodeRun<'_> {
    fn origins(&self) -> Origins {
        let known = (self.store, self.part_runs.and_then(PartRuns::diagonal));
        origins(self.graph, &upstream(self.graph, self.place), self.done, known, self.file_stamp)
    }

    fn get_or_make(&self, key: (Revision, TypeId), make: Make) -> Result<RetainedValue> {
        self.store.get_or_make(key, make)
    }

    fn step_count(&self, edge: usize) -> Result<usize> {
        Ok(self.feeding(edge, &Demand::default())?.1)
    }

    fn each_step(
        &self,
        edge: usize,
        demand: &Demand,
        steps: Option<&[usize]>,
        of_step: &mut dyn FnMut(usize, Value) -> Result<()>,
    ) -> Result<()> {
        let (feeding, step_count) = self.feeding(edge, demand)?;
        let all: Vec<usize> = steps.map_or_else(|| (0..step_count).collect(), <[usize]>::to_vec);
        for (place, &step) in all.iter().enumerate() {
            let fraction = place as f64 / all.len() as f64;
            self.progress().report(&format!("step {} of {}", place + 1, all.len()), fraction);
            let value = self
                .value_at(&feeding, self.source(edge), step)
                .map_err(|error| Error { what: format!("at time step {step}: {}", error.what), ..error })?;
            of_step(step, value)?;
        }
        Ok(())
    }

    fn keep_over_steps(
        &self,
        edge: usize,
        demand: &Demand,
        value_type: TypeId,
        make: Make,
    ) -> Result<RetainedValue> {
        let (feeding, _) = self.feeding(edge, demand)?;
        self.store.keep_over_steps(self.key(edge, feeding, value_type), make)
    }

    fn part(&self) -> Option<&GridPart> {
        self.part
    }

    fn begin_parts(&self) -> Result<()> {
        let Some(runs) = self.part_runs.filter(|runs| runs.begins()) else { return Ok(()) };
        let Division { is_mapped, parts } = runs.division;
        let sources = self.graph.order.iter().filter(|&&place| is_mapped[place]);
        for &place in sources.filter(|&&place| self.graph.nodes[place].inputs.is_empty()) {
            let node = &self.graph.nodes[place];
            let run = NodeRun { place, ..*self };
            let mut call = run.context(&node.parameters, &runs.demands[place], Vec::new(), (false, false));
            (node.node.begin_parts)(&mut call, parts).map_err(|error| node.locate(error))?;
            runs.add_notes(place, std::mem::take(&mut call.notes));
        }
        Ok(())
    }

    fn end_parts(&self) {
        self.part_runs.into_iter().for_each(PartRuns::end);
    }

    fn swept_parts(&self, edge: usize) -> Option<SweptParts> {
        self.part_runs?.swept(self.source(edge))
    }

    fn parts(&self) -> Vec<usize> {
        self.part_runs.map(PartRuns::order).unwrap_or_default()
    }

    fn with_part(&self, part: usize, of_part: &mut PartCallback) -> Result<()> {
        let Some(runs) = self.part_runs else { return Ok(()) };
        let outputs = match runs.latest(part) {
            Some(known) => known,
            None => {
                let outputs = Arc::new(self.run_part(runs, part)?);
                runs.set_latest(part, outputs.clone());
                outputs
            }
        };
        let is_missing = |edge: &Edge| runs.division.is_mapped[edge.node] && outputs[edge.node].is_none();
        if self.node().inputs.iter().any(is_missing) {
            return Ok(());
        }
        let all = outputs.iter().zip(self.done).map(|(own, whole)| own.clone().or_else(|| whole.clone()));
        let all: Vec<Option<Done>> = all.collect();
        let store = self.store.for_one_step();
        let run = NodeRun { done: &all, store: &store, part: Some(&runs.division.parts[part]), ..*self };
        of_part(&run, inputs_of(self.node(), &all))
    }

    fn ranks(&self) -> &dyn Ranks {
        self.ranks
    }

    fn set_diagonal(&self, diagonal: f64) {
        if let Some(runs) = self.part_runs {
            runs.set_diagonal(diagonal);
        }
    }

    fn keep_for_parts(&self, value_type: TypeId, make: Make) -> Result<RetainedValue> {
        match self.part_runs {
            Some(runs) => runs.keep((self.place, value_type), make),
            None => make(),
        }
    }
}

/// Outputs of a node that ran for one step or part, each with a revision of its own behind the last.
fn with_revisions(values: Vec<Value>, last: &mut u64) -> Done {
    let outputs = values.into_iter().map(|value| {
        *last += 1;
        (value, Revision(*last))
    });
    Done { outputs: outputs.collect(), ..Done::default() }
}

/// Origins of the values of these nodes, which ran. States of files are those before the nodes ran, or those now where they did not.
/// `diagonal_of_parts`: that of a grid in parts.
pub(super) fn origins(
    graph: &Graph,
    places: &[usize],
    done: &[Option<Done>],
    (store, diagonal_of_parts): (&Store, Option<f64>),
    now: FileStamp,
) -> Origins {
    let mut origins = Origins::default();
    let mut before: HashMap<&Path, Stamp> = HashMap::new();
    for (path, state) in places.iter().filter_map(|&place| done[place].as_ref()).flat_map(|done| &done.files)
    {
        // Of a file that changed between two nodes the first state: the values are not those of the last alone.
        before.entry(path).or_insert(*state);
    }
    let stamp = |path: &Path| before.get(path).copied().unwrap_or_else(|| now(path));
    let mut other_steps: BTreeSet<(usize, PathBuf)> = BTreeSet::new();
    for &place in places {
        let files = files_of_other_steps(graph, place, store, now);
        other_steps.extend(files.into_iter().map(|(reader, (path, _))| (reader, path)));
    }
    for &place in places {
        let node = &graph.nodes[place];
        let outputs = done[place].iter().flat_map(|done| &done.outputs);
        for (value, _) in outputs {
            if let Value::Camera(camera) = value {
                origins.cameras.push((node.name.clone(), camera.clone()));
            }
            if let Value::TransferFunction(look) = value {
                let by_data = || {
                    Some(
                        look.for_diagonal(drawn_with(graph, places, place, done).or(diagonal_of_parts)?)
                            .unit_distance,
                    )
                };
                let stated = look.transfer_function.unit_distance;
                let unit = if look.auto_unit_distance { by_data() } else { Some(stated) };
                origins.unit_distances.push((node.name.clone(), unit));
            }
        }
        origins.plugins.extend(node.plugin().map(|plugin| (node.name.clone(), plugin.clone())));
        let read = node.parameters.paths().into_iter().filter(|named| !named.written);
        // The first names the others.
        let preparation = Preparation { parameters: &node.parameters, folder: &graph.folder };
        let mut beside = stamped((node.node.files_beside)(&preparation, Steps::Read), stamp);
        let is_named = |path: &PathBuf| read.clone().any(|named| named.from(&graph.folder) == *path);
        let own_steps = other_steps.iter().filter(|(reader, path)| *reader == place && !is_named(path));
        let mut own_steps = stamped(own_steps.map(|(_, path)| path.clone()), stamp);
        origins.files.extend(read.map(|named| {
            let path = named.from(&graph.folder);
            let (beside, other_steps) = (std::mem::take(&mut beside), std::mem::take(&mut own_steps));
            FileRead { node: node.name.clone(), stamp: stamp(&path), named, path, beside, other_steps }
        }));
    }
    origins
}

/// The files of the other steps that a node (its place) looks at, each with the place of the node that reads it. None where
/// headers do not tell: the run says why.
pub(super) fn files_of_other_steps(
    graph: &Graph,
    place: usize,
    store: &Store,
    stamp: FileStamp,
) -> Vec<(usize, (PathBuf, Stamp))> {
    let node = &graph.nodes[place];
    let steps = |count: usize| (node.node.other_steps)(&node.parameters, count);
    let mut files = Vec::new();
    // Without need no file is opened.
    if steps(2).is_empty() {
        return files;
    }
    for reader in upstream(graph, place) {
        let Ok(series) = graph.time_series(reader) else { continue };
        let (count, own) = (series.steps.len(), &graph.nodes[reader]);
        let wanted = if count > 1 { steps(count) } else { Vec::new() };
        let listed = |parameters, steps| store.listed_files(graph, own, parameters, (steps, count), stamp);
        let all: Vec<(PathBuf, Stamp)> = match wanted.len() == count {
            true => listed(&own.parameters, Steps::All),
            false => wanted.iter().flat_map(|&k| listed(&series.steps[k], Steps::Read)).collect(),
        };
        files.extend(all.into_iter().map(|file| (reader, file)));
    }
    files.sort();
    files.dedup();
    files
}

/// The diagonal of the volume that is drawn with the transfer function of a node.
fn drawn_with(graph: &Graph, places: &[usize], look: usize, done: &[Option<Done>]) -> Option<f64> {
    places.iter().find_map(|&place| {
        let node = &graph.nodes[place];
        node.inputs.iter().find(|edge| edge.node == look)?;
        let port = |k: usize| node.node.all_inputs().nth(k).map(|port| port.port_type);
        let volume = node.inputs.iter().find(|edge| port(edge.port) == Some(PortType::Volume))?;
        let (value, _) = done[volume.node].as_ref()?.outputs.get(volume.output)?;
        Some(diagonal(value.volume()?.ok()?.grid.bounds()))
    })
}

/// A node and all that feeds it, each after what feeds it.
pub(super) fn upstream(graph: &Graph, place: usize) -> Vec<usize> {
    let mut needed = vec![false; graph.nodes.len()];
    needed[place] = true;
    for &i in graph.order.iter().rev().filter(|&&i| i != place) {
        needed[i] =
            (0..needed.len()).any(|k| needed[k] && graph.nodes[k].inputs.iter().any(|edge| edge.node == i));
    }
    graph.order.iter().copied().filter(|&i| needed[i]).collect()
}
