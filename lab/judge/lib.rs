//! voltet-judge: judges segment formulas against exact values, whoever states them.
//!
//! A case file holds one JSON object a line: inputs as shortest round-trip doubles, results as strings of 20
//! digits computed with about 90. A result passes when |error| ≤ bound · |exact| + floor, where the bound is
//! stated from the working precision ε and the case's condition number k (module `bounds`). One run judges
//! one set of forms, 64-bit or 32-bit.

#![allow(missing_docs, reason = "unpublished: names say what fields and short functions are")]

mod bounds;
mod case;
mod evaluator;
mod report;

pub use bounds::Rule;
pub use case::{Case, Kind, SegmentCase, parse, segment_cases, shipped, stiff};
pub use evaluator::{
    Chain, Condition, Conditions, EvalOutcome, Evaluator64, PartialIntegrals, Precision, SegmentEvaluator,
};
pub use report::{Exemption, Report, Row, Violation};

use bounds::{BoundedQuantity, rule};
use voltet_core::Result;
use voltet_optics::{Contribution, WidgetBlend};

/// Judges every case of `text`, the content of a case file, by each set of forms. Errors name the line.
pub fn judge_all(text: &str, forms: &[&dyn SegmentEvaluator]) -> Result<Vec<Report>> {
    let mut reports = begin(forms);
    for (i, line) in text.lines().enumerate() {
        if !line.trim().is_empty() {
            let case = parse(line).map_err(|e| e.at_line(i + 1))?;
            enter(&case, forms, &mut reports).map_err(|e| e.at_line(i + 1))?;
        }
    }
    Ok(reports)
}

/// Judges cases that were read already; like [`judge_all`].
pub fn judge_cases(cases: &[Case], forms: &[&dyn SegmentEvaluator]) -> Result<Vec<Report>> {
    let mut reports = begin(forms);
    cases.iter().try_for_each(|case| enter(case, forms, &mut reports))?;
    Ok(reports)
}

fn begin(forms: &[&dyn SegmentEvaluator]) -> Vec<Report> {
    forms.iter().map(|forms| Report::new(forms.name())).collect()
}

fn enter(case: &Case, forms: &[&dyn SegmentEvaluator], reports: &mut [Report]) -> Result<()> {
    for (report, forms) in reports.iter_mut().zip(forms) {
        report.cases += 1;
        judge_case(case, *forms, report).map_err(|e| e.at_item(&case.id))?;
    }
    Ok(())
}

fn judge_case(case: &Case, forms: &dyn SegmentEvaluator, report: &mut Report) -> Result<()> {
    let precision = forms.precision();
    match &case.kind {
        Kind::Segment(segment) => {
            let answer = forms.segment(&segment.transfer_function, &segment.segment(), WidgetBlend::Exact)?;
            let Some((found, wider)) = served(answer, case, report) else { return Ok(()) };
            let condition = forms.condition(&segment.transfer_function, &segment.conditions);
            let rules = |quantity| rule(precision, case, segment, condition, quantity);
            enter_contribution(report, case, &found, segment, wider, &rules);
        }
        Kind::Ray { segments, exact } => {
            let mut parts = Vec::with_capacity(segments.len());
            let mut wider = None;
            for segment in segments {
                let answer =
                    forms.segment(&segment.transfer_function, &segment.segment(), WidgetBlend::Exact)?;
                let Some((found, reason)) = served(answer, case, report) else { return Ok(()) };
                parts.push(found);
                wider = reason.or(wider);
            }
            let chain = forms.chain(&parts);
            let found = Contribution {
                optical_depth: parts.iter().map(|p| p.optical_depth).sum(),
                color: chain.color,
                opacity: chain.opacity,
            };
            let rules = |quantity| bounds::ray_rule(precision, segments.len(), exact, quantity);
            enter_contribution(report, case, &found, exact, wider, &rules);
        }
        Kind::Chain { segments, color, opacity, transparency } => {
            let chain = forms.chain(segments);
            let steps = segments.len() as f64;
            let relative = steps * 4.0 * precision.epsilon();
            let bound = |relative: f64| Rule::Bound { relative, floor: precision.floor() };
            for (found, exact) in chain.color.iter().zip(color) {
                report.enter(case, "C", [*found, *exact], bound(relative), false);
            }
            report.enter(case, "A", [chain.opacity, *opacity], bound(relative), false);
            let odds: f64 = segments.iter().map(|s| s.opacity / (1.0 - s.opacity)).sum();
            let relative = (steps + odds) * 4.0 * precision.epsilon();
            if let Some(found) = chain.transparency {
                report.enter(case, "transparency", [found, *transparency], bound(relative), false);
            }
        }
        Kind::Table { a, b, exact } => {
            let Some((found, wider)) = served(forms.partial(*a, *b)?, case, report) else { return Ok(()) };
            if let Some(reason) = wider {
                report.exemption(true, reason);
            }
            let values = [
                ("psi", found.psi, exact.psi),
                ("F", found.front, exact.front),
                ("B", found.back, exact.back),
                ("zeta", found.zeta, exact.zeta),
            ];
            for (quantity, value, exact) in values {
                let rule = bounds::table_rule(precision, quantity, a + b);
                report.enter(case, quantity, [value, exact], rule, wider.is_some());
            }
        }
    }
    Ok(())
}

/// Value of an answer, with the reason for a wider precision; `None`, entered as skipped, where the forms do not serve the case.
fn served<T>(answer: EvalOutcome<T>, case: &Case, report: &mut Report) -> Option<(T, Option<&'static str>)> {
    match answer {
        EvalOutcome::Served(found) => Some((found, None)),
        EvalOutcome::Wider(found, reason) => Some((found, Some(reason))),
        EvalOutcome::Skipped(reason) => {
            report.skip(case, reason);
            None
        }
    }
}

fn enter_contribution(
    report: &mut Report,
    case: &Case,
    found: &Contribution,
    segment: &SegmentCase,
    wider: Option<&'static str>,
    rules: &dyn Fn(BoundedQuantity) -> Rule,
) {
    if let Some(reason) = wider {
        report.exemption(true, reason);
    }
    let (exact, wider) = (&segment.exact, wider.is_some());
    let mut enter = |quantity, values, rule| report.enter(case, quantity, values, rule, wider);
    enter("T", [found.optical_depth, exact.optical_depth], rules(BoundedQuantity::OpticalDepth));
    for i in 0..3 {
        enter("C", [found.color[i], exact.color[i]], rules(BoundedQuantity::Color));
    }
    enter("A", [found.opacity, exact.opacity], rules(BoundedQuantity::Opacity));
}

#[cfg(test)]
mod tests;
