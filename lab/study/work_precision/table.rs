//! The figures of a study as a table for people, CSV and JSON.

use super::measure::Times;
use super::settings::overlap_name;
use super::{Convergence, Refused, RenderConfig, RendererVariant, Row, Study};
use crate::columns::{aligned, csv_cell};
use serde_json::{Value, json as object};
use voltet_graph::ParameterValue;
use voltet_optics::engine::Accumulation;

/// Milliseconds, with three digits that tell something.
pub(super) fn milliseconds(ms: f64) -> String {
    match ms {
        ms if ms < 10.0 => format!("{ms:.2}"),
        ms if ms < 100.0 => format!("{ms:.1}"),
        ms => format!("{ms:.0}"),
    }
}

/// Note above figures of time and work.
pub(super) const COMPARED: &str = "The integrators of an engine share all but the integration of a segment - cells, order, \
     compositing, number of bits and vector units - so that their times compare methods; evaluations are the places a pixel at which \
     the transfer function, its closed form or its table was asked.";

/// Rows as people look through them: cheapest first.
pub(super) fn by_time(study: &Study) -> Vec<usize> {
    let mut order: Vec<usize> = (0..study.rows.len()).collect();
    order.sort_by(|&a, &b| {
        let time = |i: usize| study.rows[i].cost.picture.median_ms;
        time(a).total_cmp(&time(b))
    });
    order
}

/// Columns of a table for people, with their cells. Medians; all times in milliseconds.
type Column = (&'static str, fn(&Study, &Row) -> String);

pub(super) const COLUMNS: [Column; 17] = [
    ("setting", |_, row| row.setting.label() + if row.of_file { " (the file's)" } else { "" }),
    ("picture ms", |_, row| milliseconds(row.cost.picture.median_ms)),
    ("evals/px", evaluations),
    ("rms", |_, row| format!("{:.1e}", row.errors.root_mean_square)),
    ("p99.9", |_, row| format!("{:.1e}", row.errors.percentile_99_9)),
    ("max", |_, row| format!("{:.1e}", row.errors.maximum)),
    (">1/255", |_, row| row.errors.pixels_over_step.to_string()),
    ("FLIP", |_, row| format!("{:.1e}", row.flip)),
    ("fastest", |_, row| milliseconds(row.cost.picture.fastest_ms)),
    ("slowest", |_, row| milliseconds(row.cost.picture.slowest_ms)),
    ("frames", |_, row| row.cost.frames.to_string()),
    ("set-up", |_, row| milliseconds(row.cost.set_up.median_ms)),
    ("cull", |_, row| stage(row.cost.cull)),
    ("sort", |_, row| stage(row.cost.sort)),
    ("project", |_, row| stage(row.cost.project)),
    ("composite", |_, row| stage(row.cost.composite)),
    ("memory MiB", |_, row| {
        row.cost.peak_memory_bytes.map_or("–".into(), |bytes| (bytes >> 20).to_string())
    }),
];

/// Evaluations a pixel, with three digits that tell something.
fn evaluations(study: &Study, row: &Row) -> String {
    let [width, height] = study.subject.scene.camera.size.map(f64::from);
    row.cost.evaluations.map_or("–".into(), |count| milliseconds(count as f64 / (width * height)))
}

fn stage(times: Option<Times>) -> String {
    times.map_or("–".into(), |times| milliseconds(times.median_ms))
}

pub(super) fn cells(study: &Study, row: &Row) -> impl Iterator<Item = String> {
    COLUMNS.into_iter().map(move |(_, cell)| cell(study, row))
}

/// The table, what is recommended, and the orders of convergence.
pub fn text(study: &Study) -> String {
    let mut rows = vec![[""].into_iter().chain(COLUMNS.map(|column| column.0)).map(String::from).collect()];
    for i in by_time(study) {
        let row = &study.rows[i];
        let recommended = if study.recommended == Some(i) { ">" } else { " " };
        let mark = format!("{recommended}{}", if row.on_front { "*" } else { " " });
        rows.push([mark].into_iter().chain(cells(study, row)).collect());
    }
    let mut text = aligned(&rows, |column| column < 2);
    text += &format!("* on the Pareto front (time, {} error), > recommended\n", study.wish.measure.name());
    text += &format!("{COMPARED}\n");
    let notes = engine_lines(study);
    for line in notes.iter().chain(&convergence_lines(study)).chain(&refinement_lines(study)) {
        text += &format!("{line}\n");
    }
    text
}

/// Lines on devices, on configurations that they do not draw, and on engines that were not measured.
pub(super) fn engine_lines(study: &Study) -> Vec<String> {
    let mut lines = Vec::new();
    for adapter in &study.adapters {
        let software = if adapter.is_software {
            "; a program on the CPU, which says nothing of graphics hardware"
        } else {
            ""
        };
        lines.push(format!(
            "{}: {}{software}; total is a frame with grid, pipelines and tables in place, set-up is made once",
            adapter.engine.name, adapter.name
        ));
    }
    let mut reasons: Vec<(String, Vec<String>)> = Vec::new();
    for refused in &study.refused {
        let (reason, label) = (refused.error.to_string(), refused.setting.label());
        match reasons.iter_mut().find(|known| known.0 == reason) {
            Some((_, labels)) => labels.push(label),
            None => reasons.push((reason, vec![label])),
        }
    }
    for (reason, labels) in reasons {
        lines.push(format!("the device does not draw {}: {reason}", labels.join("; ")));
    }
    lines.extend(study.left_out.iter().map(|what| format!("not measured: {what}")));
    lines
}

/// A sentence for each integrator that was looked at over its number of pieces.
pub(super) fn convergence_lines(study: &Study) -> Vec<String> {
    study.convergence.iter().map(convergence_line).collect()
}

fn convergence_line(found: &Convergence) -> String {
    let observed = found
        .observed
        .map_or("not seen: too few errors above the floor".into(), |order| format!("{order:.2}"));
    let steps: Vec<String> = found
        .levels
        .iter()
        .filter_map(|level| Some(format!("{} to {}: {:.2}", level.count / 2, level.count, level.order?)))
        .collect();
    let steps = if steps.is_empty() { String::new() } else { format!(" ({})", steps.join(", ")) };
    let engine = if found.engine == RendererVariant::NATIVE.label() {
        String::new()
    } else {
        format!(" on {}", found.engine)
    };
    format!(
        "order of {}{engine}: observed {observed}, expected {:.0} ({}){steps}, less a floor of {:.1e}",
        found.integrator, found.expected, found.reason, found.floor
    )
}

pub(super) fn refinement_lines(study: &Study) -> Vec<String> {
    let Some(found) = &study.refinement else { return Vec::new() };
    let rms = |errors: &Convergence| {
        errors.levels.iter().map(|level| format!("{:.1e}", level.error)).collect::<Vec<_>>().join(", ")
    };
    let cells: Vec<String> = found.cells.iter().map(u64::to_string).collect();
    let mut lines =
        vec![format!("grids of {} cells, each edge halved from one to the next", cells.join(", "))];
    for integration in &found.integration {
        lines.push(format!("the same field in smaller cells, rms error {}", rms(integration)));
        lines.push(format!("over halvings of the cells, {}", convergence_line(integration)));
    }
    lines.push(format!("values between the points by their gradients, rms change {}", rms(&found.model)));
    lines.push(format!("over halvings of the cells, {}", convergence_line(&found.model)));
    lines.push(format!(
        "the picture is off by about {:.1e} (rms) since the data are taken as linear in cells, by {:.1e} through integration \
         in closed form",
        found.model_error, found.integration_error
    ));
    lines
}

/// Columns of the CSV file, and where their values stand in a row's JSON. Errors are of premultiplied linear RGBA.
const CSV: [(&str, &str); 32] = [
    ("engine", "/setting/engine"),
    ("compositor", "/setting/compositor"),
    ("adapter", "/setting/adapter"),
    ("integrator", "/setting/integrator"),
    ("segments", "/setting/segments"),
    ("tolerance", "/setting/tolerance"),
    ("table_size", "/setting/table_size"),
    ("oversampling", "/setting/oversampling"),
    ("planes", "/setting/planes"),
    ("overlap", "/setting/overlap"),
    ("order", "/setting/order"),
    ("frames", "/cost/frames"),
    ("picture_ms", "/cost/picture/median_ms"),
    ("picture_fastest_ms", "/cost/picture/fastest_ms"),
    ("picture_slowest_ms", "/cost/picture/slowest_ms"),
    ("set_up_ms", "/cost/set_up/median_ms"),
    ("frame_ms", "/cost/frame/median_ms"),
    ("cull_ms", "/cost/cull/median_ms"),
    ("sort_ms", "/cost/sort/median_ms"),
    ("project_ms", "/cost/project/median_ms"),
    ("composite_ms", "/cost/composite/median_ms"),
    ("rms_error", "/errors/root_mean_square"),
    ("p99_9_error", "/errors/percentile_99_9"),
    ("max_error", "/errors/maximum"),
    ("pixels_over_1_255", "/errors/pixels_over_step"),
    ("flip", "/flip"),
    ("peak_memory_bytes", "/cost/peak_memory_bytes"),
    ("ray_segments", "/cost/segments"),
    ("evaluations", "/cost/evaluations"),
    ("on_front", "/on_front"),
    ("recommended", "/recommended"),
    ("of_file", "/of_file"),
];

/// One line a setting, after a line of names.
pub fn csv(study: &Study) -> String {
    let mut text = CSV.map(|column| column.0).join(",") + "\n";
    for (i, row) in study.rows.iter().enumerate() {
        let mut row = row_json(study, row);
        row["recommended"] = (study.recommended == Some(i)).into();
        let cell = |(_, pointer): (&str, &str)| match row.pointer(pointer) {
            None | Some(Value::Null) => String::new(),
            // Names of devices hold commas.
            Some(Value::String(text)) => csv_cell(text),
            Some(other) => other.to_string(),
        };
        text += &(CSV.map(cell).join(",") + "\n");
    }
    text
}

fn setting_json(study: &Study, setting: &RenderConfig) -> Value {
    let adapter = study.adapters.iter().find(|adapter| adapter.engine == setting.variant.engine);
    let mut keys = object!({
        "engine": setting.variant.engine.name,
        "overlap": overlap_name(setting.overlap),
        "order": setting.order.name(),
    });
    let mut set = |name: &str, value: Option<Value>| value.map(|value| keys[name] = value);
    set("compositor", setting.variant.compositor().map(Value::from));
    let accumulation = Some(setting.accumulation).filter(|one| *one != Accumulation::Float);
    set("accumulation", accumulation.map(|one| one.name().into()));
    set("adapter", adapter.map(|adapter| adapter.name.as_str().into()));
    for (name, value) in setting.keys() {
        set(
            name,
            match value {
                ParameterValue::Text(word) => Some(word.into()),
                ParameterValue::Integer(n) => Some(n.into()),
                ParameterValue::Number(x) => Some(x.into()),
                _ => None,
            },
        );
    }
    keys
}

fn row_json(study: &Study, row: &Row) -> Value {
    object!({
        "label": row.setting.label(), "setting": setting_json(study, &row.setting), "cost": row.cost,
        "errors": row.errors, "flip": row.flip, "on_front": row.on_front, "of_file": row.of_file,
    })
}

/// Everything for programs. Numbers that JSON cannot hold are null.
pub fn json(study: &Study, title: &str) -> Value {
    let subject = &study.subject;
    let refused = |Refused { setting, error }: &Refused| object!({ "label": setting.label(), "setting": setting_json(study, setting), "reason": error.to_string() });
    object!({
        "title": title,
        "node": subject.node,
        "size": subject.scene.camera.size,
        "cells": subject.scene.volume.grid.tetrahedra.len(),
        "threads": rayon::current_num_threads(),
        "vector_units": study.vector_units,
        "measure": study.wish.measure.name(),
        "max_error": study.wish.max_error,
        "reference_seconds": study.reference.seconds,
        "reference_cached": study.reference.cached,
        "adapter": study.adapters.first().map(|adapter| &adapter.name),
        "settings": study.setting_count,
        "refused": study.refused.iter().map(refused).collect::<Vec<_>>(),
        "left_out": study.left_out,
        "stopped": study.stopped(),
        "rows": study.rows.iter().map(|row| row_json(study, row)).collect::<Vec<_>>(),
        "recommended": study.recommended.map(|i| row_json(study, &study.rows[i])),
        "convergence": study.convergence,
        "refinement": study.refinement,
        "versions": { "voltet": env!("CARGO_PKG_VERSION") },
    })
}
