//! Services of a session to one running node: the origins of values, and the steps of the time series that feed it.

use super::cache::{Key, Store, files_of, stamped};
use super::plan::{Done, asks_of, inputs_of};
use crate::api::context::{NodeProgress, Observer, Preparation, RetainedValue, RunContext, RunServices};
use crate::api::demand::Demand;
use crate::api::node::Steps;
use crate::api::origins::{FileRead, FileStamp, Origins, ResolvedPipeline};
use crate::api::value::{PortType, Revision, Value, diagonal};
use crate::build::graph::{Graph, GraphNode};
use std::any::TypeId;
use std::cell::Cell;
use voltet_core::diagnostics::Diagnostics;
use voltet_core::parameters::Parameters;
use voltet_core::progress::Progress;
use voltet_core::{Error, Result};

/// Nodes upstream of an input, with their parameters at each step and their demands.
struct Feeding {
    /// Places in the graph, in the order of work.
    nodes: Vec<usize>,
    /// The parameters at each step; one for a node that reads no series.
    parameters: Vec<Vec<Parameters>>,
    demands: Vec<Demand>,
    step_count: usize,
}

/// One run of a node by a session.
pub(super) struct NodeRun<'a> {
    pub graph: &'a Graph,
    /// Index of the node in the graph.
    pub place: usize,
    /// Nodes that ran before.
    pub done: &'a [Option<Done>],
    pub store: &'a Store,
    pub file_stamp: FileStamp,
    pub observer: &'a dyn Observer,
}

impl<'a> NodeRun<'a> {
    /// The node.
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
            progress: self.progress(),
            services: self,
            reads_pipeline: Cell::new(false),
            allows_preview,
            is_preview: Cell::new(false),
        }
    }

    fn progress(&self) -> NodeProgress<'a> {
        NodeProgress { observer: self.observer, node: &self.node().name }
    }

    /// The node and the output that feed an edge.
    fn source(&self, edge: usize) -> (usize, usize) {
        let edge = &self.node().inputs[edge];
        (edge.node, edge.output)
    }

    fn feeding(&self, edge: usize, demand: &Demand) -> Result<Feeding> {
        let graph = self.graph;
        let (last, _) = self.source(edge);
        let mut needed = vec![false; graph.nodes.len()];
        needed[last] = true;
        let mut demands = vec![Demand::default(); graph.nodes.len()];
        demands[last] = demand.clone();
        let mut nodes = Vec::new();
        for &i in graph.order.iter().rev() {
            if !needed[i] {
                continue;
            }
            nodes.push(i);
            let node = &graph.nodes[i];
            let notes = &mut Diagnostics::default();
            let asks = asks_of(graph, node, &demands[i], notes, |_| (None, false))?;
            for (edge, ask) in node.inputs.iter().zip(asks) {
                needed[edge.node] = true;
                demands[edge.node].join(&ask);
            }
        }
        nodes.reverse();
        let mut parameters = Vec::new();
        let mut series: Option<(&str, usize)> = None;
        for &i in &nodes {
            let node = &graph.nodes[i];
            let preparation = Preparation { parameters: &node.parameters, folder: &graph.folder };
            let steps = (node.node.steps)(&preparation).map_err(|error| node.locate(error))?;
            match (series, steps.len()) {
                (_, 1) => {}
                (Some((other, count)), own) if own != count => {
                    let error = Error::usage("two time series have different numbers of steps");
                    let found = format!("{count} of '{other}' and {own} of '{}'", node.name);
                    return Err(node.locate(error.got(found).expected("series of the same length")));
                }
                (_, own) => series = Some((&node.name, own)),
            }
            parameters.push(steps);
        }
        let step_count = series.map_or(1, |(_, count)| count);
        let demands = nodes.iter().map(|&i| demands[i].clone()).collect();
        Ok(Feeding { nodes, parameters, demands, step_count })
    }

    /// Runs what feeds a port, at one step.
    fn value_at(&self, feeding: &Feeding, (last, output): (usize, usize), step: usize) -> Result<Value> {
        // Nothing that is kept would serve another step.
        let store = Store::default();
        let mut revision = 0;
        let mut all_done: Vec<Option<Done>> = vec![None; self.graph.nodes.len()];
        for ((&i, parameters), demand) in feeding.nodes.iter().zip(&feeding.parameters).zip(&feeding.demands)
        {
            if self.progress().cancelled() {
                return Err(Error::cancelled());
            }
            let node = &self.graph.nodes[i];
            let run = NodeRun { graph: self.graph, place: i, done: &all_done, store: &store, ..*self };
            let parameters = parameters.get(step).unwrap_or(&parameters[0]);
            let mut call = run.context(parameters, demand, inputs_of(node, &all_done), (false, false));
            let values = node.run(&mut call)?;
            let outputs = values.into_iter().map(|value| {
                revision += 1;
                (value, Revision(revision))
            });
            all_done[i] = Some(Done { outputs: outputs.collect(), ..Done::default() });
        }
        let value = all_done[last].as_ref().and_then(|done| done.outputs.get(output)).map(|o| o.0.clone());
        value.ok_or_else(|| Error::run("the node that feeds an input gave nothing"))
    }

    fn key(&self, edge: usize, feeding: &Feeding) -> Result<Key> {
        let place = |node: usize| feeding.nodes.iter().position(|&i| i == node).unwrap_or_default();
        let of = |(&i, parameters): (&usize, &Vec<Parameters>)| {
            let node = &self.graph.nodes[i];
            let edges = node.inputs.iter().map(|edge| (edge.port, place(edge.node), edge.output)).collect();
            let files =
                files_of((node.node, &node.parameters), Steps::All, &self.graph.folder, self.file_stamp);
            (node.node.name, parameters.clone(), edges, files, node.plugin().cloned(), node.given.clone())
        };
        let nodes = feeding.nodes.iter().zip(&feeding.parameters).map(of).collect();
        let (last, output) = self.source(edge);
        Ok(Key { nodes, demands: feeding.demands.clone(), port: (place(last), output) })
    }
}

impl RunServices for NodeRun<'_> {
    fn origins(&self) -> Origins {
        origins(self.graph, &upstream(self.graph, self.place), self.done, self.file_stamp)
    }

    fn pipeline(&self) -> &ResolvedPipeline {
        &self.graph.stated
    }

    fn get_or_make(
        &self,
        key: (Revision, TypeId),
        make: &mut dyn FnMut() -> Result<RetainedValue>,
    ) -> Result<RetainedValue> {
        self.store.get_or_make(key, make)
    }

    fn step_count(&self, edge: usize) -> Result<usize> {
        Ok(self.feeding(edge, &Demand::default())?.step_count)
    }

    fn each_step(
        &self,
        edge: usize,
        demand: &Demand,
        of_step: &mut dyn FnMut(usize, Value) -> Result<()>,
    ) -> Result<()> {
        let feeding = self.feeding(edge, demand)?;
        for step in 0..feeding.step_count {
            let fraction = step as f64 / feeding.step_count as f64;
            self.progress().report(&format!("step {} of {}", step + 1, feeding.step_count), fraction);
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
        make: &mut dyn FnMut() -> Result<RetainedValue>,
    ) -> Result<RetainedValue> {
        let key = self.key(edge, &self.feeding(edge, demand)?)?;
        if let Some(kept) = self.store.over_steps(&key) {
            return Ok(kept);
        }
        let made = make()?;
        self.store.keep_over_steps(key, made.clone());
        Ok(made)
    }
}

/// Origins of the values of these nodes, which ran.
pub(super) fn origins(graph: &Graph, places: &[usize], done: &[Option<Done>], stamp: FileStamp) -> Origins {
    let mut origins = Origins::default();
    for &place in places {
        let node = &graph.nodes[place];
        let outputs = done[place].iter().flat_map(|done| &done.outputs);
        for (value, _) in outputs {
            if let Value::Camera(camera) = value {
                origins.cameras.push((node.name.clone(), camera.clone()));
            }
            if let Value::TransferFunction(look) = value {
                let by_data =
                    || Some(look.for_diagonal(drawn_with(graph, places, place, done)?).unit_distance);
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
        origins.files.extend(read.map(|named| {
            let path = named.from(&graph.folder);
            let beside = std::mem::take(&mut beside);
            FileRead { node: node.name.clone(), stamp: stamp(&path), named, path, beside }
        }));
    }
    origins
}

/// The diagonal of the volume that is drawn with the transfer function of a node.
fn drawn_with(graph: &Graph, places: &[usize], look: usize, done: &[Option<Done>]) -> Option<f64> {
    places.iter().find_map(|&place| {
        let node = &graph.nodes[place];
        node.inputs.iter().find(|edge| edge.node == look)?;
        let port = |k: usize| node.node.all_inputs().nth(k).map(|port| port.port_type);
        let volume = node.inputs.iter().find(|edge| port(edge.port) == Some(PortType::Volume))?;
        let (value, _) = done[volume.node].as_ref()?.outputs.get(volume.output)?;
        Some(diagonal(&value.volume()?.ok()?.grid.points))
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
