//! Summary of a run for people; the crate voltet-io writes the JSON for programs.

use super::streams::name;
use crate::Document;
use crate::graph::{DataFinding, RunReport};
use crate::io::provenance::run_report;
use serde_json::Value;

/// JSON record of one run of a pipeline.
pub fn json(document: &Document, report: &RunReport) -> Value {
    run_report(&document.path.display().to_string(), report, &document.graph.stated)
}

/// Warnings, a line each, but for the first `shown` of them: those of the graph are shown with their location before the run.
pub fn warnings(report: &RunReport, shown: usize) -> String {
    report.warnings.iter().skip(shown).map(|warning| format!("warning: {}\n", name(warning))).collect()
}

/// Findings, and a line for the written files.
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

/// Findings of the nodes about the data, each under the node's name.
pub fn findings(report: &RunReport) -> String {
    let line = |found: &DataFinding| format!("{}: {}\n", found.node, found.what.replace('\n', "\n  "));
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
