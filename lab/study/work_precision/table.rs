//! The figures of a study as a table for people, CSV and JSON.

use super::measure::Cost;
use super::settings::overlap_name;
use super::{Convergence, Refused, RenderConfig, RendererVariant, Row, Study, Value as Key};
use crate::columns::aligned;
use serde_json::{Value, json as object};
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

/// Evaluations a pixel, with three digits that tell something.
fn evaluations(study: &Study, cost: &Cost) -> Option<String> {
    let [width, height] = study.subject.scene.camera.size.map(f64::from);
    cost.evaluations.map(|count| milliseconds(count as f64 / (width * height)))
}

/// Rows as people look through them: cheapest first.
pub(super) fn by_time(study: &Study) -> Vec<usize> {
    let mut order: Vec<usize> = (0..study.rows.len()).collect();
    order.sort_by(|&a, &b| {
        let time = |i: usize| study.rows[i].cost.picture.median_ms;
        time(a).total_cmp(&time(b))
    });
    order
}

/// Columns of a table for people. Medians; all times in milliseconds.
pub(super) const HEADS: [&str; 17] = [
    "setting",
    "picture ms",
    "evals/px",
    "rms",
    "p99.9",
    "max",
    ">1/255",
    "FLIP",
    "fastest",
    "slowest",
    "frames",
    "set-up",
    "cull",
    "sort",
    "project",
    "composite",
    "memory MiB",
];

/// Cells of a row, by the columns.
pub(super) fn cells(study: &Study, row: &Row) -> Vec<String> {
    let (cost, errors) = (&row.cost, &row.errors);
    let note = if row.of_file { " (the file's)" } else { "" };
    let mut cells = vec![format!("{}{note}", row.setting.label())];
    cells.push(milliseconds(cost.picture.median_ms));
    cells.push(evaluations(study, cost).unwrap_or("–".into()));
    let wrong = [errors.root_mean_square, errors.percentile_99_9, errors.maximum];
    cells.extend(wrong.map(|error| format!("{error:.1e}")));
    cells.push(errors.pixels_over_step.to_string());
    cells.push(format!("{:.1e}", row.flip));
    cells.extend([cost.picture.fastest_ms, cost.picture.slowest_ms].map(milliseconds));
    cells.push(cost.frames.to_string());
    let stages = [Some(cost.set_up), cost.cull, cost.sort, cost.project, cost.composite];
    cells.extend(stages.map(|times| times.map_or("–".into(), |times| milliseconds(times.median_ms))));
    cells.push(cost.peak_memory_bytes.map_or("–".into(), |bytes| (bytes >> 20).to_string()));
    cells
}

/// The table, what is recommended, and the orders of convergence.
pub fn text(study: &Study) -> String {
    let mut rows = vec![HEADS.map(str::to_string).to_vec()];
    rows[0].insert(0, String::new());
    for i in by_time(study) {
        let row = &study.rows[i];
        let mut line = cells(study, row);
        let recommended = if study.recommended == Some(i) { ">" } else { " " };
        line.insert(0, format!("{recommended}{}", if row.on_front { "*" } else { " " }));
        rows.push(line);
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

/// Lines on refining the grid.
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

/// One line a setting, after a line of names; times in milliseconds, errors of premultiplied linear RGBA.
pub fn csv(study: &Study) -> String {
    let mut text = String::from(
        "engine,compositor,adapter,integrator,segments,tolerance,table_size,oversampling,planes,overlap,order,frames,\
         picture_ms,picture_fastest_ms,picture_slowest_ms,set_up_ms,frame_ms,cull_ms,sort_ms,project_ms,composite_ms,rms_error,p99_9_error,\
         max_error,pixels_over_1_255,flip,peak_memory_bytes,ray_segments,evaluations,on_front,\
         recommended,of_file\n",
    );
    for (i, row) in study.rows.iter().enumerate() {
        let key = |name: &str| {
            let keys = row.setting.keys();
            let found = keys.iter().find(|key| key.0 == name).map(|key| key.1);
            match found {
                Some(Key::Text(word)) => word.to_string(),
                Some(Key::Integer(n)) => n.to_string(),
                Some(Key::Number(x)) => format!("{x:e}"),
                None => String::new(),
            }
        };
        let (cost, errors) = (&row.cost, &row.errors);
        let variant = row.setting.variant;
        let mut cells: Vec<String> =
            vec![variant.engine.name.into(), variant.compositor().unwrap_or_default().into()];
        cells.push(adapter(study, &row.setting).map_or(String::new(), quoted));
        let numbers = ["integrator", "segments", "tolerance", "table_size", "oversampling", "planes"];
        cells.extend(numbers.map(key));
        cells.push(overlap_name(row.setting.overlap).into());
        cells.push(row.setting.order.name().into());
        cells.push(cost.frames.to_string());
        let picture = [cost.picture.median_ms, cost.picture.fastest_ms, cost.picture.slowest_ms];
        let times = [cost.set_up.median_ms, cost.frame.median_ms];
        cells.extend(picture.into_iter().chain(times).map(|ms| format!("{ms:.4}")));
        let stages = [cost.cull, cost.sort, cost.project, cost.composite];
        cells.extend(stages.map(|times| times.map_or(String::new(), |t| format!("{:.4}", t.median_ms))));
        let wrong = [errors.root_mean_square, errors.percentile_99_9, errors.maximum];
        cells.extend(wrong.map(|error| format!("{error:.6e}")));
        cells.push(errors.pixels_over_step.to_string());
        cells.push(format!("{:.6e}", row.flip));
        cells.push(cost.peak_memory_bytes.map_or(String::new(), |bytes| bytes.to_string()));
        cells.extend(
            [cost.segments, cost.evaluations].map(|count| count.map_or(String::new(), |n| n.to_string())),
        );
        cells.extend([row.on_front, study.recommended == Some(i), row.of_file].map(|flag| flag.to_string()));
        text += &(cells.join(",") + "\n");
    }
    text
}

/// The device that a setting was drawn on.
fn adapter<'a>(study: &'a Study, setting: &RenderConfig) -> Option<&'a str> {
    let found = study.adapters.iter().find(|adapter| adapter.engine == setting.variant.engine);
    found.map(|adapter| adapter.name.as_str())
}

/// A text as a cell of CSV: names of devices hold commas.
fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('"', "\"\""))
}

/// Everything for programs. Numbers that JSON cannot hold are null.
pub fn json(study: &Study, title: &str) -> Value {
    let subject = &study.subject;
    let setting = |setting: &RenderConfig| {
        let mut keys = serde_json::Map::new();
        keys.insert("engine".into(), setting.variant.engine.name.into());
        keys.extend(setting.variant.compositor().map(|name| ("compositor".into(), name.into())));
        if setting.accumulation != Accumulation::Float {
            keys.insert("accumulation".into(), setting.accumulation.name().into());
        }
        keys.extend(adapter(study, setting).map(|name| ("adapter".into(), name.into())));
        for (name, key) in setting.keys() {
            keys.insert(
                name.into(),
                match key {
                    Key::Text(word) => word.into(),
                    Key::Integer(n) => n.into(),
                    Key::Number(x) => x.into(),
                },
            );
        }
        keys.insert("overlap".into(), overlap_name(setting.overlap).into());
        keys.insert("order".into(), setting.order.name().into());
        Value::Object(keys)
    };
    let row = |row: &Row| {
        object!({
            "label": row.setting.label(), "setting": setting(&row.setting), "cost": row.cost,
            "errors": row.errors, "flip": row.flip, "on_front": row.on_front, "of_file": row.of_file,
        })
    };
    let refused = |refused: &Refused| {
        let reason = refused.error.to_string();
        object!({ "label": refused.setting.label(), "setting": setting(&refused.setting), "reason": reason })
    };
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
        "rows": study.rows.iter().map(row).collect::<Vec<_>>(),
        "recommended": study.recommended.map(|i| row(&study.rows[i])),
        "convergence": study.convergence,
        "refinement": study.refinement,
        "versions": { "voltet": env!("CARGO_PKG_VERSION") },
    })
}
