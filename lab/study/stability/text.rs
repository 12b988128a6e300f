//! Results as text for a terminal.

use super::random::{BoundViolation, RandomReport};
use super::report::{StabilityReport, category};
use super::{HardPicture, IntegratorReport, PrintedFormula};
use voltet_judge::{Exemption, Report, Row};

/// Violation values that are named one by one.
const NAMED: usize = 20;

/// Everything.
pub fn text(found: &StabilityReport) -> String {
    let mut text = String::new();
    for report in &found.forms {
        text += &format!("{} forms, {} cases: worst of each category\n", report.forms, report.cases);
        text += &rows(
            &report.gathered(|row| row.category.clone()),
            |row| category(&row.category),
            |row| row.formula.clone(),
        );
        text += "  worst of each formula\n";
        text += &rows(
            &report.gathered(|row| row.formula.clone()),
            |row| &row.formula,
            |row| category(&row.category).to_string(),
        );
        text += &conclusion(report);
        text += "\n";
    }
    text += "integrators in 64 bits: largest error of C and A, as shares of what is possible at most\n";
    found.integrators.iter().for_each(|integrated| text += &integrator(integrated));
    text += "\n";
    for engine in found.engines() {
        text += &format!("pictures by {engine} against the 64-bit referee\n");
        found
            .pictures
            .iter()
            .filter(|drawn| drawn.engine == engine)
            .for_each(|drawn| text += &picture(drawn));
    }
    let broken = found.pictures.iter().filter(|drawn| !drawn.passed()).count();
    text += &match broken {
        0 => "  pictures: every bound kept\n".to_string(),
        n => format!("  pictures: {n} BROKE THE BOUND\n"),
    };
    text += "\nformulas as printed, relative errors (those under 1e-14 are the 64-bit form's own)\n";
    found.printed.iter().for_each(|printed| text += &formula(printed));
    if !found.left_out.is_empty() {
        text += "\n";
    }
    found.left_out.iter().for_each(|what| text += &format!("not judged: {what}\n"));
    let verdict = if found.passed() { "every bound kept" } else { "A BOUND IS BROKEN" };
    text + &format!("\n{verdict}\n")
}

fn rows(rows: &[Row], name: impl Fn(&Row) -> &str, other: impl Fn(&Row) -> String) -> String {
    let width = rows.iter().map(|row| name(row).chars().count()).max().unwrap_or(0);
    let line = |row: &Row| {
        if row.judged == 0 {
            return format!(
                "    {:width$}      0 judged, {} served in 64 bits, {} only asked to be finite\n",
                name(row),
                row.wider,
                row.only_finite
            );
        }
        format!(
            "    {:width$}  {:>5} judged, {:>6.3} of the bound, error {:>7.1e} of {:3} {} ({}): {}\n",
            name(row),
            row.judged,
            row.worst,
            row.worst_error,
            row.quantity,
            other(row),
            row.worst_id,
            row.worst_inputs
        )
    };
    rows.iter().map(line).collect()
}

fn integrator(found: &IntegratorReport) -> String {
    let IntegratorReport { integrator, cases, worst_error, worst_case, bound, broken, impossible } = found;
    let bound = bound.map_or(String::new(), |bound| format!(" of {bound:.0e}"));
    let verdict = if found.passed() { "" } else { "  BROKEN" };
    let mut text = format!(
        "    {integrator:27}  {cases:>5} cases, error {worst_error:.1e}{bound} ({worst_case}){verdict}\n"
    );
    for what in impossible.iter().take(NAMED) {
        text += &format!("        cannot be: {what}\n");
    }
    for what in broken.iter().take(NAMED) {
        text += &format!("        off by more: {what}\n");
    }
    text
}

fn picture(drawn: &HardPicture) -> String {
    let HardPicture { category, scene, worst_error, worst_pixel: [i, j], bound, .. } = drawn;
    if let Some(why) = &drawn.refused {
        return format!("    {category:23}  {scene:45}  refused: {why}\n");
    }
    let verdict = if drawn.passed() { "" } else { "  BROKEN" };
    format!(
        "    {category:23}  {scene:45}  error {worst_error:.1e} of {bound:.0e} at pixel {i}, {j}{verdict}\n"
    )
}

/// Results of random scenes.
pub fn random_text(found: &RandomReport) -> String {
    let RandomReport { seed, drawn, shown, without_reference, refused, bound, beyond } = found;
    let mut text = format!(
        "{drawn} random scenes of seed {seed} against the 64-bit referee, bound {bound:.0e}; {shown} show something\n"
    );
    if *without_reference > 0 {
        text += &format!("  {without_reference} more that the referee says it cannot integrate\n");
    }
    refused.iter().for_each(|(engine, scenes)| text += &format!("  {scenes} that {engine} refuses\n"));
    let line = |scene: &BoundViolation| {
        let BoundViolation { scene, engine, pixels, wrong, worst_error, worst_pixel: [i, j] } = scene;
        let verdict = match wrong {
            0 => "explained".to_string(),
            n => format!("{n} NOT EXPLAINED"),
        };
        format!(
            "    scene {scene:>6}  {engine}: {pixels} pixels beyond, {verdict}, {worst_error:.1e} at pixel {i}, {j}\n"
        )
    };
    beyond.iter().for_each(|scene| text += &line(scene));
    let wrong = beyond.iter().filter(|scene| scene.wrong > 0).count();
    let explained = beyond.len() - wrong;
    text + &format!("  beyond the bound: {explained} explained by rounding, {wrong} not\n")
}

fn formula(printed: &PrintedFormula) -> String {
    let mut text = format!("  {}: {}\n", printed.source, printed.formula);
    text += &format!("      {}\n      in its place: {}\n", printed.fails, printed.instead);
    for row in &printed.rows {
        text += &format!(
            "      {:44}  64 bits {:8}  32 bits {:8}  in its place, 32 bits {}\n",
            row.inputs,
            number(row.printed_64),
            number(row.printed_32),
            row.ours_32.map_or("-".into(), number)
        );
    }
    text
}

/// An error; what is no number is said so.
pub(super) fn number(error: f64) -> String {
    if error.is_finite() { format!("{error:.1e}") } else { "none".into() }
}

fn counted(count: usize, noun: &str) -> String {
    format!("{count} {noun}{}", if count == 1 { "" } else { "s" })
}

fn described(exemption: &Exemption) -> String {
    let what = if exemption.wider { "served in 64 bits" } else { "skipped" };
    format!("{what}: {}, since {}", counted(exemption.count, "case"), exemption.reason)
}

/// One report in every detail: a row for each kind, category and quantity.
pub fn forms_text(report: &Report) -> String {
    let mut text = format!("{} forms\n", report.forms);
    text += "  kind     category   quantity      judged   finite  64 bits  skipped   broken  worst      of case\n";
    for row in report.gathered(|row| (row.kind, row.category.clone(), row.quantity)) {
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
    text + &conclusion(report)
}

/// Sums, exemptions, broken values and the verdict.
fn conclusion(report: &Report) -> String {
    let mut text = format!(
        "  {} judged, {} only asked to be finite, {} served in 64 bits, {} skipped\n",
        counted(report.total(|row| row.judged), "value"),
        report.total(|row| row.only_finite),
        report.total(|row| row.wider),
        report.total(|row| row.skipped)
    );
    text.extend(report.exemptions.iter().map(|exemption| format!("  {}\n", described(exemption))));
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
