//! Every integrator in 64 bits on the segments whose exact values are known: what it is off by, and whether what it gives can
//! be seen at all (finite, no more than opaque, no brighter than its widgets).
//!
//! Results, the verdict on every bound, and both as a page of Markdown, which a terminal shows too, and as JSON.

use crate::columns::{aligned, markdown};
use crate::stability::pictures::HardPicture;
use crate::stability::printed::PrintedFormula;
use crate::stability::random::{BoundViolation, RandomReport};
use serde::Serialize;
use serde_json::{Value, json as object};
use voltet_core::progress::Progress;
use voltet_core::transfer::{OpticalModel, Widget};
use voltet_core::{Result, counted};
use voltet_integrators::{pre_integrated, pre_integrated_cylindrical, riemann, segments, tabulated};
use voltet_judge::{Case, Exemption, Kind, Report, Row, SegmentCase, stiff};
use voltet_optics::integrators::{Extent, Integrator, IntegratorKind};
use voltet_optics::{CompiledTransferFunction, Contribution, WidgetBlend, integrators};
use voltet_reference::REFERENCE;

#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct IntegratorReport {
    /// The name in pipeline files.
    pub integrator: &'static str,
    pub cases: usize,
    /// Largest error of A and of C as shares of what is possible at most: 1, and the brightest colour there.
    pub worst_error: f64,
    pub worst_case: String,
    /// Bound of its error, if it has any: the referee as a share; `adaptive` beside the closed forms, whose
    /// places along a segment are its own, and twice what those are off by.
    pub bound: Option<f64>,
    /// Cases that broke the bound, and by what they are off.
    pub broken: Vec<String>,
    /// Cases whose result cannot be, and what it was.
    pub impossible: Vec<String>,
}

impl IntegratorReport {
    /// True if all that it gave can be, within what it promises.
    pub fn passed(&self) -> bool {
        self.impossible.is_empty() && self.broken.is_empty()
    }
}

/// Tolerance of `adaptive`, as it is judged here.
const TOLERANCE: f64 = 1e-6;

/// Excess of a result over its limit, opaque or as bright as its widgets: a thousandth of a step of 8 bits. Tables that are
/// interpolated take up to 2e-6 of it.
const MIN_TRANSMITTANCE: f64 = 4e-6;

/// The quadrature of the referee: ten times what it allows itself of each stretch.
const REFEREE: f64 = 1e-10;

/// One of each kind, with what it promises. Tables are small, as each case needs one of its own.
fn settings(kind: &'static dyn IntegratorKind) -> (Integrator, Option<f64>) {
    let default = Integrator::new(kind);
    match default.name() {
        "adaptive" => (Integrator::adaptive(TOLERANCE), Some(TOLERANCE)),
        "segments" => (segments(16, 64), None),
        "riemann" => (riemann(64), None),
        "pre-integrated" => (pre_integrated(5, 2), None),
        "pre-integrated-cylindrical" => (pre_integrated_cylindrical(5, 2, 1), None),
        "tabulated" => (tabulated(128), None),
        "reference" => (REFERENCE, Some(REFEREE)),
        // The ends of a segment count as points for `vertex-sampled`; the values of `analytic` are judged as forms, by the condition
        // of each case.
        _ => (default, None),
    }
}

/// All kinds, those that ship first.
fn kinds() -> impl Iterator<Item = &'static dyn IntegratorKind> {
    integrators::KINDS.into_iter().chain([REFERENCE.kind()]).chain(voltet_integrators::KINDS)
}

/// Tries every integrator. Errors: a stopped run, a transfer function out of range.
pub(super) fn integrators(cases: &[Case], progress: &dyn Progress) -> Result<Vec<IntegratorReport>> {
    let stiff = stiff()?;
    let mut all = Vec::new();
    for (k, every) in kinds().enumerate() {
        let (integrator, bound) = settings(every);
        progress.report(integrator.name(), k as f64 / kinds().count() as f64);
        let mut found = IntegratorReport { integrator: integrator.name(), bound, ..Default::default() };
        for case in cases.iter().chain(&stiff) {
            progress.check_cancelled()?;
            if let Kind::Segment(segment) = &case.kind {
                found.add(&integrator, &case.id, segment)?;
            }
        }
        all.push(found);
    }
    Ok(all)
}

impl IntegratorReport {
    fn add(&mut self, integrator: &Integrator, id: &str, case: &SegmentCase) -> Result<()> {
        let transfer_function = &case.transfer_function;
        if integrators::can_serve(integrator, transfer_function).is_err() {
            return Ok(());
        }
        let segment = case.segment();
        let (a, b) = (segment.front[0], segment.back[0]);
        let extent = Extent { scalar: [a.min(b), a.max(b)], longest: case.length };
        let made = integrators::new(integrator, WidgetBlend::Exact, transfer_function, &extent)?;
        let given = made.integrate(&segment);
        self.cases += 1;
        if let Some(error) = made.failure() {
            self.impossible.push(format!("{id}: {error}"));
            return Ok(());
        }
        let most = brightest(case);
        if !possible(&given, most) {
            self.impossible.push(format!("{id}: {given:?}"));
            return Ok(());
        }
        let error = off(&given, &case.exact, most);
        if error > self.worst_error {
            (self.worst_error, self.worst_case) = (error, id.into());
        }
        let beyond = match integrator.tolerance() {
            Some(_) => {
                let closed =
                    CompiledTransferFunction::new(transfer_function)?.integrate(&segment, WidgetBlend::Exact);
                off(&given, &case.exact, 1.0) - 2.0 * off(&closed, &case.exact, 1.0)
            }
            None => error,
        };
        if self.bound.is_some_and(|bound| beyond > bound) {
            self.broken.push(format!("{id}: {beyond:e}"));
        }
        Ok(())
    }
}

/// The larger error of A and of C, that as a share of `most`.
fn off(found: &Contribution, exact: &Contribution, most: f64) -> f64 {
    let share = |found: f64, exact: f64| if most > 0.0 { (found - exact).abs() / most } else { 0.0 };
    let colors = (0..3).map(|c| share(found.color[c], exact.color[c]));
    colors.fold((found.opacity - exact.opacity).abs(), f64::max)
}

/// The brightest that the segment's colour can be: ∫ κ e^(−T) (docs/src/explanation/optics.md, section 5).
fn brightest(case: &SegmentCase) -> f64 {
    match case.transfer_function.model {
        OpticalModel::DensityEmitter => case.brightest(),
        OpticalModel::ConstantEmitter { .. } => {
            let each = case.transfer_function.widgets.iter().map(Widget::max_emission);
            each.sum::<f64>() * case.length / case.transfer_function.unit_distance
        }
    }
}

fn possible(given: &Contribution, most: f64) -> bool {
    let within = |x: f64, most: f64| (0.0..=most * (1.0 + MIN_TRANSMITTANCE)).contains(&x);
    given.optical_depth >= 0.0 && within(given.opacity, 1.0) && given.color.iter().all(|c| within(*c, most))
}

#[derive(Debug, Clone)]
pub struct StabilityReport {
    /// One report a set of forms: 64-bit, 32-bit by lane set, further ones.
    pub forms: Vec<Report>,
    /// Every integrator in 64 bits.
    pub integrators: Vec<IntegratorReport>,
    /// Pictures of hard scenes, one after the other.
    pub pictures: Vec<HardPicture>,
    pub printed: Vec<PrintedFormula>,
    /// Engines that were not judged, with the reason and the remedy.
    pub left_out: Vec<String>,
}

impl StabilityReport {
    /// True if every bound was kept.
    pub fn passed(&self) -> bool {
        self.forms.iter().all(Report::passed)
            && self.integrators.iter().all(IntegratorReport::passed)
            && self.pictures.iter().all(HardPicture::passed)
    }
}

/// Everything as JSON. JSON has no ∞: such a ratio is written as null.
pub fn json(report: &StabilityReport) -> Value {
    object!({
        "passed": report.passed(),
        "forms": report.forms.iter().map(forms_json).collect::<Vec<_>>(),
        "left_out": report.left_out,
        "integrators": report.integrators,
        "pictures": report.pictures,
        "printed": report.printed,
    })
}

pub fn forms_json(report: &Report) -> Value {
    let exemptions = |wider: bool| -> Vec<&Exemption> {
        report.exemptions.iter().filter(|exemption| exemption.wider == wider).collect()
    };
    object!({
        "forms": report.forms, "cases": report.cases, "passed": report.passed(),
        "skipped": exemptions(false), "served_in_64_bits": exemptions(true),
        "broken": report.broken, "rows": report.rows,
    })
}

const NAMED: usize = 20;

/// A category as people call it.
fn category(name: &str) -> &str {
    match name {
        "bands" => "many bands",
        "scale" => "tiny and huge lengths",
        "edges" => "region edges",
        "overlap" => "widgets that overlap",
        "chain" => "long compositing chains",
        "ray" => "cells along a ray",
        "table" => "partial pre-integration",
        "wild" => "anything goes",
        other => other,
    }
}

/// An error; "none" for what is no number.
fn number(error: f64) -> String {
    if error.is_finite() { format!("{error:.1e}") } else { "none".into() }
}

/// Mark behind a figure that broke its bound.
fn mark(kept: bool) -> &'static str {
    if kept { "" } else { " **broken**" }
}

fn first(column: usize) -> bool {
    column == 0
}

/// Everything, without a title.
pub fn text(report: &StabilityReport) -> String {
    let mut text = String::from(
        "## Every formula, by category\n\nThe worst error as a share of its bound, and the relative error that this is. A \
         value passes under 1.\n\n",
    );
    text += &matrix(&report.forms, "category", |row| category(&row.category).to_string());
    text.extend(report.left_out.iter().map(|what| format!("\nNot judged: {what}.\n")));
    text += "\n## Every formula\n\n";
    text += &matrix(&report.forms, "formula", |row| row.formula.clone());
    for forms in &report.forms {
        text += &format!("\n### {}: where each category is worst\n\n", forms.forms);
        let rows = forms.gathered(|row| row.category.clone()).into_iter().map(|row| {
            [
                category(&row.category).to_string(),
                row.judged.to_string(),
                format!("{:.3}", row.worst),
                number(row.worst_error),
                row.quantity.to_string(),
                row.formula,
                format!("{}: {}", row.worst_id, row.worst_inputs),
            ]
        });
        let heads = ["category", "judged", "of the bound", "relative error", "of", "formula", "inputs"];
        text +=
            &format!("{}\n{}", markdown(&heads, |column| !(1..4).contains(&column), rows), conclusion(forms));
    }
    text += &integrators_text(report);
    text += &pictures(report);
    text += "\n## Formulas as printed\n\nEach is computed as it stands in 64 and in 32 bits (its functions rounded \
             correctly) and compared with the 64-bit form that stands in its place, whose own error is under 1e-14; \"none\": \
             overflow, or 0/0.\n";
    for PrintedFormula { source, formula, fails, instead, rows } in &report.printed {
        text += &format!("\n### {source}\n\n`{formula}`\n\n{fails}\n\nIn its place: {instead}\n\n");
        let rows = rows.iter().map(|row| {
            let [wide, narrow] = [row.printed_64, row.printed_32].map(number);
            [row.inputs.replace('|', "\\|"), wide, narrow, row.ours_32.map_or(String::new(), number)]
        });
        text +=
            &markdown(&["at", "printed, 64 bits", "printed, 32 bits", "in its place, 32 bits"], first, rows);
    }
    let verdict = if report.passed() { "every bound kept" } else { "A BOUND IS BROKEN" };
    text + &format!("\n{verdict}\n")
}

/// A row for each key, a column for each set of forms.
fn matrix(reports: &[Report], head: &str, key: impl Fn(&Row) -> String) -> String {
    let gathered: Vec<Vec<Row>> = reports.iter().map(|report| report.gathered(&key)).collect();
    let heads: Vec<&str> =
        [head].into_iter().chain(reports.iter().map(|report| report.forms.as_str())).collect();
    let line = |row: &Row| {
        let name = key(row);
        let cell = |rows: &Vec<Row>| {
            let judged = rows.iter().find(|row| key(row) == name).filter(|row| row.judged > 0);
            judged.map_or("not judged".into(), |row| {
                format!("{:.3} ({}){}", row.worst, number(row.worst_error), mark(row.broken == 0))
            })
        };
        let cells: Vec<String> = gathered.iter().map(cell).collect();
        [vec![name], cells].concat()
    };
    markdown(&heads, first, gathered.first().into_iter().flatten().map(line))
}

fn integrators_text(report: &StabilityReport) -> String {
    let row = |one: &IntegratorReport| {
        [
            one.integrator.to_string(),
            one.cases.to_string(),
            number(one.worst_error) + mark(one.passed()),
            one.bound.map_or("—".into(), |bound| format!("{bound:.0e}")),
            one.impossible.len().to_string(),
        ]
    };
    let heads = ["integrator", "cases", "error", "bound", "cannot be"];
    let mut text = String::from(
        "\n## Integrators in 64 bits\n\nOn the same segments, those that each serves, and on stiff ones of up to 1e30 of optical \
         depth: the largest error of C and A, as shares of what is possible at most. None may give what cannot be: no number, more \
         than opaque, brighter than its widgets.\n\n",
    );
    text += &markdown(&heads, first, report.integrators.iter().map(row));
    for one in &report.integrators {
        for (what, cases) in [("cannot be", &one.impossible), ("off by more", &one.broken)] {
            let named = cases.iter().take(NAMED);
            text.extend(named.map(|case| format!("\n{}, {what}: {case}\n", one.integrator)));
        }
    }
    text
}

/// A row for each scene, a column for each engine.
fn pictures(report: &StabilityReport) -> String {
    let mut engines: Vec<&str> = Vec::new();
    for picture in &report.pictures {
        if !engines.contains(&picture.engine.as_str()) {
            engines.push(&picture.engine);
        }
    }
    let heads = [vec!["what", "scene"], engines.clone(), vec!["bound"]].concat();
    let row = |first: &HardPicture| {
        let HardPicture { category, scene, bound, .. } = first;
        let cell = |engine: &&str| {
            let same = |picture: &&HardPicture| picture.scene == *scene && picture.engine == **engine;
            report.pictures.iter().find(same).map_or(String::new(), |picture| match &picture.refused {
                Some(why) => format!("refused: {why}"),
                None => number(picture.worst_error) + mark(picture.passed()),
            })
        };
        let cells: Vec<String> = engines.iter().map(cell).collect();
        [vec![category.to_string(), scene.clone()], cells, vec![format!("{bound:.0e}")]].concat()
    };
    let firsts = report.pictures.iter().filter(|picture| picture.engine == engines[0]);
    let intro = "\n## Hard scenes, drawn\n\nAgainst the 64-bit referee: the largest error of a channel of premultiplied linear RGBA.\n\n";
    intro.to_string() + &markdown(&heads, |column| column < 2, firsts.map(row))
}

/// Results of random scenes.
pub fn random_text(report: &RandomReport) -> String {
    let RandomReport { seed, drawn, shown, without_reference, refused, bound, beyond } = report;
    let mut text = format!(
        "{drawn} random scenes of seed {seed} against the 64-bit referee, bound {bound:.0e}; {shown} show something\n"
    );
    if *without_reference > 0 {
        text += &format!("  {without_reference} more that the referee says it cannot integrate\n");
    }
    refused.iter().for_each(|(engine, scenes)| text += &format!("  {scenes} that {engine} refuses\n"));
    for one in beyond {
        let BoundViolation { scene, position, engine, pixels, wrong, worst_error, worst_pixel: [i, j] } = one;
        let pixels = counted(*pixels, "pixel");
        let verdict = if *wrong == 0 { "explained".into() } else { format!("{wrong} NOT EXPLAINED") };
        text += &format!(
            "    {} scene {scene:>6}  {engine}: {pixels} beyond, {verdict}, {worst_error:.1e} at pixel {i}, {j}\n",
            position.name()
        );
    }
    let wrong = beyond.iter().filter(|scene| scene.wrong > 0).count();
    let explained = beyond.len() - wrong;
    text + &format!("  beyond the bound: {explained} explained by rounding, {wrong} not\n")
}

/// One report in every detail: a row for each kind, category and quantity.
pub fn forms_text(report: &Report) -> String {
    let heads = [
        "kind", "category", "quantity", "judged", "finite", "64 bits", "skipped", "broken", "worst",
        "of case",
    ];
    let mut rows = vec![heads.map(String::from).to_vec()];
    for row in report.gathered(|row| (row.kind, row.category.clone(), row.quantity)) {
        let names = [row.kind.into(), row.category, row.quantity.into()];
        let counts = [row.judged, row.only_finite, row.wider, row.skipped, row.broken].map(|n| n.to_string());
        rows.push([&names[..], &counts, &[format!("{:.3}", row.worst), row.worst_id]].concat());
    }
    let table = aligned(&rows, |column| !(3..9).contains(&column));
    format!("{} forms\n{table}{}", report.forms, conclusion(report))
}

/// Sums, exemptions, broken values and the verdict.
fn conclusion(report: &Report) -> String {
    let mut text = format!(
        "- {} judged, {} only asked to be finite, {} served in 64 bits, {} skipped\n",
        counted(report.total(|row| row.judged), "value"),
        report.total(|row| row.only_finite),
        report.total(|row| row.wider),
        report.total(|row| row.skipped)
    );
    for Exemption { wider, reason, count } in &report.exemptions {
        let what = if *wider { "served in 64 bits" } else { "skipped" };
        text += &format!("- {what}: {}, since {reason}\n", counted(*count, "case"));
    }
    for broken in report.broken.iter().take(NAMED) {
        text += &format!(
            "- broken: {} of {}: {:e}, exact {:e}, {:.3} times the bound\n",
            broken.quantity, broken.id, broken.found, broken.exact, broken.ratio
        );
    }
    if report.broken.len() > NAMED {
        text += &format!("- broken: and {} more\n", report.broken.len() - NAMED);
    }
    let verdict = match (report.passed(), report.worst()) {
        (false, _) => format!("{} BROKE ITS BOUND", counted(report.broken.len(), "value")),
        (true, Some(row)) => {
            format!("every bound kept; the worst error is {:.3} of its bound ({})", row.worst, row.worst_id)
        }
        (true, None) => "nothing was judged".into(),
    };
    text + &format!("- {}: {verdict}\n", report.forms)
}

#[cfg(test)]
mod tests {
    use super::*;
    use voltet_core::progress::NoProgress;
    use voltet_judge::shipped;

    #[test]
    fn every_integrator_gives_what_can_be() {
        let stride = if voltet_testing::whole_series() { 1 } else { 4 };
        let cases: Vec<_> = shipped().expect("well formed").into_iter().step_by(stride).collect();
        let all = integrators(&cases, &NoProgress).expect("run");
        assert_eq!(all.len(), kinds().count());
        for found in all {
            assert!(found.passed() && found.cases > 5, "{found:#?}");
        }
    }

    #[test]
    fn what_cannot_be_is_noticed() {
        let given = Contribution { optical_depth: 1.0, color: [0.5; 3], opacity: 0.6 };
        assert!(possible(&given, 0.5));
        for wrong in [
            Contribution { opacity: 1.0 + 1e-5, ..given },
            Contribution { optical_depth: f64::NAN, ..given },
            Contribution { color: [0.5, -1e-300, 0.0], ..given },
            Contribution { color: [0.5 + 1e-5, 0.0, 0.0], ..given },
            Contribution { color: [f64::INFINITY; 3], ..given },
        ] {
            assert!(!possible(&wrong, 0.5), "{wrong:?}");
        }
    }
}
