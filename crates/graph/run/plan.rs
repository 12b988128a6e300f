//! The plan of a run: the outcome of the demand pass, and the nodes that ran.

use crate::api::context::PlanContext;
use crate::api::demand::{Arrays, Demand};
use crate::api::port::PortType;
use crate::api::value::{Revision, Value};
use crate::api::wiring::Edge;
use crate::build::graph::{Graph, GraphNode};
use voltet_core::diagnostics::Diagnostics;
use voltet_core::{Error, Result};

/// Plan of a run: the outcome of the demand pass, one entry a node of the graph.
#[derive(Debug, Default)]
pub struct Plan {
    /// Demand on each node.
    pub demands: Vec<Demand>,
    /// Diagnostics of each node's planning: the work that it skips, its engine.
    pub notes: Vec<Diagnostics>,
    /// The nodes that ran early.
    pub(super) early: Vec<Option<Done>>,
    /// True for a plan of an exhaustive session.
    pub(super) exhaustive: bool,
}

impl Plan {
    /// Records the work that nodes will skip, from the headers of their files; reads no data. Returns the indices of the nodes
    /// whose files do not say. An exhaustive session skips nothing.
    pub fn foresee(&mut self, graph: &Graph) -> Vec<usize> {
        if self.exhaustive {
            return Vec::new();
        }
        let mut unknown = Vec::new();
        for &i in &graph.order {
            let node = &graph.nodes[i];
            let (demand, notes) = (&self.demands[i], &mut self.notes[i]);
            let parameters = &node.parameters;
            let mut foresight = PlanContext { parameters, demand, notes, folder: &graph.folder };
            if (node.node.foresee)(&mut foresight).is_err() {
                unknown.push(i);
            }
        }
        unknown
    }
}

/// A node that ran.
#[derive(Debug, Clone)]
pub(super) struct Done {
    pub(super) outputs: Vec<(Value, Revision)>,
    pub(super) notes: Diagnostics,
    pub(super) seconds: f64,
    /// Seconds that the former run took, where its outputs were used.
    pub(super) reused: Option<f64>,
    /// True if the outputs are of a preview ([`crate::RunContext::mark_preview`]), or made from such.
    pub(super) is_passing: bool,
}

/// All that can be requested of a node: an order, of a grid every array and its cells, and where a volume is made of a grid,
/// every gradient.
pub(super) fn everything_of(node: &GraphNode) -> Demand {
    let (grid, gradient) = (node.gives(PortType::Grid), node.makes_volume());
    let arrays = if grid { Arrays::all() } else { Arrays::default() };
    Demand {
        cell_arrays: arrays.clone(),
        arrays,
        gradient_magnitude: gradient,
        gradient,
        order: true,
        file_cells: grid,
        cell_values: node.gives(PortType::CellValues),
        ..Demand::default()
    }
}

/// The values at a node's inputs. The order of work puts what feeds a node before it.
pub(super) fn inputs_of(node: &GraphNode, all_done: &[Option<Done>]) -> Vec<(Value, Revision)> {
    let made = node.inputs.iter().map(|edge| (all_done[edge.node].as_ref(), edge.output));
    made.filter_map(|(done, output)| Some(done?.outputs[output].clone())).collect()
}

/// A grid wired straight to a volume input has no gradient to give.
pub(super) fn refuse_missing_gradient(
    graph: &Graph,
    node: &GraphNode,
    edge: &Edge,
    ask: &Demand,
) -> Result<()> {
    let giving = &graph.nodes[edge.node];
    let given = giving.node.outputs[edge.output].port_type;
    let Some(taken) = node.node.all_inputs().nth(edge.port) else { return Ok(()) };
    if given == PortType::Grid
        && taken.port_type == PortType::Volume
        && (ask.gradient_magnitude || ask.gradient)
    {
        let draws = node.node.inputs.iter().any(|port| port.port_type == PortType::TransferFunction);
        let why = match (ask.gradient_magnitude, draws) {
            (true, true) => "the transfer function looks at the gradient magnitude",
            (true, false) => "the node looks at the gradient magnitude",
            (false, true) => "lighting and silhouettes need the gradient",
            (false, false) => "the node looks at the gradient",
        };
        let error = Error::usage(format!("{why}, but '{}' gives a grid without gradient", giving.name))
            .expected(format!(
                "a node of type \"gradient-magnitude\" between '{}' and the input '{}'",
                giving.name, taken.name
            ))
            .at_node(&node.name);
        return Err(edge.origin.locate(error));
    }
    Ok(())
}
