//! The plan of a run, the nodes that ran, and the report.

use crate::api::context::{DemandContext, PlanContext};
use crate::api::demand::{Arrays, Demand};
use crate::api::origins::{Origins, Stamp};
use crate::api::value::{Edge, PortType, Revision, Value};
use crate::build::graph::{Graph, GraphNode};
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;
use voltet_core::diagnostics::{DataFinding, Diagnostics, SkippedWork};
use voltet_core::parameters::SourceSpan;
use voltet_core::picture::Picture;
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

#[derive(Debug, Clone, Default)]
pub(super) struct Done {
    pub(super) outputs: Vec<(Value, Revision)>,
    /// The files that it depends on, as they were before it ran.
    pub(super) files: Vec<(PathBuf, Stamp)>,
    pub(super) notes: Diagnostics,
    pub(super) seconds: f64,
    /// Seconds that the former run took, where its outputs were used.
    pub(super) reused: Option<f64>,
    /// True if the outputs are of a preview ([`crate::RunContext::mark_preview`]), or made from such.
    pub(super) is_preview: bool,
}

/// All that can be requested of a node: an order, of a grid every array and its cells, and where a volume is made of a grid,
/// every gradient.
pub(super) fn everything_of(node: &GraphNode) -> Demand {
    let (grid, gradient) = (node.gives(PortType::Grid), node.makes_volume());
    let arrays = Arrays { and_all_others: grid, ..Arrays::default() };
    Demand {
        cell_arrays: arrays.clone(),
        arrays,
        gradient_magnitude: gradient,
        gradient,
        // Nor is a scalar requested that another replaces: it might not be there.
        without_scalar: true,
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

/// Demands of a node on its inputs for a demand on it. `early`: the value of an edge or its stand-in, where there is one, and whether
/// it is the value. Errors: those of the node; a gradient asked of a grid.
pub(super) fn asks_of(
    graph: &Graph,
    node: &GraphNode,
    asked: &Demand,
    notes: &mut Diagnostics,
    early: impl Fn(&Edge) -> (Option<Value>, bool),
) -> Result<Vec<Demand>> {
    let (early, is_known) = node.inputs.iter().map(early).unzip();
    let asked = &Demand { without_tetrahedra: false, ..asked.clone() };
    let output_type = |edge: &Edge| graph.nodes[edge.node].node.outputs[edge.output].port_type;
    let mut asking = DemandContext {
        parameters: &node.parameters,
        asked,
        notes,
        wiring: node.wiring(),
        early,
        is_known,
        fed: node.inputs.iter().map(output_type).collect(),
        asks: vec![None; node.inputs.len()],
    };
    (node.node.demand)(&mut asking).map_err(|error| node.locate(error))?;
    let DemandContext { asks, early, .. } = asking;
    let mut asks: Vec<Demand> = asks.into_iter().map(Option::unwrap_or_default).collect();
    state_origins(graph, node, &early, &mut asks);
    node.inputs
        .iter()
        .zip(&asks)
        .try_for_each(|(edge, ask)| refuse_missing_gradient(graph, node, edge, ask))?;
    Ok(asks)
}

/// States which node names each array that a node asks for: one that it was asked for, a transfer function that it draws, or itself.
fn state_origins(graph: &Graph, node: &GraphNode, early: &[Option<Value>], asks: &mut [Demand]) {
    // A node of a program is none that a user could mend.
    if matches!(node.origin, SourceSpan::Nowhere) {
        return;
    }
    for ask in asks {
        for (edge, value) in node.inputs.iter().zip(early) {
            if let Some(Value::TransferFunction(look)) = value {
                let (giver, fields) = (&graph.nodes[edge.node], look.transfer_function.fields());
                ask.arrays.are_named_by(&giver.name, &giver.origin, |name| fields.contains(&name));
            }
        }
        for arrays in [&mut ask.arrays, &mut ask.cell_arrays] {
            arrays.are_named_by(&node.name, &node.origin, |_| true);
        }
    }
}

/// A grid wired straight to a volume input has no gradient to give.
fn refuse_missing_gradient(graph: &Graph, node: &GraphNode, edge: &Edge, ask: &Demand) -> Result<()> {
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

/// One node in the report of a run.
#[derive(Debug, Clone, Serialize)]
pub struct NodeReport {
    /// Its name in the pipeline.
    pub name: String,
    /// Its type.
    #[serde(rename = "type")]
    pub node_type: String,
    /// Seconds it took in this run; 0 where a former output was used.
    pub seconds: f64,
    /// True if a former output was used.
    pub reused: bool,
    /// Seconds of the stages within.
    pub stages: BTreeMap<String, f64>,
    /// Its counts.
    pub counts: BTreeMap<&'static str, u64>,
    /// The engine that it took.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub engine: Option<String>,
}

/// Report of a run.
#[derive(Debug, Clone, Default)]
pub struct RunReport {
    /// The nodes in the order in which they ran.
    pub nodes: Vec<NodeReport>,
    /// Counts of all nodes together.
    pub counts: BTreeMap<&'static str, u64>,
    /// Skipped work.
    pub skipped: Vec<SkippedWork>,
    /// Warnings for the user.
    pub warnings: Vec<String>,
    /// Facts about the data.
    pub findings: Vec<DataFinding>,
    /// The engine that drew, and the reason for it.
    pub engine: Option<(String, String)>,
    /// The device, or the vector units and threads, that it ran on.
    pub adapter: Option<String>,
    /// The compositor of a device, and the reason for it.
    pub compositor: Option<(String, String)>,
    /// Files written.
    pub files: Vec<String>,
    /// The pictures that were made, each with the name of its node.
    pub pictures: Vec<(String, Arc<Picture>)>,
    /// Origins of all values.
    pub origins: Origins,
    /// Seconds of the whole run.
    pub seconds: f64,
    /// True for a preview: the same run by itself would give other outputs by rounding ([`crate::Session::run_preview`]).
    pub is_preview: bool,
}

impl RunReport {
    /// Adds a node that ran, or whose former outputs were used.
    pub(super) fn add(&mut self, name: &str, node_type: &str, done: &Done) {
        let Done { notes, seconds, reused, outputs, is_preview, files: _ } = done;
        self.is_preview |= is_preview;
        let pictures =
            outputs.iter().filter_map(|(value, _)| Some((name.to_string(), value.picture()?.clone())));
        self.pictures.extend(pictures);
        let mut stages = BTreeMap::new();
        for (stage, seconds) in notes.stages.iter().filter(|_| reused.is_none()) {
            *stages.entry(stage.clone()).or_insert(0.0) += seconds;
        }
        for (&count, n) in &notes.counts {
            *self.counts.entry(count).or_insert(0) += n;
        }
        let named = |left: &SkippedWork| SkippedWork { node: name.into(), ..left.clone() };
        self.skipped.extend(notes.skipped.iter().map(named));
        let named = |finding: &DataFinding| DataFinding { node: name.into(), ..finding.clone() };
        self.findings.extend(notes.findings.iter().map(named));
        self.warnings.extend(notes.warnings.iter().map(|warning| format!("{name}: {warning}")));
        self.engine = self.engine.take().or_else(|| notes.engine.clone());
        self.adapter = self.adapter.take().or_else(|| notes.adapter.clone());
        self.compositor = self.compositor.take().or_else(|| notes.compositor.clone());
        self.files.extend(notes.files.iter().cloned());
        self.nodes.push(NodeReport {
            name: name.into(),
            node_type: node_type.into(),
            seconds: *seconds,
            reused: reused.is_some(),
            stages,
            counts: notes.counts.clone(),
            engine: notes.engine.as_ref().map(|e| e.0.clone()),
        });
    }
}
