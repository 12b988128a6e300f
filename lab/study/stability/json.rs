//! Results as JSON. JSON has no ∞: such a ratio is written as null.

use super::report::StabilityReport;
use serde_json::{Value, json as object};
use voltet_judge::{Report, Row};

/// Everything.
pub fn json(found: &StabilityReport) -> Value {
    object!({
        "passed": found.passed(),
        "forms": found.forms.iter().map(forms).collect::<Vec<_>>(),
        "left_out": found.left_out,
        "integrators": found.integrators,
        "pictures": found.pictures,
        "printed": found.printed,
    })
}

/// One set of forms.
pub fn forms(report: &Report) -> Value {
    let row = |row: &Row| {
        object!({
            "kind": row.kind, "formula": row.formula, "category": row.category, "quantity": row.quantity,
            "judged": row.judged, "only_finite": row.only_finite, "served_in_64_bits": row.wider,
            "skipped": row.skipped, "broken": row.broken, "worst_ratio": row.worst, "worst_case": row.worst_id,
            "worst_inputs": row.worst_inputs, "worst_relative_error": row.worst_error,
        })
    };
    let exemptions = |wider: bool| -> Vec<Value> {
        let chosen = report.exemptions.iter().filter(|exemption| exemption.wider == wider);
        chosen.map(|exemption| object!({ "reason": exemption.reason, "cases": exemption.count })).collect()
    };
    let broken = report.broken.iter().map(|b| {
        object!({ "case": b.id, "quantity": b.quantity, "found": b.found, "exact": b.exact, "ratio": b.ratio })
    });
    object!({
        "forms": report.forms, "cases": report.cases, "passed": report.passed(),
        "skipped": exemptions(false), "served_in_64_bits": exemptions(true),
        "broken": broken.collect::<Vec<_>>(),
        "rows": report.rows.iter().map(row).collect::<Vec<_>>(),
    })
}
