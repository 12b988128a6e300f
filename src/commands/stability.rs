//! `voltet stability`: the formulas against exact values, hard cells against the referee, and what papers print.

use super::outcome::DONE;
use crate::arguments::Stability;
use crate::core::graph::Observer;
use crate::core::progress::Progress;
use crate::core::{Error, Result};
use crate::judge::{Forms, Report, judge_all};
use crate::present::Bar;
use crate::stability;
use serde_json::{Value, json};
use std::path::Path;

/// A bound is broken.
const BROKEN: u8 = 1;

pub fn stability(arguments: &Stability) -> Result<u8> {
    match &arguments.cases {
        Some(path) => judge(path, arguments),
        None => all(arguments),
    }
}

fn verdict(passed: bool) -> u8 {
    if passed { DONE } else { BROKEN }
}

/// Everything that the program has to say of itself.
fn all(arguments: &Stability) -> Result<u8> {
    let watch = Watch(Bar::new(false));
    let subjects = stability::subjects(arguments.adapter.as_deref())?;
    let found = stability::stability(&subjects, &watch);
    watch.0.clear();
    let found = found?;
    match (arguments.json, arguments.markdown) {
        (true, _) => println!("{:#}", stability::json(&found)),
        (false, true) => print!("{}", stability::markdown(&found)),
        (false, false) => print!("{}", stability::text(&found)),
    }
    Ok(verdict(found.passed()))
}

/// A file of cases.
fn judge(path: &Path, arguments: &Stability) -> Result<u8> {
    let read = std::fs::read(path).map_err(|error| {
        Error::usage("the case file cannot be read").found(error).accepted("a file of cases").in_file(path)
    })?;
    let text = String::from_utf8(read).map_err(|error| {
        let found = format!("byte {} is no UTF-8", error.utf8_error().valid_up_to());
        Error::usage("the file is no case file").found(found).accepted("JSON lines").in_file(path)
    })?;
    let subjects = stability::subjects(arguments.adapter.as_deref())?;
    let forms: Vec<&dyn Forms> = subjects.forms.iter().map(Box::as_ref).collect();
    let reports = judge_all(&text, &forms).map_err(|error| error.in_file(path))?;
    if reports.iter().all(|report| report.cases == 0) {
        let error = Error::usage("the file holds no case").accepted("one JSON object a line");
        return Err(error.in_file(path));
    }
    let passed = reports.iter().all(Report::passed);
    if arguments.json {
        let forms: Vec<Value> = reports.iter().map(stability::forms_json).collect();
        println!(
            "{:#}",
            json!({ "file": path.display().to_string(), "passed": passed, "forms": forms, "left_out": subjects.left_out })
        );
    } else {
        let cases = reports.first().map_or(0, |report| report.cases);
        println!("{}: {cases} case{}", path.display(), if cases == 1 { "" } else { "s" });
        reports.iter().for_each(|report| print!("\n{}", stability::forms_text(report)));
        subjects.left_out.iter().for_each(|what| println!("\nnot judged: {what}"));
    }
    Ok(verdict(passed))
}

/// Shows progress.
struct Watch(Bar);

impl Progress for Watch {
    fn report(&self, stage: &str, fraction: f64) {
        self.0.progress("", stage, fraction);
    }

    fn cancelled(&self) -> bool {
        self.0.cancelled()
    }
}
