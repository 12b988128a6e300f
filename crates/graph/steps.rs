//! The steps of a time series: what an input would carry at each of them.

use super::builder::{Graph, GraphNode};
use super::cache::{Key, Store, files_of};
use super::call::{DemandContext, NodeProgress, Preparation, RunContext};
use super::declaration::Steps;
use super::demand::{Demand, Done};
use super::session::{inputs_of, refuse_missing_gradient};
use super::value::{Revision, Value};
use std::cell::Cell;
use std::sync::Arc;
use voltet_core::diagnostics::Diagnostics;
use voltet_core::parameters::Parameters;
use voltet_core::{Error, Result};

/// What feeds an input: the nodes, with their parameters at each step, and what is asked of them.
struct Feeding {
    /// Places in the graph, in the order of work.
    nodes: Vec<usize>,
    /// The parameters at each step; one for a node that reads no series.
    parameters: Vec<Vec<Parameters>>,
    demands: Vec<Demand>,
    step_count: usize,
}

impl RunContext<'_> {
    /// The number of steps of the time series that feeds an input; 1 where none does.
    pub fn step_count(&self, port: &str) -> Result<usize> {
        Ok(self.feeding(port, &Demand::default())?.step_count)
    }

    /// Hands what an input would carry at each step of the time series that feeds it to `of_step`, one after the other: what
    /// feeds it runs for each step, for this demand alone, and nothing of it is kept.
    ///
    /// Errors: those of the nodes, with the step; series of different lengths.
    pub fn each_step(
        &self,
        port: &str,
        demand: &Demand,
        of_step: &mut dyn FnMut(usize, Value) -> Result<()>,
    ) -> Result<()> {
        let feeding = self.feeding(port, demand)?;
        let place = self.place_of(port)?;
        for step in 0..feeding.step_count {
            let fraction = step as f64 / feeding.step_count as f64;
            self.progress().report(&format!("step {} of {}", step + 1, feeding.step_count), fraction);
            let value = self
                .value_at(&feeding, place, step)
                .map_err(|error| Error { what: format!("at time step {step}: {}", error.what), ..error })?;
            of_step(step, value)?;
        }
        Ok(())
    }

    /// Something made over all steps of what feeds an input, kept by what it was made from as long as the session.
    pub fn keep_over_steps<T: Send + Sync + 'static>(
        &self,
        port: &str,
        demand: &Demand,
        make: impl FnOnce() -> Result<T>,
    ) -> Result<Arc<T>> {
        if self.exhaustive() {
            return Ok(Arc::new(make()?));
        }
        let key = self.key(port, &self.feeding(port, demand)?)?;
        if let Some(Ok(kept)) = self.store.over_steps(&key).map(Arc::downcast::<T>) {
            return Ok(kept);
        }
        let made = Arc::new(make()?);
        self.store.keep_over_steps(key, made.clone());
        Ok(made)
    }

    /// The node and the output that feed a port.
    fn place_of(&self, port: &str) -> Result<(usize, usize)> {
        let none = || Error::run(format!("the node looks at its input '{port}', which is not wired"));
        let edge = self.node.edges(port)?.next().ok_or_else(none)?;
        let edge = &self.node.inputs[edge];
        Ok((edge.node, edge.output))
    }

    fn feeding(&self, port: &str, demand: &Demand) -> Result<Feeding> {
        let graph = self.graph;
        let (last, _) = self.place_of(port)?;
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
            for (edge, ask) in node.inputs.iter().zip(asks_of(graph, node, &demands[i])?) {
                refuse_missing_gradient(graph, node, edge, &ask)?;
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
            let mut call = RunContext {
                parameters: parameters.get(step).unwrap_or(&parameters[0]),
                demand,
                notes: Diagnostics::default(),
                node,
                graph: self.graph,
                place: i,
                done: &all_done,
                is_told: Cell::new(false),
                may_pass: false,
                is_passing: Cell::new(false),
                file_stamp: self.file_stamp,
                inputs: inputs_of(node, &all_done),
                folder: self.folder,
                store: &store,
                progress: NodeProgress { observer: self.progress.observer, node: &node.name },
            };
            let values = node.run(&mut call)?;
            let outputs = values.into_iter().map(|value| {
                revision += 1;
                (value, Revision(revision))
            });
            let outputs = outputs.collect();
            all_done[i] = Some(Done {
                outputs,
                notes: Diagnostics::default(),
                seconds: 0.0,
                reused: None,
                is_passing: false,
            });
        }
        let value = all_done[last].as_ref().and_then(|done| done.outputs.get(output)).map(|o| o.0.clone());
        value.ok_or_else(|| Error::run("the node that feeds an input gave nothing"))
    }

    fn key(&self, port: &str, feeding: &Feeding) -> Result<Key> {
        let place = |node: usize| feeding.nodes.iter().position(|&i| i == node).unwrap_or_default();
        let of = |(&i, parameters): (&usize, &Vec<Parameters>)| {
            let node = &self.graph.nodes[i];
            let edges = node.inputs.iter().map(|edge| (edge.port, place(edge.node), edge.output)).collect();
            let files = files_of((node.node, &node.parameters), Steps::All, self.folder, self.file_stamp);
            (node.node.name, parameters.clone(), edges, files, node.plugin().cloned(), node.given.clone())
        };
        let nodes = feeding.nodes.iter().zip(&feeding.parameters).map(of).collect();
        let (last, output) = self.place_of(port)?;
        Ok(Key { nodes, demands: feeding.demands.clone(), port: (place(last), output) })
    }
}

/// What a node asks of its inputs for what is asked of it.
fn asks_of(graph: &Graph, node: &GraphNode, asked: &Demand) -> Result<Vec<Demand>> {
    let fed = node.inputs.iter().map(|edge| graph.nodes[edge.node].node.outputs[edge.output].port_type);
    let mut asking = DemandContext {
        parameters: &node.parameters,
        asked,
        notes: &mut Diagnostics::default(),
        node,
        early: vec![None; node.inputs.len()],
        is_known: vec![false; node.inputs.len()],
        fed: fed.collect(),
        asks: vec![Demand::default(); node.inputs.len()],
    };
    (node.node.demand)(&mut asking).map_err(|error| node.locate(error))?;
    Ok(asking.asks)
}
