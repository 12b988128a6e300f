//! The test as tables of plain text, and as one HTML page that needs no other file.

use super::report::{FilterReport, GradientTest};
use crate::columns::aligned;
use crate::work_precision::canvas::escaped;
use crate::work_precision::page::{figure, head, line_to as line};

/// Everything, filters side by side.
pub fn text(test: &GradientTest) -> String {
    let mut text = String::new();
    for Table { title, heads, rows, note } in tables(test) {
        // The first column at least is a name; further ones stand before the filters.
        let is_name = |k: usize| k == 0 || matches!(heads[k].as_str(), "field" | "where");
        line(&mut text, &format!("\n{title}"));
        let rows = [std::slice::from_ref(&heads), &rows].concat();
        aligned(&rows, is_name).lines().for_each(|row| line(&mut text, &format!("  {row}")));
        line(&mut text, &format!("  {note}"));
    }
    faults(test).for_each(|fault| line(&mut text, &fault));
    let name = test.filters.first().map_or("", |filter| filter.name.as_str());
    if !test.requirements.is_empty() {
        line(&mut text, &format!("\nWhat {name} is held to"));
    }
    for requirement in &test.requirements {
        let mark = if requirement.holds { "held  " } else { "BROKEN" };
        line(&mut text, &format!("  {mark}  {}; found {}", requirement.what, requirement.found));
    }
    text.trim_start().to_string()
}

/// Failures and fall-backs of all filters, a sentence each.
fn faults(test: &GradientTest) -> impl Iterator<Item = String> {
    let each = test.filters.iter().flat_map(|filter| filter.faults.iter().map(move |fault| (filter, fault)));
    each.map(|(filter, fault)| {
        let did = if fault.failed { "failed" } else { "fell back" };
        format!("{} {did}, {}: {}", filter.name, fault.at, fault.what)
    })
}

/// A table: its rows begin with what they are of.
struct Table {
    title: String,
    heads: Vec<String>,
    rows: Vec<Vec<String>>,
    note: String,
}

/// A row of one filter: what it is of, and its cell.
type Cell = (Vec<String>, String);

fn cell<const N: usize>(names: [&str; N], value: String) -> Cell {
    (names.map(str::to_string).to_vec(), value)
}

/// A table with one column a filter: rows by what they are of, that of any filter that has it.
fn table(
    test: &GradientTest,
    title: String,
    heads: &[&str],
    cells: impl Fn(&FilterReport) -> Vec<Cell>,
    note: &str,
) -> Table {
    let each: Vec<Vec<Cell>> = test.filters.iter().map(cells).collect();
    let mut keys: Vec<&Vec<String>> = Vec::new();
    for (key, _) in each.iter().flatten() {
        if !keys.contains(&key) {
            keys.push(key);
        }
    }
    let value = |cells: &Vec<Cell>, key: &Vec<String>| {
        cells.iter().find(|(other, _)| other == key).map_or("failed".into(), |(_, value)| value.clone())
    };
    let row = |key: &&Vec<String>| {
        key.iter().cloned().chain(each.iter().map(|cells| value(cells, key))).collect::<Vec<_>>()
    };
    let names = test.filters.iter().map(|filter| filter.name.clone());
    let heads = heads.iter().map(|head| head.to_string()).chain(names).collect();
    Table { title, heads, rows: keys.iter().map(row).collect(), note: note.into() }
}

fn tables(test: &GradientTest) -> Vec<Table> {
    let order = |order: Option<f64>, error: Option<&f64>| {
        let order = order.map_or("–".into(), |order| format!("{order:.2}"));
        format!("{order} ({:.1e})", error.copied().unwrap_or(f64::NAN))
    };
    let finest = test.levels.last().copied().unwrap_or(0);
    let cost = test.filters.iter().find_map(|filter| filter.cost.as_ref());
    let cost = cost
        .map_or(String::new(), |cost| format!(": {} points, {} tetrahedra", cost.points, cost.tetrahedra));
    let picture = test.filters.iter().find_map(|filter| filter.picture.as_ref()).map(|picture| picture.size);
    let picture = picture.map_or(String::new(), |[w, h]| format!(" of {w} × {h} pixels"));
    vec![
        table(
            test,
            format!("Order of convergence, and relative error (rms) at {finest} boxes a side"),
            &["grid", "field", "where"],
            |found| {
                let both = found.convergence.iter().flat_map(|one| {
                    [("inside", &one.inside), ("boundary", &one.boundary)].map(|(place, series)| {
                        cell(
                            [one.mesh, one.field, place],
                            order(series.order, series.root_mean_square.last()),
                        )
                    })
                });
                both.collect()
            },
            &format!(
                "between the two finest of {:?} boxes a side; relative to the rms of the exact gradient",
                test.levels
            ),
        ),
        table(
            test,
            "Largest error on a linear and a quadratic field".into(),
            &["grid", "field", "where"],
            |found| {
                let each = found.exactness.iter().flat_map(|one| {
                    [
                        ("linear", "everywhere", one.linear),
                        ("quadratic", "inside", one.quadratic_inside),
                        ("quadratic", "boundary", one.quadratic_boundary),
                    ]
                    .map(|(field, place, error)| cell([one.mesh, field, place], format!("{error:.1e}")))
                });
                each.collect()
            },
            "relative to the largest gradient; 1e-12 and less is rounding",
        ),
        table(
            test,
            "Two materials: ∂s/∂x jumps from 1 to 10 in a plane of the grid".into(),
            &["what"],
            |found| {
                found.materials.as_ref().map_or(Vec::new(), |one| {
                    vec![
                        cell(["order beyond two cells (largest error)"], order(one.order, one.beyond.last())),
                        cell(["cells that errors of 1 % reach"], one.reach.to_string()),
                        cell(["overshoot"], format!("{:.1e}", one.overshoot)),
                    ]
                })
            },
            "by the jump",
        ),
        table(
            test,
            "What should change nothing: largest difference".into(),
            &["under", "rounding"],
            |found| {
                let each = found.invariance.iter();
                let each = each.map(|one| {
                    cell([one.under, &format!("{:.0e}", one.rounding)], format!("{:.1e}", one.difference))
                });
                each.collect()
            },
            "relative to the largest gradient; rounding: what differences of values may make of the last digit",
        ),
        table(
            test,
            "Noise of variance 1 at the points: rms of its gradient × spacing".into(),
            &["grid", "where"],
            |found| {
                let both = found.noise.iter().flat_map(|one| {
                    [("inside", one.inside), ("boundary", one.boundary)]
                        .map(|(place, size)| cell([one.mesh, place], format!("{size:.2}")))
                });
                both.collect()
            },
            "less is smoother; it is paid for by errors above",
        ),
        table(
            test,
            format!("Cost{cost}, {} threads", test.threads),
            &["what"],
            |found| {
                let Some(one) = &found.cost else { return Vec::new() };
                let ms = |seconds: f64| format!("{:.1}", 1e3 * seconds);
                let mib = one.memory_bytes.map(|bytes| format!("{:.1}", bytes as f64 / f64::from(1 << 20)));
                vec![
                    cell(["median, ms"], ms(one.median_s)),
                    cell(["fastest, ms"], ms(one.fastest_s)),
                    cell(["slowest, ms"], ms(one.slowest_s)),
                    cell(["10⁶ points/s"], format!("{:.2}", 1e-6 * one.points as f64 / one.median_s)),
                    cell(["memory, MiB"], mib.unwrap_or("–".into())),
                ]
            },
            "filters take turns; memory beyond what the process held",
        ),
        table(
            test,
            format!(
                "A picture{picture} whose widgets look at |∇s|, against the same with the exact gradient"
            ),
            &["what"],
            |found| {
                let Some(one) = &found.picture else { return Vec::new() };
                vec![
                    cell(["largest error"], format!("{:.1e}", one.maximum)),
                    cell(["rms error"], format!("{:.1e}", one.root_mean_square)),
                    cell(["pixels over 1/255"], one.pixels_over_step.to_string()),
                ]
            },
            &format!("lit, 16 boxes a side, engine {}; 1 is full scale", test.engine),
        ),
    ]
}

/// The page. `plot`: the SVG document.
pub fn page(test: &GradientTest, plot: &str) -> String {
    let names: Vec<String> = test.filters.iter().map(|filter| escaped(&filter.name)).collect();
    let title =
        names.first().map_or("Gradient filters".to_string(), |name| format!("Gradient filter {name}"));
    let mut html = head(&title);
    if let Some(filter) = test.filters.first() {
        let set: Vec<String> =
            filter.parameters.iter().map(|(name, value)| format!("{name} = {value}")).collect();
        let with =
            if set.is_empty() { String::new() } else { format!(" With {}.", escaped(&set.join(", "))) };
        line(&mut html, &format!("<p>{}{with}</p>", escaped(&filter.summary)));
    }
    let beside =
        names.get(1..).filter(|rest| !rest.is_empty()).map_or("no other".into(), |rest| rest.join(", "));
    let version = env!("CARGO_PKG_VERSION");
    line(&mut html, &format!("<p>Beside {beside}. Every error is against a formula; voltet {version}.</p>"));
    if !test.requirements.is_empty() {
        line(&mut html, "<h2>What it is held to</h2>\n<ul>");
        for requirement in &test.requirements {
            let (class, mark) =
                if requirement.holds { ("", "held") } else { (" class=\"broken\"", "BROKEN") };
            let (what, found) = (escaped(&requirement.what), escaped(&requirement.found));
            line(&mut html, &format!("<li{class}>{mark}: {what}; found {found}</li>"));
        }
        line(&mut html, "</ul>");
    }
    line(&mut html, &format!("<h2>Error against fineness</h2>\n{plot}"));
    for table in tables(test) {
        let first_figure = table.heads.len() - test.filters.len();
        let class = |k: usize| if k < first_figure { " class=\"name\"" } else { "" };
        let cells = |tag: &str, row: &[String]| -> String {
            let cell = |(k, cell): (usize, &String)| format!("<{tag}{}>{}</{tag}>", class(k), escaped(cell));
            row.iter().enumerate().map(cell).collect()
        };
        line(&mut html, &format!("<h2>{}</h2>\n<div class=\"wide\"><table>", escaped(&table.title)));
        line(&mut html, &format!("<thead><tr>{}</tr></thead>\n<tbody>", cells("th", &table.heads)));
        for row in &table.rows {
            line(&mut html, &format!("<tr>{}</tr>", cells("td", row)));
        }
        line(&mut html, &format!("</tbody></table></div>\n<p class=\"note\">{}</p>", escaped(&table.note)));
    }
    figure(&mut html, &test.exact_png, "the exact gradient");
    for filter in &test.filters {
        if let Some(picture) = &filter.picture {
            let caption = format!("{}: largest error {:.1e}", filter.name, picture.maximum);
            figure(&mut html, &picture.png, &caption);
        }
    }
    let faults: Vec<String> = faults(test).map(|fault| format!("<li>{}</li>\n", escaped(&fault))).collect();
    if !faults.is_empty() {
        line(&mut html, &format!("<h2>Failures and fall-backs</h2>\n<ul>\n{}</ul>", faults.concat()));
    }
    html + "</body>\n</html>\n"
}
