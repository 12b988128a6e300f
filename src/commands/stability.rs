//! `voltet stability`: the segment formulas against exact values.

use super::DONE;
use crate::arguments::Stability;
use serde_json::{Value, json};
use voltet::core::optics::judge::{Excuse, Native32, Native64, Report, Row, judge_all};
use voltet::core::{Error, Result};

/// A bound is broken.
const BROKEN: u8 = 1;

/// Broken values that are named one by one.
const NAMED: usize = 20;

pub fn stability(arguments: &Stability) -> Result<u8> {
    let path = &arguments.cases;
    let read = std::fs::read(path).map_err(|error| {
        Error::usage("the case file cannot be read").found(error).accepted("a file of cases").in_file(path)
    })?;
    let text = String::from_utf8(read).map_err(|error| {
        let found = format!("byte {} is no UTF-8", error.utf8_error().valid_up_to());
        Error::usage("the file is no case file").found(found).accepted("JSON lines").in_file(path)
    })?;
    let reports = judge_all(&text, &[&Native64, &Native32]).map_err(|error| error.in_file(path))?;
    if reports.iter().all(|report| report.cases == 0) {
        let error = Error::usage("the file holds no case").accepted("one JSON object a line");
        return Err(error.in_file(path));
    }
    if arguments.json {
        println!("{:#}", as_json(path, &reports));
    } else {
        let cases = reports.first().map_or(0, |report| report.cases);
        println!("{}: {}", path.display(), counted(cases, "case"));
        reports.iter().for_each(|report| print!("\n{}", table(report)));
    }
    Ok(if reports.iter().all(Report::passed) { DONE } else { BROKEN })
}

fn counted(count: usize, noun: &str) -> String {
    format!("{count} {noun}{}", if count == 1 { "" } else { "s" })
}

fn described(excuse: &Excuse) -> String {
    let what = if excuse.wider { "served in 64 bits" } else { "skipped" };
    format!("{what}: {}, since {}", counted(excuse.count, "case"), excuse.reason)
}

/// One report as a table and what it means in words.
fn table(report: &Report) -> String {
    let mut text = format!("{} forms\n", report.forms);
    text += "  kind     category   quantity      judged   finite  64 bits  skipped   broken  worst      of case\n";
    for row in &report.rows {
        let worst = format!("{:.3}", row.worst);
        text += &format!(
            "  {:8} {:10} {:12} {:>7} {:>8} {:>8} {:>8} {:>8}  {worst:10} {}\n",
            row.kind,
            row.category,
            row.quantity,
            row.judged,
            row.only_finite,
            row.wider,
            row.skipped,
            row.broken,
            row.worst_id
        );
    }
    text += &format!(
        "  {} judged, {} only asked to be finite, {} served in 64 bits, {} skipped\n",
        counted(report.total(|row| row.judged), "value"),
        report.total(|row| row.only_finite),
        report.total(|row| row.wider),
        report.total(|row| row.skipped)
    );
    text.extend(report.excuses.iter().map(|excuse| format!("  {}\n", described(excuse))));
    for broken in report.broken.iter().take(NAMED) {
        text += &format!(
            "  broken: {} of {}: {:e}, exact {:e}, {:.3} times the bound\n",
            broken.quantity, broken.id, broken.found, broken.exact, broken.ratio
        );
    }
    if report.broken.len() > NAMED {
        text += &format!("  broken: and {} more\n", report.broken.len() - NAMED);
    }
    let verdict = match (report.passed(), report.worst()) {
        (false, _) => format!("{} BROKE ITS BOUND", counted(report.broken.len(), "value")),
        (true, Some(row)) => {
            format!("every bound kept; the worst error is {:.3} of its bound ({})", row.worst, row.worst_id)
        }
        (true, None) => "nothing was judged".into(),
    };
    text + &format!("  {}: {verdict}\n", report.forms)
}

fn as_json(path: &std::path::Path, reports: &[Report]) -> Value {
    // JSON has no ∞: such a ratio is written as null.
    let row = |row: &Row| {
        json!({
            "kind": row.kind, "category": row.category, "quantity": row.quantity, "judged": row.judged,
            "only_finite": row.only_finite, "served_in_64_bits": row.wider, "skipped": row.skipped,
            "broken": row.broken, "worst_ratio": row.worst, "worst_case": row.worst_id,
            "worst_relative_error": row.worst_error,
        })
    };
    let forms = |report: &Report| {
        let excuses = |wider: bool| -> Vec<Value> {
            let chosen = report.excuses.iter().filter(|excuse| excuse.wider == wider);
            chosen.map(|excuse| json!({ "reason": excuse.reason, "cases": excuse.count })).collect()
        };
        let broken = report.broken.iter().map(|b| {
            json!({
                "case": b.id, "quantity": b.quantity, "found": b.found, "exact": b.exact, "ratio": b.ratio,
            })
        });
        json!({
            "forms": report.forms, "cases": report.cases, "passed": report.passed(),
            "skipped": excuses(false), "served_in_64_bits": excuses(true),
            "broken": broken.collect::<Vec<_>>(),
            "rows": report.rows.iter().map(row).collect::<Vec<_>>(),
        })
    };
    json!({
        "file": path.display().to_string(), "passed": reports.iter().all(Report::passed),
        "forms": reports.iter().map(forms).collect::<Vec<_>>(),
    })
}
