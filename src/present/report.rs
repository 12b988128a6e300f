//! What a run did: a line for people, JSON for programs.

use super::streams::name;
use crate::Document;
use crate::core::graph::{Finding, RunReport};
use crate::core::pipeline::FORMAT;
use crate::nodes::provenance::Provenance;
use serde_json::{Value, json as object};

/// The shape of the report. It changes where something is renamed or moved, not where something is added.
const REPORT_FORMAT: u32 = 1;

/// Counts that every report names, also where the engine that ran does not know them.
const COUNTS: [&str; 11] = [
    "arrays_decoded",
    "gradients_computed",
    "cells_total",
    "cells_culled",
    "cells_projected",
    "segments",
    "pixels_disordered",
    "tiles_sorted",
    "tables_built",
    "shader_builds",
    "uploads",
];

/// The report of a call (docs/provenance.md): what is said of each of its runs.
pub fn whole(runs: Vec<Value>) -> Value {
    object!({
        "versions": { "voltet": env!("CARGO_PKG_VERSION"), "report": REPORT_FORMAT, "pipeline_format": FORMAT },
        "peak_memory_bytes": crate::nodes::memory::peak(),
        "runs": runs,
    })
}

/// What is said of one run.
pub fn json(document: &Document, report: &RunReport) -> Value {
    let mut counts = serde_json::Map::new();
    for name in COUNTS {
        counts.insert(name.into(), Value::Null);
    }
    counts.extend(report.counts.iter().map(|(&name, &count)| (name.to_string(), count.into())));
    object!({
        "file": document.path.display().to_string(),
        "title": document.pipeline.title,
        "engine": report.engine.as_ref().map(|e| &e.0),
        "engine_reason": report.engine.as_ref().map(|e| &e.1),
        "adapter": report.adapter,
        "compositor": report.compositor.as_ref().map(|c| &c.0),
        "compositor_reason": report.compositor.as_ref().map(|c| &c.1),
        "seconds": report.seconds,
        "nodes": report.nodes,
        "counts": counts,
        "left_out": report.left_out,
        "findings": report.findings,
        "warnings": report.warnings,
        "files": report.files,
        "provenance": Provenance::of_run(&report.origins, &document.graph.stated),
    })
}

/// What the user should know, a line each, but for the first `shown` of them: the graph's own warnings are shown with their
/// place before the run.
pub fn warnings(report: &RunReport, shown: usize) -> String {
    report.warnings.iter().skip(shown).map(|warning| format!("warning: {}\n", name(warning))).collect()
}

/// What was found out, and a line for the files written.
pub fn summary(report: &RunReport) -> String {
    let text = findings(report);
    let mut figures = Vec::new();
    let count = |name: &str| report.counts.get(name).copied();
    if let Some(total) = count("cells_total") {
        let culled = count("cells_culled").filter(|&n| n > 0);
        let culled = culled.map(|n| format!(" ({} culled)", number(n))).unwrap_or_default();
        figures.push(format!("{} cells{culled}", number(total)));
    }
    figures.extend(count("segments").map(|n| format!("{} segments", number(n))));
    figures.extend(report.engine.as_ref().map(|(engine, _)| format!("engine {engine}")));
    figures.push(format!("{:.2} s", report.seconds));
    text + &format!("{}: {}\n", report.files.join(", "), figures.join(", "))
}

/// What the nodes found out about the data, each under the node's name.
pub fn findings(report: &RunReport) -> String {
    let line = |found: &Finding| format!("{}: {}\n", found.node, found.what.replace('\n', "\n  "));
    report.findings.iter().map(line).collect()
}

/// A whole number with commas.
pub fn number(n: u64) -> String {
    let digits = n.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}
