//! Results as a page of Markdown, which a terminal shows too.

use super::random::{BoundViolation, RandomReport};
use super::report::{StabilityReport, category};
use super::{HardPicture, PrintedFormula};
use voltet_judge::{Exemption, Report, Row};

/// Violation values that are named one by one.
const NAMED: usize = 20;

/// Everything, without a title.
pub fn text(found: &StabilityReport) -> String {
    let mut text = String::from("## Every formula, by category\n\nThe worst error as a share of its bound");
    text += ", and the relative error that this is. A value passes under 1.\n\n";
    text += &matrix(&found.forms, "category", |row| category(&row.category).to_string());
    text.extend(found.left_out.iter().map(|what| format!("\nNot judged: {what}.\n")));
    text += "\n## Every formula\n\n";
    text += &matrix(&found.forms, "formula", |row| row.formula.clone());
    for report in &found.forms {
        text += &format!("\n### {}: where each category is worst\n\n", report.forms);
        text += "| category | judged | of the bound | relative error | of | formula | inputs |\n";
        text += "| --- | ---: | ---: | ---: | --- | --- | --- |\n";
        for row in report.gathered(|row| row.category.clone()) {
            text += &format!(
                "| {} | {} | {:.3} | {} | {} | {} | {}: {} |\n",
                category(&row.category),
                row.judged,
                row.worst,
                number(row.worst_error),
                row.quantity,
                row.formula,
                row.worst_id,
                row.worst_inputs
            );
        }
        text += &format!("\n{}", conclusion(report));
    }
    text += &integrators(found);
    text += &pictures(found);
    text += "\n## Formulas as printed\n\nEach is computed as it stands in 64 and in 32 bits (its functions rounded ";
    text += "correctly) and compared with the 64-bit form that stands in its place, whose own error is under 1e-14; \"none\": overflow, or 0/0.\n";
    found.printed.iter().for_each(|printed| text += &formula(printed));
    let verdict = if found.passed() { "every bound kept" } else { "A BOUND IS BROKEN" };
    text + &format!("\n{verdict}\n")
}

/// A row for each integrator.
fn integrators(found: &StabilityReport) -> String {
    let mut text =
        String::from("\n## Integrators in 64 bits\n\nOn the same segments, those that each serves, and on ");
    text += "stiff ones of up to 1e30 of optical depth: the largest error of C and A, as shares of what is possible at ";
    text += "most. None may give what cannot be: no number, more than opaque, brighter than its widgets.\n\n";
    text += "| integrator | cases | error | bound | cannot be |\n| --- | ---: | ---: | ---: | ---: |\n";
    for found in &found.integrators {
        let bound = found.bound.map_or("—".into(), |bound| format!("{bound:.0e}"));
        let (name, cases, impossible) = (found.integrator, found.cases, found.impossible.len());
        let verdict = if found.passed() { "" } else { " **broken**" };
        text += &format!(
            "| {name} | {cases} | {}{verdict} | {bound} | {impossible} |\n",
            number(found.worst_error)
        );
    }
    for found in &found.integrators {
        let kinds = [("cannot be", &found.impossible), ("off by more", &found.broken)];
        for (what, cases) in kinds {
            text.extend(
                cases.iter().take(NAMED).map(|case| format!("\n{}, {what}: {case}\n", found.integrator)),
            );
        }
    }
    text
}

/// A row for each scene, a column for each engine.
fn pictures(found: &StabilityReport) -> String {
    let engines = found.engines();
    let mut text = String::from(
        "\n## Hard scenes, drawn\n\nAgainst the 64-bit referee: the largest error of a channel of ",
    );
    text += "premultiplied linear RGBA.\n\n";
    let columns = " ---: |".repeat(engines.len() + 1);
    text += &format!("| what | scene | {} | bound |\n| --- | --- |{columns}\n", engines.join(" | "));
    for first in found.pictures.iter().filter(|drawn| drawn.engine == engines[0]) {
        let HardPicture { category, scene, bound, .. } = first;
        let cell = |engine: &&str| {
            let same = |drawn: &&HardPicture| drawn.scene == *scene && drawn.engine == **engine;
            found.pictures.iter().find(same).map_or(String::new(), |drawn| {
                let broken = if drawn.passed() { "" } else { " **broken**" };
                match &drawn.refused {
                    Some(why) => format!("refused: {why}"),
                    None => format!("{}{broken}", number(drawn.worst_error)),
                }
            })
        };
        let cells: Vec<String> = engines.iter().map(cell).collect();
        text += &format!("| {category} | {scene} | {} | {bound:.0e} |\n", cells.join(" | "));
    }
    text
}

/// A row for each key, a column for each set of forms.
fn matrix(reports: &[Report], head: &str, key: impl Fn(&Row) -> String) -> String {
    let gathered: Vec<Vec<Row>> = reports.iter().map(|report| report.gathered(&key)).collect();
    let names: Vec<&str> = reports.iter().map(|report| report.forms.as_str()).collect();
    let mut text = format!("| {head} | {} |\n| --- |{}\n", names.join(" | "), " ---: |".repeat(names.len()));
    let Some(first) = gathered.first() else { return text };
    for row in first {
        let name = key(row);
        let cell = |rows: &Vec<Row>| {
            let found = rows.iter().find(|row| key(row) == name).filter(|row| row.judged > 0);
            found.map_or("not judged".into(), |row| {
                let broken = if row.broken > 0 { " **broken**" } else { "" };
                format!("{:.3} ({}){broken}", row.worst, number(row.worst_error))
            })
        };
        let cells: Vec<String> = gathered.iter().map(cell).collect();
        text += &format!("| {name} | {} |\n", cells.join(" | "));
    }
    text
}

fn formula(printed: &PrintedFormula) -> String {
    let PrintedFormula { source, formula, fails, instead, rows } = printed;
    let mut text = format!("\n### {source}\n\n`{formula}`\n\n{fails}\n\nIn its place: {instead}\n\n");
    text += "| at | printed, 64 bits | printed, 32 bits | in its place, 32 bits |\n| --- | ---: | ---: | ---: |\n";
    for row in rows {
        text += &format!(
            "| {} | {} | {} | {} |\n",
            row.inputs.replace('|', "\\|"),
            number(row.printed_64),
            number(row.printed_32),
            row.ours_32.map_or("".into(), number)
        );
    }
    text
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

/// An error; what is no number is said so.
fn number(error: f64) -> String {
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
        "- {} judged, {} only asked to be finite, {} served in 64 bits, {} skipped\n",
        counted(report.total(|row| row.judged), "value"),
        report.total(|row| row.only_finite),
        report.total(|row| row.wider),
        report.total(|row| row.skipped)
    );
    text.extend(report.exemptions.iter().map(|exemption| format!("- {}\n", described(exemption))));
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
