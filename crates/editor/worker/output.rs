//! Output of the worker: the picture, the states of its nodes, and the answers to queries.

use super::comparison::{Estimate, PreviewQuery, ShareQuery};
use super::distribution::DistributionQuery;
use super::probing::{ProbeQuery, SectionQuery};
use super::query::Exchange;
use super::request::{Change, Pixels, RenderRequest, Values, WIRES};
use glam::DVec3;
use std::collections::BTreeMap;
use std::sync::Arc;
use voltet_core::Error;
use voltet_core::error::ErrorKind;
use voltet_document::links::upstream;
use voltet_graph::RunReport;

#[derive(Debug, Clone, PartialEq)]
pub(crate) enum NodeState {
    /// It did not run yet for what is wanted now.
    Stale,
    /// It runs: its stage, and how much of that is done (0 … 1).
    Running(String, f64),
    /// Its outputs are those of what is wanted.
    Fresh,
    Failed(String),
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct NodeStatus {
    pub state: NodeState,
    /// Seconds that its outputs took when they were made last.
    pub seconds: Option<f64>,
}

pub(crate) type Preview = Exchange<PreviewQuery>;

/// Latest output of the worker.
#[derive(Default)]
pub struct WorkerOutput {
    /// The newest picture.
    pub pixels: Option<Pixels>,
    /// The nodes that feed the picture; the others are not needed for it.
    pub(crate) nodes: BTreeMap<String, NodeStatus>,
    /// Reason why there is no newer picture.
    pub failure: Option<Error>,
    /// The number of the newest request that came to a picture or failed.
    pub(crate) answered: u64,
    /// True if something newer than the picture is being drawn.
    pub is_busy: bool,
    /// Seconds of the last full picture, and of the last coarse one or preview.
    pub(crate) seconds: [Option<f64>; 2],
    /// The last full run's report, without its pictures.
    pub(crate) report: Option<Arc<RunReport>>,
    /// For each output, `"node.port"`, what runs through it.
    pub(crate) values: Arc<BTreeMap<String, String>>,
    /// Least and greatest coordinates of the data.
    pub(crate) bounds: Option<[DVec3; 2]>,
    /// Least and greatest coordinates at each output, `"node.port"`.
    pub(crate) output_bounds: Arc<BTreeMap<String, [DVec3; 2]>>,
    pub(crate) probe: Exchange<ProbeQuery>,
    /// Probe of the place under the pointer.
    pub(crate) hover: Exchange<ProbeQuery>,
    pub(crate) section: Exchange<SectionQuery>,
    pub(crate) estimate: Exchange<Estimate>,
    pub(crate) distribution: Exchange<DistributionQuery>,
    pub(crate) share: Exchange<ShareQuery>,
    /// Small pictures of nodes that are not shown at large, by their names.
    pub(crate) previews: BTreeMap<String, Preview>,
    number: u64,
    wanted: Option<RenderRequest>,
    /// Requests of lower numbers are of a document that was forgotten.
    first: u64,
}

impl WorkerOutput {
    /// Output of a document whose requests have this number or higher ones.
    pub(super) fn from(first: u64) -> WorkerOutput {
        WorkerOutput { first, ..WorkerOutput::default() }
    }

    /// The output, unless the request of that number is of a document that was forgotten since.
    pub(super) fn since(&mut self, number: u64) -> Option<&mut WorkerOutput> {
        (number >= self.first).then_some(self)
    }

    pub(crate) fn preview(&mut self, node: &str) -> &mut Preview {
        self.previews.entry(node.to_string()).or_default()
    }

    /// A picture is wanted: what changed, and what follows from it, is stale. An estimate is of the picture before.
    pub(super) fn begin(&mut self, number: u64, wanted: &RenderRequest) {
        (self.number, self.is_busy) = (number, true);
        self.estimate.forget();
        let former = self.wanted.replace(wanted.clone());
        let touched = former.map(|former| Change::between(&former, wanted).touched).unwrap_or_default();
        let status = |name: String| {
            let new = NodeStatus { state: NodeState::Stale, seconds: None };
            let mut status = self.nodes.remove(&name).unwrap_or(new);
            if touched.contains(&name) {
                status.state = NodeState::Stale;
            }
            (name, status)
        };
        self.nodes = wanted.upstream().into_iter().map(status).collect();
    }

    /// Seconds that the nodes took last which are to run for the newest request, but for those that draw and such.
    pub(super) fn stale_seconds(&self, wanted: &RenderRequest) -> f64 {
        let stale = self
            .nodes
            .iter()
            .filter(|(name, status)| status.state == NodeState::Stale && !wanted.is_cheap(name));
        stale.filter_map(|(_, status)| status.seconds).sum()
    }

    fn set(&mut self, node: &str, state: NodeState) {
        if let Some(known) = self.nodes.get_mut(node) {
            known.state = state;
        }
    }

    pub(super) fn started(&mut self, node: &str) {
        if self.nodes.get(node).is_some_and(|known| known.state != NodeState::Fresh) {
            self.set(node, NodeState::Running(String::new(), 0.0));
        }
    }

    pub(super) fn progress(&mut self, node: &str, stage: &str, fraction: f64) {
        self.set(node, NodeState::Running(stage.to_string(), fraction));
    }

    pub(super) fn done(&mut self, node: &str, seconds: f64) {
        if let Some(known) = self.nodes.get_mut(node) {
            known.state = NodeState::Fresh;
            // A former output that serves took no time.
            if seconds > 0.0 {
                known.seconds = Some(seconds);
            }
        }
    }

    /// A picture is drawn. `values`: what runs through the wires, of a full one.
    pub(super) fn finished(
        &mut self,
        pixels: Pixels,
        report: &RunReport,
        values: Option<Values>,
        seconds: f64,
    ) {
        if self.since(pixels.number).is_none() {
            return;
        }
        let is_full = pixels.is_full();
        (self.failure, self.answered) = (None, pixels.number);
        self.seconds[usize::from(!is_full)] = Some(seconds);
        self.pixels = Some(pixels);
        if is_full {
            let mut report = RunReport { pictures: Vec::new(), ..report.clone() };
            report.nodes.retain(|node| node.name != WIRES.name);
            self.report = Some(Arc::new(report));
            let values = values.unwrap_or_default();
            (self.values, self.bounds) = (Arc::new(values.words), values.bounds);
            self.output_bounds = Arc::new(values.output_bounds);
        }
    }

    /// The full picture of a request is there.
    pub(super) fn settled(&mut self, number: u64) {
        if number == self.number {
            self.is_busy = false;
        }
    }

    /// A request came to nothing. One that a newer one stopped is no failure.
    pub(super) fn failed(&mut self, number: u64, error: Error) {
        for known in self.nodes.values_mut().filter(|known| matches!(known.state, NodeState::Running(..))) {
            known.state = NodeState::Stale;
        }
        if error.kind == ErrorKind::Cancelled || number != self.number {
            return;
        }
        if let (Some(node), Some(wanted)) = (&error.location.node, &self.wanted) {
            // What follows from the node is of an earlier state, where the same request was fresh before the data changed.
            let follows = |name: &String| upstream(&wanted.nodes, name).contains(node);
            for (_, known) in self.nodes.iter_mut().filter(|(name, _)| follows(name)) {
                known.state = NodeState::Stale;
            }
            self.set(node, NodeState::Failed(error.to_string()));
        }
        (self.failure, self.answered) = (Some(error), number);
        self.is_busy = false;
    }
}
