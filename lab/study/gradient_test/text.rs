//! The test as tables of plain text.

use super::report::{FilterReport, GradientTest, Series};
use crate::columns::aligned;
use std::fmt::Write;

/// Everything, filters side by side.
pub fn text(test: &GradientTest) -> String {
    let mut text = String::new();
    for table in tables(test) {
        line(&mut text, &format!("\n{}", table.title));
        // The first column at least is a name; further ones stand before the filters.
        let is_name = |k: usize| k == 0 || matches!(table.heads[k].as_str(), "field" | "where");
        let rows = [std::slice::from_ref(&table.heads), &table.rows].concat();
        aligned(&rows, is_name).lines().for_each(|row| line(&mut text, &format!("  {row}")));
        if !table.note.is_empty() {
            line(&mut text, &format!("  {}", table.note));
        }
    }
    for filter in &test.filters {
        for fault in &filter.faults {
            line(&mut text, &fault.said(&filter.name));
        }
    }
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

/// A table: its rows begin with what they are of.
pub(super) struct Table {
    pub title: String,
    pub heads: Vec<String>,
    pub rows: Vec<Vec<String>>,
    pub note: String,
}

/// All figures.
pub(super) fn tables(test: &GradientTest) -> Vec<Table> {
    let names: Vec<String> = test.filters.iter().map(|filter| filter.name.clone()).collect();
    let heads =
        |first: &[&str]| first.iter().map(|head| head.to_string()).chain(names.clone()).collect::<Vec<_>>();
    let finest = test.levels.last().copied().unwrap_or(0);
    let mut tables = vec![
        Table {
            title: format!("Order of convergence, and relative error (rms) at {finest} boxes a side"),
            heads: heads(&["grid", "field", "where"]),
            rows: convergence_rows(&test.filters),
            note: format!("between the two finest of {:?} boxes a side; relative to the rms of the exact gradient", test.levels),
        },
        Table {
            title: "Largest error on a linear and a quadratic field".into(),
            heads: heads(&["grid", "field", "where"]),
            rows: exactness_rows(&test.filters),
            note: "relative to the largest gradient; 1e-12 and less is rounding".into(),
        },
        Table {
            title: "Two materials: ∂s/∂x jumps from 1 to 10 in a plane of the grid".into(),
            heads: heads(&["what"]),
            rows: materials_rows(&test.filters),
            note: "by the jump".into(),
        },
        Table {
            title: "What should change nothing: largest difference".into(),
            heads: heads(&["under", "rounding"]),
            rows: invariance_rows(&test.filters),
            note: "relative to the largest gradient; rounding: what differences of values may make of the last digit".into(),
        },
        Table {
            title: "Noise of variance 1 at the points: rms of its gradient × spacing".into(),
            heads: heads(&["grid", "where"]),
            rows: noise_rows(&test.filters),
            note: "less is smoother; it is paid for by errors above".into(),
        },
    ];
    let cost = test.filters.iter().find_map(|filter| filter.cost.as_ref());
    let size = cost
        .map_or(String::new(), |cost| format!(": {} points, {} tetrahedra", cost.points, cost.tetrahedra));
    tables.push(Table {
        title: format!("Cost{size}, {} threads", test.threads),
        heads: heads(&["what"]),
        rows: cost_rows(&test.filters),
        note: "filters take turns; memory beyond what the process held".into(),
    });
    let size = test.filters.iter().find_map(|filter| filter.picture.as_ref()).map(|picture| picture.size);
    let size = size.map_or(String::new(), |[w, h]| format!(" of {w} × {h} pixels"));
    tables.push(Table {
        title: format!(
            "A picture{size} whose widgets look at |∇s|, against the same with the exact gradient"
        ),
        heads: heads(&["what"]),
        rows: picture_rows(&test.filters),
        note: format!("lit, 16 boxes a side, engine {}; 1 is full scale", test.engine),
    });
    tables
}

/// Rows with one cell a filter, by what they are of: that of any filter that has it.
fn rows<T>(
    filters: &[FilterReport],
    of: impl Fn(&FilterReport) -> Vec<(Vec<String>, T)>,
    cell: impl Fn(&T) -> String,
) -> Vec<Vec<String>> {
    let each: Vec<Vec<(Vec<String>, T)>> = filters.iter().map(of).collect();
    let mut keys: Vec<&Vec<String>> = Vec::new();
    for (key, _) in each.iter().flatten() {
        if !keys.contains(&key) {
            keys.push(key);
        }
    }
    let cells = |key: &Vec<String>| {
        let found = |one: &Vec<(Vec<String>, T)>| {
            one.iter().find(|(other, _)| other == key).map(|(_, value)| cell(value))
        };
        each.iter().map(move |one| found(one).unwrap_or_else(|| "failed".into())).collect::<Vec<_>>()
    };
    keys.iter().map(|key| [(*key).clone(), cells(key)].concat()).collect()
}

fn keys<const N: usize>(names: [&str; N]) -> Vec<String> {
    names.map(str::to_string).to_vec()
}

fn convergence_rows(filters: &[FilterReport]) -> Vec<Vec<String>> {
    let of = |found: &FilterReport| {
        let both = |one: &super::Convergence| {
            [("inside", &one.inside), ("boundary", &one.boundary)]
                .map(|(place, series)| (keys([one.mesh, one.field, place]), series.clone()))
        };
        found.convergence.iter().flat_map(both).collect()
    };
    rows(filters, of, |series: &Series| {
        let order = series.order.map_or("–".into(), |order| format!("{order:.2}"));
        format!("{order} ({:.1e})", series.root_mean_square.last().copied().unwrap_or(f64::NAN))
    })
}

fn exactness_rows(filters: &[FilterReport]) -> Vec<Vec<String>> {
    let of = |found: &FilterReport| {
        let each = |one: &super::Exactness| {
            [
                (keys([one.mesh, "linear", "everywhere"]), one.linear),
                (keys([one.mesh, "quadratic", "inside"]), one.quadratic_inside),
                (keys([one.mesh, "quadratic", "boundary"]), one.quadratic_boundary),
            ]
        };
        found.exactness.iter().flat_map(each).collect()
    };
    rows(filters, of, |error: &f64| format!("{error:.1e}"))
}

fn materials_rows(filters: &[FilterReport]) -> Vec<Vec<String>> {
    let of = |found: &FilterReport| {
        let Some(one) = &found.materials else { return Vec::new() };
        let last = one.beyond.last().copied().unwrap_or(f64::NAN);
        let order = one.order.map_or("–".into(), |order| format!("{order:.2}"));
        vec![
            (keys(["order beyond two cells (largest error)"]), format!("{order} ({last:.1e})")),
            (keys(["cells that errors of 1 % reach"]), one.reach.to_string()),
            (keys(["overshoot"]), format!("{:.1e}", one.overshoot)),
        ]
    };
    rows(filters, of, String::clone)
}

fn invariance_rows(filters: &[FilterReport]) -> Vec<Vec<String>> {
    let of = |found: &FilterReport| {
        let each = |one: &super::Invariance| {
            (vec![one.under.to_string(), format!("{:.0e}", one.rounding)], one.difference)
        };
        found.invariance.iter().map(each).collect()
    };
    rows(filters, of, |difference: &f64| format!("{difference:.1e}"))
}

fn noise_rows(filters: &[FilterReport]) -> Vec<Vec<String>> {
    let of = |found: &FilterReport| {
        let both = |one: &super::Noise| {
            [(keys([one.mesh, "inside"]), one.inside), (keys([one.mesh, "boundary"]), one.boundary)]
        };
        found.noise.iter().flat_map(both).collect()
    };
    rows(filters, of, |size: &f64| format!("{size:.2}"))
}

fn cost_rows(filters: &[FilterReport]) -> Vec<Vec<String>> {
    let of = |found: &FilterReport| {
        let Some(one) = &found.cost else { return Vec::new() };
        let milliseconds = |seconds: f64| format!("{:.1}", 1e3 * seconds);
        let memory = one
            .memory_bytes
            .map_or("–".into(), |bytes| format!("{:.1}", bytes as f64 / f64::from(1 << 20)));
        vec![
            (keys(["median, ms"]), milliseconds(one.median_s)),
            (keys(["fastest, ms"]), milliseconds(one.fastest_s)),
            (keys(["slowest, ms"]), milliseconds(one.slowest_s)),
            (keys(["10⁶ points/s"]), format!("{:.2}", 1e-6 * one.points as f64 / one.median_s)),
            (keys(["memory, MiB"]), memory),
        ]
    };
    rows(filters, of, String::clone)
}

fn picture_rows(filters: &[FilterReport]) -> Vec<Vec<String>> {
    let of = |found: &FilterReport| {
        let Some(one) = &found.picture else { return Vec::new() };
        vec![
            (keys(["largest error"]), format!("{:.1e}", one.maximum)),
            (keys(["rms error"]), format!("{:.1e}", one.root_mean_square)),
            (keys(["pixels over 1/255"]), one.pixels_over_step.to_string()),
        ]
    };
    rows(filters, of, String::clone)
}

fn line(text: &mut String, of: &str) {
    // Writing to a String cannot fail.
    let _ = writeln!(text, "{of}");
}
