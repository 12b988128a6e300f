//! Results per kind, category and quantity.

use super::bounds::Rule;
use super::case::{Case, Kind};
use serde::Serialize;

/// Result for one quantity of one kind and category.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Row {
    /// segment, ray, chain or table.
    pub kind: &'static str,
    pub formula: String,
    pub category: String,
    /// T, C, A, transparency, psi, F, B or zeta.
    pub quantity: &'static str,
    /// Values of these forms compared with a bound.
    pub judged: usize,
    /// Values of these forms that are only asked to be finite and within their physical range.
    pub only_finite: usize,
    /// Values that another precision served, held to the same bound. They are no merit of these forms.
    #[serde(rename = "served_in_64_bits")]
    pub wider: usize,
    /// Values of cases that the forms do not serve.
    pub skipped: usize,
    pub broken: usize,
    /// The largest ratio of error to bound.
    #[serde(rename = "worst_ratio")]
    pub worst: f64,
    #[serde(rename = "worst_case")]
    pub worst_id: String,
    pub worst_inputs: String,
    /// Relative error of that case.
    #[serde(rename = "worst_relative_error")]
    pub worst_error: f64,
}

impl Row {
    /// Adds what was found for another quantity, category or formula.
    fn join(&mut self, other: &Row) {
        self.judged += other.judged;
        self.only_finite += other.only_finite;
        self.wider += other.wider;
        self.skipped += other.skipped;
        self.broken += other.broken;
        if other.worst > self.worst || self.worst_id.is_empty() {
            let Row { quantity, worst, worst_error, .. } = *other;
            (self.quantity, self.worst, self.worst_error) = (quantity, worst, worst_error);
            (self.category, self.formula) = (other.category.clone(), other.formula.clone());
            (self.worst_id, self.worst_inputs) = (other.worst_id.clone(), other.worst_inputs.clone());
        }
    }
}

/// Cases that the forms did not serve themselves.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Exemption {
    /// True if another precision served them.
    #[serde(skip)]
    pub wider: bool,
    pub reason: &'static str,
    /// Number of cases (rays count once).
    #[serde(rename = "cases")]
    pub count: usize,
}

/// A value that broke its bound.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Violation {
    #[serde(rename = "case")]
    pub id: String,
    pub quantity: &'static str,
    /// Value that was computed.
    pub found: f64,
    pub exact: f64,
    /// Error by bound; ∞ for what is not finite or not in its physical range.
    pub ratio: f64,
}

/// All that one set of forms did.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Report {
    pub forms: String,
    pub cases: usize,
    /// One row a kind, category and quantity, in the order of the file.
    pub rows: Vec<Row>,
    /// Reasons of cases that were skipped or evaluated in another precision.
    pub exemptions: Vec<Exemption>,
    /// Every value that broke its bound, in the order of the file.
    pub broken: Vec<Violation>,
}

impl Report {
    pub(super) fn new(forms: &str) -> Self {
        Report { forms: forms.to_owned(), ..Report::default() }
    }

    /// True if every value kept its bound.
    pub fn passed(&self) -> bool {
        self.broken.is_empty()
    }

    /// The row that came nearest to its bound, or broke it by most.
    pub fn worst(&self) -> Option<&Row> {
        let compared = self.rows.iter().filter(|row| !row.worst_id.is_empty());
        compared.max_by(|a, b| a.worst.total_cmp(&b.worst))
    }

    /// Rows of one key as one: sums of their counts, and the worst value with its quantity, category and formula.
    pub fn gathered<K: PartialEq>(&self, key: impl Fn(&Row) -> K) -> Vec<Row> {
        let mut gathered: Vec<(K, Row)> = Vec::new();
        for row in &self.rows {
            let key = key(row);
            match gathered.iter_mut().find(|(known, _)| *known == key) {
                Some((_, whole)) => whole.join(row),
                None => gathered.push((key, row.clone())),
            }
        }
        gathered.into_iter().map(|(_, row)| row).collect()
    }

    pub fn total(&self, count: impl Fn(&Row) -> usize) -> usize {
        self.rows.iter().map(count).sum()
    }

    pub(super) fn exemption(&mut self, wider: bool, reason: &'static str) {
        match self.exemptions.iter_mut().find(|e| e.wider == wider && e.reason == reason) {
            Some(exemption) => exemption.count += 1,
            None => self.exemptions.push(Exemption { wider, reason, count: 1 }),
        }
    }

    /// Enters a case that is not served.
    pub(super) fn skip(&mut self, case: &Case, reason: &'static str) {
        self.exemption(false, reason);
        let values: &[(&'static str, usize)] = match case.kind {
            Kind::Table { .. } => &[("psi", 1), ("F", 1), ("B", 1), ("zeta", 1)],
            _ => &[("T", 1), ("C", 3), ("A", 1)],
        };
        for &(quantity, count) in values {
            self.row(case, quantity).skipped += count;
        }
    }

    fn row(&mut self, case: &Case, quantity: &'static str) -> &mut Row {
        let (formula, category) = (case.formula(), &case.category);
        let same =
            |row: &Row| row.quantity == quantity && row.category == *category && row.formula == formula;
        let found = self.rows.iter().position(same);
        let index = found.unwrap_or_else(|| {
            self.rows.push(Row {
                kind: case.kind_name(),
                formula,
                category: category.clone(),
                quantity,
                ..Row::default()
            });
            self.rows.len() - 1
        });
        &mut self.rows[index]
    }

    pub(super) fn enter(
        &mut self,
        case: &Case,
        quantity: &'static str,
        [found, exact]: [f64; 2],
        rule: Rule,
        wider: bool,
    ) {
        let row = self.row(case, quantity);
        let (count, ratio, error) = match rule {
            Rule::Bound { relative, floor } => {
                let error = (found - exact).abs();
                let ratio = if error == 0.0 { 0.0 } else { error / (relative * exact.abs() + floor) };
                let ratio = if found.is_finite() && !ratio.is_nan() { ratio } else { f64::INFINITY };
                (&mut row.judged, ratio, error / exact.abs())
            }
            Rule::Within { limit } => {
                let inside = found >= 0.0 && found <= limit && found.is_finite();
                (&mut row.only_finite, if inside { 0.0 } else { f64::INFINITY }, 0.0)
            }
        };
        *(if wider { &mut row.wider } else { count }) += 1;
        if ratio > row.worst || row.worst_id.is_empty() {
            row.worst = ratio;
            row.worst_id.clone_from(&case.id);
            row.worst_inputs = case.inputs();
            row.worst_error = error;
        }
        if ratio > 1.0 {
            row.broken += 1;
            self.broken.push(Violation { id: case.id.clone(), quantity, found, exact, ratio });
        }
    }
}
