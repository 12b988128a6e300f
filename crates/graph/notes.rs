//! What nodes say about their work, and the report of a run.

use super::demand::Done;
use super::leave_out::MayLeaveOut;
use super::origins::Origins;
use super::value::Value;
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt;
use std::sync::Arc;
use voltet_core::Error;
use voltet_core::picture::Picture;

/// Something that a scene did not need.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SkippedWork {
    /// The node that left it out; set when the report is made.
    pub node: String,
    /// What was left out.
    pub what: String,
    /// Why it is not needed.
    pub why: String,
    /// What that saves, where it is known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub saving: Option<SavedWork>,
}

/// What leaving something out saves.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum SavedWork {
    /// Memory, bytes.
    Bytes(u64),
    /// Cells that go no further.
    Cells(u64),
    /// Points at which nothing is computed.
    Points(u64),
    /// Ray segments that are not sorted.
    Segments(u64),
    /// Time, as it took before.
    Seconds(f64),
}

impl fmt::Display for SavedWork {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            SavedWork::Bytes(bytes) => write!(f, "{:.1} MB", *bytes as f64 * 1e-6),
            SavedWork::Cells(count) => write!(f, "{count} cells"),
            SavedWork::Points(count) => write!(f, "{count} points"),
            SavedWork::Segments(count) => write!(f, "{count} segments"),
            SavedWork::Seconds(seconds) => write!(f, "{seconds:.3} s"),
        }
    }
}

/// Something that a node found out about the data.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DataFinding {
    /// The node that found it; set when the report is made.
    pub node: String,
    /// In a sentence or a few lines, for people.
    pub what: String,
    /// The same for programs.
    pub figures: serde_json::Value,
}

/// What a node says about its work.
#[derive(Debug, Clone, Default)]
pub struct NodeDiagnostics {
    /// What was left out, and why.
    pub left_out: Vec<SkippedWork>,
    /// Things the user should know; each a sentence.
    pub warnings: Vec<String>,
    /// Counts by name (`segments`, `cells_culled`, …).
    pub counts: BTreeMap<&'static str, u64>,
    /// What was found out about the data.
    pub findings: Vec<DataFinding>,
    /// Seconds of the stages within the node.
    pub stages: Vec<(String, f64)>,
    /// The engine and why it was taken, for nodes that draw.
    pub engine: Option<(String, String)>,
    /// What the engine runs on, as the nodes that draw find it: a device, or vector units and threads.
    pub adapter: Option<String>,
    /// What composited on a device, and why it was taken.
    pub compositor: Option<(String, String)>,
    /// Files written.
    pub files: Vec<String>,
}

impl NodeDiagnostics {
    /// Something is left out, and why. Said twice, it is kept once.
    pub fn record_skipped(
        &mut self,
        _leave: MayLeaveOut,
        what: impl Into<String>,
        why: impl Into<String>,
        saving: Option<SavedWork>,
    ) {
        let (node, what, why) = (String::new(), what.into(), why.into());
        if !self.left_out.iter().any(|known| known.what == what) {
            self.left_out.push(SkippedWork { node, what, why, saving });
        }
    }

    /// Something was found out about the data: in words, and as figures.
    pub fn find(&mut self, what: impl Into<String>, figures: serde_json::Value) {
        self.findings.push(DataFinding { node: String::new(), what: what.into(), figures });
    }

    /// Adds what an engine says of its work.
    pub fn add(&mut self, of_engine: NodeDiagnostics) {
        for SkippedWork { what, why, saving, .. } in of_engine.left_out {
            self.record_skipped(MayLeaveOut::GIVEN, what, why, saving);
        }
        self.warnings.extend(of_engine.warnings);
        self.counts.extend(of_engine.counts);
        self.findings.extend(of_engine.findings);
    }

    /// Adds what was said while planning to what was said while running.
    pub(super) fn join(&mut self, planned: &NodeDiagnostics) {
        for SkippedWork { what, why, saving, .. } in &planned.left_out {
            self.record_skipped(MayLeaveOut::GIVEN, what.clone(), why.clone(), *saving);
        }
        self.warnings.extend(planned.warnings.iter().cloned());
        if self.engine.is_none() {
            self.engine = planned.engine.clone();
        }
    }
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
    /// Whether a former output was used.
    pub reused: bool,
    /// Seconds of the stages within.
    pub stages: BTreeMap<String, f64>,
    /// Its counts.
    pub counts: BTreeMap<&'static str, u64>,
    /// The engine that it took.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub engine: Option<String>,
}

/// What a run did and left out.
#[derive(Debug, Clone, Default)]
pub struct RunReport {
    /// The nodes in the order in which they ran.
    pub nodes: Vec<NodeReport>,
    /// Counts of all nodes together.
    pub counts: BTreeMap<&'static str, u64>,
    /// What the scene did not need.
    pub left_out: Vec<SkippedWork>,
    /// What the user should know.
    pub warnings: Vec<String>,
    /// What the nodes found out about the data.
    pub findings: Vec<DataFinding>,
    /// The engine that drew, and why.
    pub engine: Option<(String, String)>,
    /// What it ran on.
    pub adapter: Option<String>,
    /// What composited on a device, and why it was taken.
    pub compositor: Option<(String, String)>,
    /// Files written.
    pub files: Vec<String>,
    /// The pictures that were made, each with the name of its node.
    pub pictures: Vec<(String, Arc<Picture>)>,
    /// What all of it was made from.
    pub origins: Origins,
    /// Seconds of the whole run.
    pub seconds: f64,
    /// Whether outputs are passing ones: the same run by itself would give others by rounding ([`super::Session::run_passing`]).
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
        self.left_out.extend(notes.left_out.iter().map(named));
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
