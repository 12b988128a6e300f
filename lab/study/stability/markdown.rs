//! Results as a page of documentation.

use super::report::{StabilityReport, category};
use super::text::number;
use super::{HardPicture, PrintedFormula};
use voltet_judge::{Report, Row};

/// The page, without a title.
pub fn markdown(found: &StabilityReport) -> String {
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
        text += &exemptions(report);
    }
    text += &integrators(found);
    text += &pictures(found);
    text += "\n## Formulas as printed\n\nEach is computed as it stands in 64 and in 32 bits (its functions rounded ";
    text += "correctly) and compared with the 64-bit form that stands in its place, whose own error is under 1e-14; \"none\": overflow, or 0/0.\n";
    found.printed.iter().for_each(|printed| text += &formula(printed));
    text
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
        text += &format!("| {name} | {cases} | {} | {bound} | {impossible} |\n", number(found.worst_error));
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

fn exemptions(report: &Report) -> String {
    if report.exemptions.is_empty() {
        return String::new();
    }
    let line = |exemption: &voltet_judge::Exemption| {
        let what = if exemption.wider { "left to the 64-bit forms" } else { "skipped" };
        format!("- {} cases {what}: {}\n", exemption.count, exemption.reason)
    };
    format!("\n{}", report.exemptions.iter().map(line).collect::<String>())
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
