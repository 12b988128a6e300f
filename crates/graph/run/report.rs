//! The report of a run: times, counts, skipped work, warnings and findings of its nodes.

use super::plan::Done;
use crate::api::origins::Origins;
use crate::api::value::Value;
use serde::Serialize;
use std::collections::BTreeMap;
use std::sync::Arc;
use voltet_core::Error;
use voltet_core::diagnostics::{DataFinding, SkippedWork};
use voltet_core::picture::Picture;

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
    pub is_passing: bool,
}

impl RunReport {
    /// Adds a node that ran, or whose former outputs were used.
    pub(super) fn add(&mut self, name: &str, node_type: &str, done: &Done) {
        let Done { notes, seconds, reused, outputs, is_passing } = done;
        self.is_passing |= is_passing;
        let pictures = outputs.iter().filter_map(|(value, _)| match value {
            Value::Image(picture) => Some((name.to_string(), picture.clone())),
            _ => None,
        });
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
        if self.engine.is_none() {
            self.engine = notes.engine.clone();
        }
        if self.adapter.is_none() {
            self.adapter = notes.adapter.clone();
        }
        if self.compositor.is_none() {
            self.compositor = notes.compositor.clone();
        }
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

    /// The report of a graph with these warnings of its own, nothing having run.
    pub(super) fn begin(warnings: &[Error]) -> Self {
        RunReport { warnings: warnings.iter().map(Error::to_string).collect(), ..RunReport::default() }
    }
}
