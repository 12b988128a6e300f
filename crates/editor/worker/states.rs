//! Output of the worker.

use super::pixels::Pixels;
use super::preview_observer::{NAME, Values};
use super::queries::{Distribution, PixelProbe, Section, Share};
use super::request::RenderRequest;
use glam::DVec3;
use std::collections::BTreeMap;
use std::sync::Arc;
use voltet_core::error::ErrorKind;
use voltet_core::{Error, Result};
use voltet_document::links::upstream;
use voltet_graph::RunReport;

/// States of a node.
#[derive(Debug, Clone, PartialEq)]
pub enum NodeState {
    /// It did not run yet for what is wanted now.
    Stale,
    /// It runs: its stage, and how much of that is done (0 … 1).
    Running(String, f64),
    /// Its outputs are those of what is wanted.
    Fresh,
    /// It failed.
    Failed(String),
}

/// A node that feeds the picture.
#[derive(Debug, Clone, PartialEq)]
pub struct NodeStatus {
    /// Its state.
    pub state: NodeState,
    /// Seconds that its outputs took when they were made last.
    pub seconds: Option<f64>,
}

/// Latest output of the worker.
#[derive(Default)]
pub struct WorkerOutput {
    /// The newest picture.
    pub pixels: Option<Pixels>,
    /// The nodes that feed the picture; the others are not needed for it.
    pub nodes: BTreeMap<String, NodeStatus>,
    /// Reason why there is no newer picture.
    pub failure: Option<Error>,
    /// True if something newer than the picture is being drawn.
    pub is_busy: bool,
    /// Seconds of the last full picture, and of the last that was coarse or drawn in passing.
    pub seconds: [Option<f64>; 2],
    /// The last full run's report, without its pictures.
    pub report: Option<Arc<RunReport>>,
    /// The largest and the root mean square error of a picture, with the key that it was asked for by.
    pub estimate: Option<(u64, Result<[f64; 2]>)>,
    /// For each output, `"node.port"`, what runs through it.
    pub values: Arc<BTreeMap<String, String>>,
    /// Least and greatest coordinates of the data.
    pub bounds: Option<[DVec3; 2]>,
    /// The distribution of the data, with the key that it was asked for by.
    pub distribution: Option<(u64, Result<Arc<Distribution>>)>,
    /// Result of the last probe, with the key of its query.
    pub probed: Option<(u64, Result<Arc<PixelProbe>>)>,
    /// The last section, with the key of its query.
    pub section: Option<(u64, Result<Arc<Section>>)>,
    /// The last widget's contribution, with the key of its query.
    pub share: Option<(u64, Result<Share>)>,
    /// Small pictures of nodes that are not shown at large.
    pub previews: BTreeMap<String, Pixels>,
    number: u64,
    wanted: Option<RenderRequest>,
}

impl WorkerOutput {
    /// A picture is wanted: what changed, and what follows from it, is stale.
    pub(super) fn begin(&mut self, number: u64, wanted: &RenderRequest) {
        (self.number, self.is_busy) = (number, true);
        let former = self.wanted.replace(wanted.clone());
        let before = |name: &str| former.as_ref().and_then(|f| f.nodes.iter().find(|node| node.name == name));
        let is_changed = |name: &str| {
            wanted.nodes.iter().find(|node| node.name == name).is_none_or(|now| before(name) != Some(now))
        };
        let mut nodes = BTreeMap::new();
        for name in wanted.upstream() {
            let stale = upstream(&wanted.nodes, &name).iter().any(|feeding| is_changed(feeding));
            let known = self.nodes.get(&name);
            let state = match known.map(|known| &known.state) {
                Some(state) if !stale => state.clone(),
                _ => NodeState::Stale,
            };
            nodes.insert(name.clone(), NodeStatus { state, seconds: known.and_then(|known| known.seconds) });
        }
        self.nodes = nodes;
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

    pub(super) fn finished(&mut self, pixels: Pixels, report: &RunReport, values: Values, seconds: f64) {
        let is_full = pixels.is_full();
        self.failure = None;
        self.seconds[usize::from(!is_full)] = Some(seconds);
        self.pixels = Some(pixels);
        if is_full {
            let mut report = RunReport { pictures: Vec::new(), ..report.clone() };
            report.nodes.retain(|node| node.name != NAME);
            self.report = Some(Arc::new(report));
            self.values = Arc::new(values.words);
            self.bounds = values.bounds;
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
        if let Some(node) = &error.location.node {
            self.set(node, NodeState::Failed(error.to_string()));
        }
        self.failure = Some(error);
        self.is_busy = false;
    }
}
