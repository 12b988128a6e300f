//! `voltet stability`: the formulas against exact values, hard cells against the referee, and what papers print.

use super::shared::{DONE, FAILED, Outcome, with_bar};
use crate::cli::arguments::Stability;
use crate::cli::present::{name, print};
use crate::core::{Error, counted};
use serde_json::{Value, json};
use std::path::Path;
use voltet_judge::{Report, SegmentEvaluator, judge_all};
use voltet_study::stability;

pub fn stability(arguments: &Stability) -> Outcome {
    match (&arguments.cases, arguments.scenes) {
        (Some(path), _) => judge(path, arguments),
        (None, Some(count)) => scenes(count, arguments),
        (None, None) => all(arguments),
    }
}

/// Exit code, by whether every bound is kept.
fn verdict(passed: bool) -> u8 {
    if passed { DONE } else { FAILED }
}

/// Everything that the program has to say of itself.
fn all(arguments: &Stability) -> Outcome {
    let subjects = stability::subjects(arguments.adapter.as_deref())?;
    let found = with_bar(false, |_, progress| stability::stability(&subjects, progress))?;
    print(&match arguments.json {
        true => format!("{:#}\n", stability::json(&found)),
        false => stability::text(&found),
    })?;
    Ok(verdict(found.passed()))
}

/// Scenes drawn by lot.
fn scenes(count: u64, arguments: &Stability) -> Outcome {
    let subjects = stability::subjects(arguments.adapter.as_deref())?;
    let numbers = arguments.first..arguments.first.saturating_add(count);
    let seed = arguments.seed;
    let found = with_bar(false, |_, progress| stability::random(&subjects, seed, numbers, progress))?;
    print(&match arguments.json {
        true => format!("{:#}\n", json!(found)),
        false => stability::random_text(&found),
    })?;
    Ok(verdict(found.passed()))
}

/// A file of cases.
fn judge(path: &Path, arguments: &Stability) -> Outcome {
    let read = std::fs::read(path).map_err(|error| {
        Error::usage("the case file cannot be read").got(error).expected("a file of cases").in_file(path)
    })?;
    let text = String::from_utf8(read).map_err(|error| {
        let found = format!("byte {} is no UTF-8", error.utf8_error().valid_up_to());
        Error::usage("the file is no case file").got(found).expected("JSON lines").in_file(path)
    })?;
    let subjects = stability::subjects(arguments.adapter.as_deref())?;
    let forms: Vec<&dyn SegmentEvaluator> = subjects.forms.iter().map(Box::as_ref).collect();
    let reports = judge_all(&text, &forms).map_err(|error| error.in_file(path))?;
    if reports.iter().all(|report| report.cases == 0) {
        let error = Error::usage("the file holds no case").expected("one JSON object a line");
        return Err(error.in_file(path).into());
    }
    let passed = reports.iter().all(Report::passed);
    if arguments.json {
        let forms: Vec<Value> = reports.iter().map(stability::forms_json).collect();
        let all = json!({
            "file": path.display().to_string(),
            "passed": passed,
            "forms": forms,
            "left_out": subjects.left_out,
        });
        print(&format!("{all:#}\n"))?;
    } else {
        let cases = reports.first().map_or(0, |report| report.cases);
        let path = name(&path.to_string_lossy());
        let mut text = format!("{path}: {}\n", counted(cases, "case"));
        text.extend(reports.iter().map(|report| format!("\n{}", stability::forms_text(report))));
        text.extend(subjects.left_out.iter().map(|what| format!("\nnot judged: {what}\n")));
        print(&text)?;
    }
    Ok(verdict(passed))
}
