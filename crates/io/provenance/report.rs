//! Report of a run as JSON (docs/src/reference/report.md).

use super::Provenance;
use crate::memory;
use serde_json::{Value, json as object};
use voltet_graph::pipeline::FORMAT;
use voltet_graph::{ResolvedPipeline, RunReport};

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

/// The report of a call (docs/src/reference/report.md): what is said of each of its runs.
pub fn whole_report(runs: Vec<Value>) -> Value {
    object!({
        "versions": { "voltet": env!("CARGO_PKG_VERSION"), "report": REPORT_FORMAT, "pipeline_format": FORMAT },
        "peak_memory_bytes": memory::peak(),
        "runs": runs,
    })
}

/// Report of one run. `file`: source of the pipeline.
pub fn run_report(file: &str, report: &RunReport, stated: &ResolvedPipeline) -> Value {
    let mut counts = serde_json::Map::new();
    for name in COUNTS {
        counts.insert(name.into(), Value::Null);
    }
    counts.extend(report.counts.iter().map(|(&name, &count)| (name.to_string(), count.into())));
    object!({
        "file": file,
        "title": stated.title,
        "engine": report.engine.as_ref().map(|e| &e.0),
        "engine_reason": report.engine.as_ref().map(|e| &e.1),
        "adapter": report.adapter,
        "compositor": report.compositor.as_ref().map(|c| &c.0),
        "compositor_reason": report.compositor.as_ref().map(|c| &c.1),
        "seconds": report.seconds,
        "nodes": report.nodes,
        "counts": counts,
        "left_out": report.skipped,
        "findings": report.findings,
        "warnings": report.warnings,
        "files": report.files,
        "provenance": Provenance::of_run(&report.origins, stated),
    })
}
