//! Judges the segment formulas against exact values, per kind and category.
//!
//! A case file holds one JSON object a line: inputs as shortest round-trip doubles, results as strings of 20
//! digits computed with about 90. A result passes when |error| ≤ bound · |exact| + floor, where the bound is
//! stated from the working precision ε and the case's condition number k (module `bounds`). One run judges
//! one set of forms, 64-bit or 32-bit.

mod bounds;
mod case;
mod forms;
mod forms32;

pub use bounds::{Precision, Rule};
pub use case::{Case, Kind, SegmentCase, parse};
pub use forms::{Chain, Forms, Native64, PartialIntegrals};
pub use forms32::Native32;

use crate::Result;
use crate::optics::{Contribution, Overlap};
use bounds::{Quantity, rule};

/// What was found for one quantity of one kind and category.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// segment, ray, chain or table.
    pub kind: &'static str,
    /// The case's category.
    pub category: String,
    /// T, C, A, transparency, psi, F, B or zeta.
    pub quantity: &'static str,
    /// Values compared with a bound.
    pub judged: usize,
    /// Values that are only asked to be finite and within their physical range.
    pub only_finite: usize,
    /// Values of cases that the forms do not serve.
    pub skipped: usize,
    /// Values that broke their bound.
    pub broken: usize,
    /// The largest ratio of error to bound.
    pub worst: f64,
    /// The case that has it.
    pub worst_id: String,
    /// Relative error of that case.
    pub worst_error: f64,
}

/// All rows of one set of forms.
#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    /// Name of the forms.
    pub forms: String,
    /// One row a kind, category and quantity, in the order of the file.
    pub rows: Vec<Row>,
}

impl Report {
    /// Whether every value kept its bound.
    pub fn passed(&self) -> bool {
        self.rows.iter().all(|row| row.broken == 0)
    }

    /// The row that came nearest to its bound, or broke it by most.
    pub fn worst(&self) -> Option<&Row> {
        self.rows.iter().filter(|row| row.judged > 0).max_by(|a, b| a.worst.total_cmp(&b.worst))
    }

    fn row(&mut self, kind: &'static str, category: &str, quantity: &'static str) -> &mut Row {
        let found = self
            .rows
            .iter()
            .position(|row| row.kind == kind && row.category == category && row.quantity == quantity);
        let index = found.unwrap_or_else(|| {
            self.rows.push(Row {
                kind,
                category: category.to_owned(),
                quantity,
                judged: 0,
                only_finite: 0,
                skipped: 0,
                broken: 0,
                worst: 0.0,
                worst_id: String::new(),
                worst_error: 0.0,
            });
            self.rows.len() - 1
        });
        &mut self.rows[index]
    }

    /// Enters one value.
    fn enter(&mut self, case: &Case, quantity: &'static str, value: f64, exact: f64, rule: Rule) {
        let row = self.row(case.kind.name(), &case.category, quantity);
        let (ratio, error) = match rule {
            Rule::Bound { relative, floor } => {
                row.judged += 1;
                let error = (value - exact).abs();
                let allowed = relative * exact.abs() + floor;
                let ratio = if error == 0.0 { 0.0 } else { error / allowed };
                (if value.is_finite() { ratio } else { f64::INFINITY }, error / exact.abs())
            }
            Rule::Within { limit } => {
                row.only_finite += 1;
                let inside = value >= 0.0 && value <= limit && value.is_finite();
                (if inside { 0.0 } else { f64::INFINITY }, 0.0)
            }
        };
        let ratio = if ratio.is_nan() { f64::INFINITY } else { ratio };
        if ratio > 1.0 {
            row.broken += 1;
        }
        if ratio > row.worst || row.worst_id.is_empty() {
            row.worst = ratio;
            row.worst_id.clone_from(&case.id);
            row.worst_error = error;
        }
    }
}

/// Judges every case of `text`, the content of a case file.
pub fn judge(text: &str, forms: &dyn Forms) -> Result<Report> {
    let mut report = Report { forms: forms.name().to_owned(), rows: Vec::new() };
    for (i, line) in text.lines().enumerate() {
        if line.trim().is_empty() {
            continue;
        }
        let case = parse(line).map_err(|e| e.at_line(i + 1))?;
        judge_case(&case, forms, &mut report).map_err(|e| e.at_line(i + 1))?;
    }
    Ok(report)
}

fn judge_case(case: &Case, forms: &dyn Forms, report: &mut Report) -> Result<()> {
    let precision = forms.precision();
    match &case.kind {
        Kind::Segment(segment) => {
            let found = forms.segment(&segment.transfer_function, &segment.segment(), Overlap::Exact)?;
            let Some(found) = found else {
                for quantity in ["T", "C", "A"] {
                    report.row("segment", &case.category, quantity).skipped += 1;
                }
                return Ok(());
            };
            let rules = |quantity| rule(precision, case, segment, quantity);
            enter_contribution(report, case, &found, segment, &rules);
        }
        Kind::Ray { segments, exact } => {
            let mut parts = Vec::with_capacity(segments.len());
            for segment in segments {
                let found = forms.segment(&segment.transfer_function, &segment.segment(), Overlap::Exact)?;
                let Some(found) = found else {
                    for quantity in ["T", "C", "A"] {
                        report.row("ray", &case.category, quantity).skipped += 1;
                    }
                    return Ok(());
                };
                parts.push(found);
            }
            let chain = forms.chain(&parts);
            let found = Contribution {
                optical_depth: parts.iter().map(|p| p.optical_depth).sum(),
                color: chain.color,
                opacity: chain.opacity,
            };
            let rules = |quantity| bounds::ray_rule(precision, segments.len(), exact, quantity);
            enter_contribution(report, case, &found, exact, &rules);
        }
        Kind::Chain { segments, color, opacity, transparency } => {
            let chain = forms.chain(segments);
            let steps = segments.len() as f64;
            let relative = steps * 4.0 * precision.epsilon();
            let bound = |relative: f64| Rule::Bound { relative, floor: precision.floor() };
            for (found, exact) in chain.color.iter().zip(color) {
                report.enter(case, "C", *found, *exact, bound(relative));
            }
            report.enter(case, "A", chain.opacity, *opacity, bound(relative));
            let odds: f64 = segments.iter().map(|s| s.opacity / (1.0 - s.opacity)).sum();
            let relative = (steps + odds) * 4.0 * precision.epsilon();
            report.enter(case, "transparency", chain.transparency, *transparency, bound(relative));
        }
        Kind::Table { a, b, exact } => {
            let found = forms.partial(*a, *b);
            let values = [
                ("psi", found.psi, exact.psi),
                ("F", found.front, exact.front),
                ("B", found.back, exact.back),
                ("zeta", found.zeta, exact.zeta),
            ];
            for (quantity, value, exact) in values {
                report.enter(case, quantity, value, exact, bounds::table_rule(precision, quantity, a + b));
            }
        }
    }
    Ok(())
}

fn enter_contribution(
    report: &mut Report,
    case: &Case,
    found: &Contribution,
    segment: &SegmentCase,
    rules: &dyn Fn(Quantity) -> Rule,
) {
    let exact = &segment.exact;
    report.enter(case, "T", found.optical_depth, exact.optical_depth, rules(Quantity::OpticalDepth));
    for i in 0..3 {
        report.enter(case, "C", found.color[i], exact.color[i], rules(Quantity::Color));
    }
    report.enter(case, "A", found.opacity, exact.opacity, rules(Quantity::Opacity));
}

#[cfg(test)]
mod tests;
