//! A study as a table for people, CSV, JSON, and one HTML page that needs no other file; its files, and a setting written into a
//! pipeline file.

use crate::columns::{aligned, csv_cell};
use crate::work_precision::canvas::escaped;
use crate::work_precision::measure::Times;
use crate::work_precision::settings::overlap_name;
use crate::work_precision::{
    Benches, Convergence, Refused, RenderConfig, RendererNode, RendererVariant, Row, Study, StudyOptions,
    Subject, plot, reference, refuse_too_fine, study,
};
use serde_json::{Value, json as object};
use std::fmt::Write;
use std::path::{Path, PathBuf};
use voltet_core::progress::Progress;
use voltet_core::{Error, Result};
use voltet_document::{Document, Edit};
use voltet_graph::{Graph, Observer, ParameterValue};
use voltet_io::encode;
use voltet_nodes::files;
use voltet_optics::WidgetBlend;
use voltet_optics::integrators::Integrator;

/// Milliseconds, with three digits and two decimals at most.
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
            "{}: {}{software}; a picture is one with grid, pipelines and tables in place, set-up is made once",
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
    set("adapter", adapter.map(|adapter| adapter.name.as_str().into()));
    for (name, value) in setting.keys() {
        keys[name] = match value {
            ParameterValue::Text(word) => word.into(),
            ParameterValue::Integer(n) => n.into(),
            ParameterValue::Number(x) => x.into(),
            _ => continue,
        };
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

/// The look of pages: black on white, figures in columns, nothing that needs colour.
const STYLE: &str = include_str!("page.css");

/// Head of a page, up to its title. `title`: without characters of HTML.
pub(crate) fn head(title: &str) -> String {
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width\">\n<title>{title}</title>\n<style>{STYLE}</style>\n\
         </head>\n<body>\n<h1>{title}</h1>\n"
    )
}

const SHOWN: usize = 12;

/// The page. `plot`: the SVG document; `reference`: the reference picture as PNG.
pub fn page(study: &Study, title: &str, plot: &str, reference: &[u8]) -> String {
    let subject = &study.subject;
    let [width, height] = subject.scene.camera.size;
    let title = escaped(title);
    let mut html = head(&title);
    let drawn = if study.reference.cached { "kept from an earlier study; drawn" } else { "drawn" };
    paragraph(
        &mut html,
        &format!(
            "Node <code>{}</code>, {width} × {height} pixels, {} tetrahedra, {} threads, {}, voltet {}. Every setting against \
         the 64-bit reference ({drawn} in {:.1} s): adaptive quadrature of every ray segment, exact order.",
            escaped(&subject.node),
            subject.scene.volume.grid.tetrahedra.len(),
            rayon::current_num_threads(),
            escaped(study.vector_units),
            env!("CARGO_PKG_VERSION"),
            study.reference.seconds,
        ),
    );
    let notes: Vec<String> = engine_lines(study).iter().map(|line| escaped(line)).collect();
    notes.iter().for_each(|line| paragraph(&mut html, line));
    if study.stopped() {
        let done =
            format!("Stopped: {} of {} settings were measured.", study.rows.len(), study.setting_count);
        paragraph(&mut html, &format!("<strong>{done}</strong>"));
    }
    if let Some(text) = recommendation(study) {
        paragraph(&mut html, &format!("<strong>{}</strong>", escaped(&text)));
    }
    html += "<h2>Error against time</h2>\n";
    html += plot;
    html += &table(study);
    for (heading, lines) in [
        ("Integration and data model", refinement_lines(study)),
        ("Order of convergence", convergence_lines(study)),
    ] {
        if !lines.is_empty() {
            line_to(&mut html, &format!("<h2>{heading}</h2>\n<ul>"));
            lines.iter().for_each(|line| line_to(&mut html, &format!("<li>{}</li>", escaped(line))));
            html += "</ul>\n";
        }
    }
    if !study.convergence.is_empty() {
        paragraph(
            &mut html,
            "With an error of c·N<sup>−p</sup> for N pieces of a ray segment, p = log(e(N₁)/e(N₂)) / \
            log(N₂/N₁), after Etiene et al. 2014. Root-mean-square errors, less (by their squares) the floor that the closed \
            forms leave in the same order of segments; those under twice that floor are left out. Observed is the slope of the \
            four finest that are left.",
        );
    }
    html += &pictures(study, reference);
    html += MEANINGS;
    html + "</body>\n</html>\n"
}

/// Recommendation for the allowed error, in a sentence.
pub fn recommendation(study: &Study) -> Option<String> {
    let (bound, measure) = (study.wish.max_error?, study.wish.measure);
    let name = measure.words();
    Some(match study.recommended.map(|i| &study.rows[i]) {
        Some(row) => format!(
            "Cheapest with the {name} at most {bound}: {} ({} ms a picture{}, error {:.1e}).",
            row.setting.label(),
            milliseconds(row.cost.picture.median_ms),
            match row.setting.variant.engine.on_device {
                false => String::new(),
                true => format!(" after a set-up of {} ms", milliseconds(row.cost.set_up.median_ms)),
            },
            row.error(measure)
        ),
        None => {
            let least = study.rows.iter().map(|row| row.error(measure)).fold(f64::INFINITY, f64::min);
            format!("No setting measured keeps the {name} at most {bound}; the least is {least:.1e}.")
        }
    })
}

fn paragraph(html: &mut String, text: &str) {
    line_to(html, &format!("<p>{text}</p>"));
}

pub(crate) fn line_to(html: &mut String, text: &str) {
    // Writing to a String cannot fail.
    let _ = writeln!(html, "{text}");
}

fn table(study: &Study) -> String {
    let heads: String = COLUMNS.iter().map(|column| format!("<th>{}</th>", escaped(column.0))).collect();
    let mut html = format!(
        "<h2>Every setting</h2>\n<p>Cheapest first; on the Pareto front in bold. Medians; all times in milliseconds. {}</p>\n\
         <div class=\"wide\"><table>\n<thead><tr>{heads}</tr></thead>\n<tbody>\n",
        escaped(COMPARED)
    );
    for i in by_time(study) {
        let row = &study.rows[i];
        let class = match (study.recommended == Some(i), row.on_front) {
            (true, _) => " class=\"front chosen\"",
            (_, true) => " class=\"front\"",
            _ => "",
        };
        let cells: String = cells(study, row).map(|cell| format!("<td>{}</td>", escaped(&cell))).collect();
        line_to(&mut html, &format!("<tr{class}>{cells}</tr>"));
    }
    html + "</tbody></table></div>\n"
}

/// The reference, and the differences of the front's rows, or of the cheapest where there are many.
fn pictures(study: &Study, reference: &[u8]) -> String {
    let mut html = String::from(
        "<h2>Pictures</h2>\n<p>Differences from the reference: the largest of a pixel's four channels, on a \
         logarithmic scale.</p>\n<div class=\"scale\"></div>\n<div class=\"ends\"><span>1e-6 and less</span>\
         <span>1e-3</span><span>1</span></div>\n<p></p>\n",
    );
    figure(&mut html, reference, "reference");
    let shown =
        |i: &usize| study.rows[*i].on_front || study.recommended == Some(*i) || study.rows[*i].of_file;
    for row in by_time(study).into_iter().filter(shown).take(SHOWN).map(|i| &study.rows[i]) {
        figure(&mut html, &row.difference_png, &caption(row));
    }
    html
}

fn caption(row: &Row) -> String {
    format!(
        "{}: rms {:.1e}, max {:.1e}",
        row.setting.label(),
        row.errors.root_mean_square,
        row.errors.maximum
    )
}

pub(crate) fn figure(html: &mut String, png: &[u8], caption: &str) {
    let caption = escaped(caption);
    let data = base64_simd::STANDARD.encode_to_string(png);
    let image = format!("<img src=\"data:image/png;base64,{data}\" alt=\"{caption}\">");
    line_to(html, &format!("<figure>{image}<figcaption>{caption}</figcaption></figure>"));
}

const MEANINGS: &str = include_str!("meanings.html");

/// The files of every study in `folder`, and the difference pictures of former ones, which it may write anew.
pub fn files_to_overwrite(folder: &Path) -> Vec<PathBuf> {
    let former = std::fs::read_dir(folder.join(DIFFERENCES)).into_iter().flatten().flatten();
    FILES.iter().map(|name| folder.join(name)).chain(former.map(|entry| entry.path())).collect()
}

/// The folder of difference pictures, a file a setting.
const DIFFERENCES: &str = "differences";

/// Files beside the page.
const FILES: [&str; 5] = ["study.html", "study.csv", "study.json", "plot.svg", "reference.png"];

/// Measures the scene of a node and writes: the study and its files, none where nothing was measured or no folder is given.
/// `cache`: the folder that keeps reference pictures.
pub fn measure(
    (graph, node, title): (&Graph, Option<&str>, &str),
    wish: StudyOptions,
    folder: Option<&Path>,
    cache: &Path,
    (observer, progress): (&dyn Observer, &dyn Progress),
) -> Result<(Study, Vec<PathBuf>)> {
    let subject = Subject::gather(graph, node, wish.refine > 0, &mut voltet_nodes::session(), observer)?;
    // Before the reference, which takes longest.
    if wish.refine > 0 {
        refuse_too_fine(&subject, wish.refine)?;
    }
    let benches = Benches::open(&subject, &wish)?;
    let reference = reference(&subject, cache, progress)?;
    let study = study(subject, wish, benches, reference, progress)?;
    let written = match folder.filter(|_| !study.rows.is_empty()) {
        Some(folder) => write(&study, title, folder)?,
        None => Vec::new(),
    };
    Ok((study, written))
}

/// Writes everything into `folder`, which is made where it is not there, and gives the paths.
pub fn write(study: &Study, title: &str, folder: &Path) -> Result<Vec<PathBuf>> {
    let differences = folder.join(DIFFERENCES);
    std::fs::create_dir_all(&differences).map_err(|error| {
        let what = format!("the folder '{}' cannot be made", differences.display());
        Error::run(what).got(error).expected("--output with a folder that can be written to")
    })?;
    let plot_svg = plot::plot(study, title).svg();
    let reference_png = encode::png(&study.reference.picture, study.subject.background, None)?;
    let contents = [
        page(study, title, &plot_svg, &reference_png).into_bytes(),
        csv(study).into_bytes(),
        format!("{:#}\n", json(study, title)).into_bytes(),
        plot_svg.into_bytes(),
        reference_png,
    ];
    let mut outputs: Vec<(PathBuf, Vec<u8>)> =
        FILES.iter().map(|name| folder.join(name)).zip(contents).collect();
    for row in &study.rows {
        let name = format!("{}.png", row.setting.file_stem());
        outputs.push((differences.join(name), row.difference_png.clone()));
    }
    for (path, content) in &outputs {
        files::write_whole(path, content)?;
    }
    Ok(outputs.into_iter().map(|(path, _)| path).collect())
}

/// The text of the pipeline file with one of the study's settings in it; every other byte stays as it is. Overlap, order, engine,
/// adapter and compositor are written where they differ from what the file says or comes to here; a `gpu-renderer` that is to draw
/// on the native engine becomes a `renderer`.
pub fn apply(text: &str, study: &Study, setting: &RenderConfig) -> Result<String> {
    let subject = &study.subject;
    let mut document = Document::from_text(text.to_string(), None);
    let mut set = |node: &str, name, value| document.edit(&Edit::set(node, name, value));
    let word = |text: &str| ParameterValue::Text(text.to_string());
    let own = RenderConfig::of_file(subject, setting.variant);
    for (name, value) in setting.keys() {
        set(&subject.node, name, value)?;
    }
    if setting.overlap != own.overlap && setting.integrator == Integrator::ANALYTIC {
        set(&subject.node, "overlap", word(overlap_name(setting.overlap)))?;
    } else if own.overlap == WidgetBlend::Mix && setting.integrator != Integrator::ANALYTIC {
        // Of no account for the others, and misleading.
        set(&subject.node, "overlap", word(overlap_name(WidgetBlend::Exact)))?;
    }
    if setting.order != own.order
        && let Some(node) = &subject.order_node
    {
        set(node, "order", word(setting.order.name()))?;
    }
    for (name, value) in engine_keys(study, setting) {
        set(&subject.node, name, word(value))?;
    }
    Ok(document.text().to_string())
}

/// The keys that state the setting's engine, where the file comes to another one.
fn engine_keys<'a>(study: &'a Study, setting: &RenderConfig) -> Vec<(&'static str, &'a str)> {
    let asked = &study.subject.asked;
    let variant = setting.variant;
    let mut keys = Vec::new();
    match asked.form {
        RendererNode::Stages => return keys,
        RendererNode::GpuRenderer if variant.engine.name != asked.engine => {
            keys.extend([("type", "renderer"), ("engine", variant.engine.name)]);
        }
        RendererNode::GpuRenderer => {}
        RendererNode::Renderer => {
            let same = study.own.is_some_and(|own| own.variant.engine == variant.engine);
            keys.extend((!same).then_some(("engine", variant.engine.name)));
        }
    }
    let adapter = study.adapters.iter().find(|adapter| adapter.engine == variant.engine);
    let wish = adapter.and_then(|adapter| adapter.wish.as_deref());
    keys.extend(wish.filter(|wish| asked.adapter.as_deref() != Some(wish)).map(|wish| ("adapter", wish)));
    let only = asked.compositor == "auto" && variant.engine.compositing.len() == 1;
    let compositor = variant.compositor().filter(|name| *name != asked.compositor && !only);
    keys.extend(compositor.map(|name| ("compositor", name)));
    keys
}
