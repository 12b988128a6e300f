//! Diagnostics of a piece of work: counts, warnings, findings, and the work that was skipped. Nodes and engines write them.

use crate::counted;
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt;

/// Work that a scene did not need.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SkippedWork {
    /// The node that skipped it; set when the report of a run is made.
    pub node: String,
    /// The work.
    pub what: String,
    /// The reason why it is not needed.
    pub why: String,
    /// Saved resources, where they are known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub saving: Option<SavedWork>,
}

/// Resources that skipping saves.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum SavedWork {
    /// Memory (bytes).
    Bytes(u64),
    /// Cells that go no further.
    Cells(u64),
    /// Points at which nothing is computed.
    Points(u64),
    /// Ray segments that are not sorted.
    Segments(u64),
    /// Time (seconds), as it took before.
    Seconds(f64),
}

impl fmt::Display for SavedWork {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            SavedWork::Bytes(bytes) => write!(f, "{:.1} MB", *bytes as f64 * 1e-6),
            SavedWork::Cells(count) => f.write_str(&counted(*count, "cell")),
            SavedWork::Points(count) => f.write_str(&counted(*count, "point")),
            SavedWork::Segments(count) => f.write_str(&counted(*count, "segment")),
            SavedWork::Seconds(seconds) => write!(f, "{seconds:.3} s"),
        }
    }
}

/// A fact about the data that a node measured.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DataFinding {
    /// The node that measured it; set when the report of a run is made.
    pub node: String,
    /// A sentence or a few lines, for people.
    pub what: String,
    /// Its figures, for programs.
    pub figures: serde_json::Value,
}

/// Counts of what each part of the data has alike: the whole has as many.
const COUNTED_ONCE: [&str; 3] = ["arrays_decoded", "gradients_computed", "percentiles_computed"];

/// Diagnostics of a node's work, or of an engine's.
#[derive(Debug, Clone, Default)]
pub struct Diagnostics {
    /// True in exhaustive mode, where all work is done and none is recorded as skipped.
    exhaustive: bool,
    /// Skipped work, each entry once.
    pub skipped: Vec<SkippedWork>,
    /// Warnings for the user; each a sentence.
    pub warnings: Vec<String>,
    /// Counts by name (`segments`, `cells_culled`, …).
    pub counts: BTreeMap<&'static str, u64>,
    /// Facts about the data.
    pub findings: Vec<DataFinding>,
    /// Stages of the work with their times (seconds).
    pub stages: Vec<(String, f64)>,
    /// The engine that draws, and the reason for it.
    pub engine: Option<(String, String)>,
    /// The device, or the vector units and threads, that the engine runs on.
    pub adapter: Option<String>,
    /// The compositor of a device, and the reason for it.
    pub compositor: Option<(String, String)>,
    /// Files written.
    pub files: Vec<String>,
}

impl Diagnostics {
    /// Empty diagnostics; in exhaustive mode no work is recorded as skipped.
    pub fn new(exhaustive: bool) -> Diagnostics {
        Diagnostics { exhaustive, ..Diagnostics::default() }
    }

    /// True in exhaustive mode: all work is done, needed or not.
    pub fn exhaustive(&self) -> bool {
        self.exhaustive
    }

    /// Records skipped work and the reason, once for each `what`. Does nothing in exhaustive mode.
    pub fn record_skipped(
        &mut self,
        what: impl Into<String>,
        why: impl Into<String>,
        saving: Option<SavedWork>,
    ) {
        let (node, what, why) = (String::new(), what.into(), why.into());
        if !self.exhaustive && !self.skipped.iter().any(|known| known.what == what) {
            self.skipped.push(SkippedWork { node, what, why, saving });
        }
    }

    /// Records a fact about the data: in words, and as figures.
    pub fn find(&mut self, what: impl Into<String>, figures: serde_json::Value) {
        self.findings.push(DataFinding { node: String::new(), what: what.into(), figures });
    }

    /// Adds the diagnostics of the same work on a part of the data: counts are added up, and each sentence stands once.
    pub fn add_part(&mut self, part: Diagnostics) {
        for (name, count) in part.counts {
            let own = self.counts.entry(name).or_insert(0);
            *own = if COUNTED_ONCE.contains(&name) { (*own).max(count) } else { *own + count };
        }
        for SkippedWork { what, why, saving, .. } in part.skipped {
            self.record_skipped(what, why, saving);
        }
        for warning in part.warnings {
            if !self.warnings.contains(&warning) {
                self.warnings.push(warning);
            }
        }
        for finding in part.findings {
            if !self.findings.contains(&finding) {
                self.findings.push(finding);
            }
        }
        for (stage, seconds) in part.stages {
            match self.stages.iter_mut().find(|(known, _)| *known == stage) {
                Some((_, sum)) => *sum += seconds,
                None => self.stages.push((stage, seconds)),
            }
        }
        self.engine = self.engine.take().or(part.engine);
        self.adapter = self.adapter.take().or(part.adapter);
    }

    /// Adds the diagnostics of a part of the work, such as an engine's or those of planning. Stages and files are not taken over;
    /// an engine is, where none is recorded here.
    pub fn add(&mut self, part: Diagnostics) {
        for SkippedWork { what, why, saving, .. } in part.skipped {
            self.record_skipped(what, why, saving);
        }
        self.warnings.extend(part.warnings);
        self.counts.extend(part.counts);
        self.findings.extend(part.findings);
        self.engine = self.engine.take().or(part.engine);
    }
}
