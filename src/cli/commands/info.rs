//! `voltet info`: what a data file holds, and a pipeline to start with; findings of a pipeline about its data, without drawing; the
//! provenance of a picture.
//!
//! Of a pipeline writers are left out, and a node of type `bands` is added to each node with a volume and a transfer function as
//! inputs: its demand is all that is read and computed.

use super::blocks::tree;
use super::shared::{DONE, Outcome, open, reader_keys, with_bar};
use crate::cli::arguments::Info;
use crate::cli::present::{self, grouped, name, print};
use crate::core::grid::CellType;
use crate::core::{Error, Result, agreeing, counted, noun_of, with_commas};
use crate::graph::pipeline::Pipeline;
use crate::graph::{Graph, LinkEntry, NodeEntry, ParameterValue, PortType, Registry};
use crate::io::encode;
use crate::io::formats::{
    ArrayChoice, ArraySummary, Association, BlockSummary, Request, Summary, TableOfContents,
};
use crate::io::provenance::{CameraRecord, DataFile, PluginRecord, Provenance, SidecarFiles};
use crate::nodes::drawing::MemoryNeed;
use crate::nodes::files::argument;
use crate::{Document, Source};
use serde_json::{Value, json as object};
use std::fs::File;
use std::io::Read;
use std::path::Path;

pub fn info(arguments: &Info, registry: &Registry) -> Outcome {
    if is_picture(&arguments.data) {
        return picture_info(arguments);
    }
    if arguments.of_pipeline() {
        if arguments.json {
            let error = Error::usage("--json is for data files, and this is a pipeline");
            return Err(error.expected("voltet run --report FILE.json").in_file(&arguments.data).into());
        }
        return pipeline_info(arguments, registry);
    }
    if let Some(option) = arguments.set.options.first() {
        let error = Error::usage("--set changes a pipeline, and this is a data file").got(option);
        return Err(error.expected("a pipeline file (.toml), or no --set").in_file(&arguments.data).into());
    }
    let wanted = arguments.options.request(&arguments.data, registry)?;
    let contents = TableOfContents::open(&arguments.data, &wanted)?;
    let summary = with_bar(false, |_, progress| contents.inspect(wanted.association, progress))?;
    if arguments.json {
        print(&format!("{:#}\n", json(&summary)))?;
        return Ok(DONE);
    }
    let first = suggestion(arguments, &wanted, &contents, &summary, registry);
    print(&(describe_data(&arguments.data, &summary) + &first))?;
    Ok(DONE)
}

/// The summary for programs. Memory is in bytes, `null` where there is nothing to draw.
fn json(summary: &Summary) -> Value {
    let array = |array: &ArraySummary| {
        object!({
            "name": array.head.name,
            "association": if array.head.association == Association::Cell { "cell" } else { "point" },
            "components": array.head.component_count, "number_type": array.number_type, "tuples": array.tuple_count,
            "range": array.range, "not_finite": array.not_finite_count, "unit": array.unit,
        })
    };
    let cells = |(&code, &count): (&u8, &u64)| object!({ "vtk_type": code, "name": CellType::name_of(code, 1), "count": count });
    let block = |block: &BlockSummary| {
        let types = block.cells_by_type.iter().map(cells).collect::<Vec<_>>();
        object!({ "name": block.name, "cells": block.cell_count(), "cells_by_type": types })
    };
    let bounds = summary.bounds.map(|corners| corners.map(|corner| corner.to_array()));
    let memory = summary.has_volume().then(|| {
        let need = MemoryNeed::new(summary.size);
        let [reading, drawing, lit] = [need.reading(), need.drawing(), need.drawing_lit()];
        object!({ "reading": reading, "drawing": drawing, "drawing_with_gradient_and_light": lit })
    });
    object!({
        "format": summary.format, "pieces": summary.piece_count, "file_bytes": summary.file_bytes,
        "points": summary.point_count, "points_joined": summary.points_joined,
        "ghosts_without_owner": summary.ghosts_without_owner, "points_not_finite": summary.points_not_finite,
        "cells": summary.cell_count, "cells_by_type": summary.cells_by_type.iter().map(cells).collect::<Vec<_>>(),
        "blocks": summary.blocks.iter().map(block).collect::<Vec<_>>(),
        "bounds": bounds, "arrays": summary.arrays.iter().map(array).collect::<Vec<_>>(),
        "active_scalars": summary.active_scalars, "time": summary.time, "time_steps": summary.time_steps,
        "memory_bytes": memory, "warnings": summary.warnings, "notes": summary.notes,
        "damage": summary.damage, "not_drawn": summary.not_drawn,
    })
}

fn describe_data(path: &Path, summary: &Summary) -> String {
    let mut text = format!("{}\n  {}\n", name(&path.to_string_lossy()), name(&summary.format));
    let mebibytes = |bytes: u64| format!("{:.0} MiB", bytes as f64 / f64::from(1 << 20));
    text += &format!(
        "  {:.1} MiB in {}\n",
        summary.file_bytes as f64 / f64::from(1 << 20),
        counted(summary.piece_count, "piece"),
    );
    if summary.has_volume() {
        let need = MemoryNeed::new(summary.size);
        let [reading, drawing, lit] = [need.reading(), need.drawing(), need.drawing_lit()].map(mebibytes);
        text += &format!(
            "  a run takes about {} of memory to read it with one array, {} to draw all of it ({side} × {side} \
             pixels, on the CPU), {} with gradient and light\n",
            reading,
            drawing,
            lit,
            side = MemoryNeed::SIDE,
        );
    }
    text +=
        &format!("\n{}, {}\n", grouped(summary.point_count, "point"), grouped(summary.cell_count, "cell"));
    if summary.points_joined > 0 {
        let (joined, count) = (with_commas(summary.points_joined), summary.points_joined);
        let (points, are) = (noun_of(&count, "point"), agreeing(&count, "is", "are"));
        text += &format!("  {joined:>12}  {points} {are} another piece's, too, and {are} joined with it\n");
    }
    if summary.ghosts_without_owner > 0 {
        let (ghosts, count) = (with_commas(summary.ghosts_without_owner), summary.ghosts_without_owner);
        let (cells, have) = (noun_of(&count, "ghost cell"), agreeing(&count, "has", "have"));
        let are = agreeing(&count, "is", "are");
        text += &format!("  {ghosts:>12}  {cells} {have} no owner in any piece, and {are} not drawn\n");
    }
    for (&code, &count) in &summary.cells_by_type {
        text += &format!("  {:>12}  {}\n", with_commas(count), CellType::name_of(code, count));
    }
    text += &tree(&summary.blocks);
    text.extend(summary.notes.iter().map(|note| format!("{}\n", name(note))));
    if let Some([low, high]) = summary.bounds {
        text += "\nBounds (world units)\n";
        for (axis, low, high) in [("x", low.x, high.x), ("y", low.y, high.y), ("z", low.z, high.z)] {
            text += &format!("  {axis}  [{low}, {high}]\n");
        }
        text += &format!("  diagonal {}\n", (high - low).length());
    }
    text += if summary.arrays.is_empty() { "\nNo arrays\n" } else { "\nArrays\n" };
    let width = summary.arrays.iter().map(|a| name(&a.head.name).chars().count()).max().unwrap_or(0);
    for array in &summary.arrays {
        text += &array_line(array, width);
    }
    if let Some(time) = summary.time {
        text += &format!("\nTime {time}\n");
    }
    if !summary.time_steps.is_empty() {
        let (first, last) = (summary.time_steps.first(), summary.time_steps.last());
        let ends = first.zip(last).map(|(a, b)| format!(", times {a} to {b}")).unwrap_or_default();
        text += &format!("\n{}{ends}\n", counted(summary.time_steps.len(), "time step"));
    }
    if summary.points_not_finite > 0 {
        let count = summary.points_not_finite;
        text +=
            &format!("warning: {} {} not finite\n", grouped(count, "point"), agreeing(&count, "is", "are"));
    }
    text.extend(summary.warnings.iter().map(|warning| format!("warning: {}\n", name(warning))));
    text
}

fn array_line(array: &ArraySummary, width: usize) -> String {
    let association = if array.head.association == Association::Cell { "cell" } else { "point" };
    let components = match array.head.component_count {
        1 => String::new(),
        n => format!(" × {n}"),
    };
    let range = match (array.range, array.head.component_count) {
        (Some([low, high]), 1) => format!("[{low}, {high}]"),
        (Some([low, high]), _) => format!("length [{low}, {high}]"),
        (None, _) => "no finite value".into(),
    };
    let bad = match array.not_finite_count {
        0 => String::new(),
        n => format!(", {} not finite", with_commas(n)),
    };
    let unit = array.unit.as_ref().map_or(String::new(), |unit| format!(" {}", name(unit)));
    let name = name(&array.head.name);
    format!("  {association:5}  {name:width$}  {}{components}  {range}{unit}{bad}\n", array.number_type)
}

/// A pipeline to start with that `run` accepts, or the reason why there is none.
fn suggestion(
    arguments: &Info,
    wanted: &Request,
    contents: &TableOfContents,
    summary: &Summary,
    registry: &Registry,
) -> String {
    if !summary.has_volume() {
        return "\nNo cell has a volume: nothing to draw.\n".into();
    }
    if let Some(why) = summary.damage.as_ref().or(summary.not_drawn.as_ref()) {
        return format!("\nNo pipeline to start with: {}\n", name(why));
    }
    let (Some(bounds), true) = (summary.bounds, summary.quantities().any(ArraySummary::varies)) else {
        return "\nNo array whose values differ: nothing to draw.\n".into();
    };
    let mut refusal = None;
    for array in summary.by_rank() {
        let choice = summary.choice_of(array);
        let pipeline =
            pipeline(arguments, wanted.node_type(), &choice, array.range.unwrap_or_default(), bounds);
        match run_error(contents, wanted, choice, &pipeline, registry) {
            None => return format!("\nA pipeline to start with\n{pipeline}"),
            Some(error) => refusal = refusal.or(Some(error)),
        }
    }
    let why = refusal.map(|error| name(&error.to_string())).unwrap_or_default();
    format!("\nNo pipeline to start with: {why}\n")
}

/// Error of `run` for a pipeline that draws this array, as far as the headers of its data show.
fn run_error(
    contents: &TableOfContents,
    wanted: &Request,
    choice: ArrayChoice,
    pipeline: &str,
    registry: &Registry,
) -> Option<Error> {
    let request = Request { scalar: Some(choice.scalar), association: choice.association, ..wanted.clone() };
    let document = Document::from_text(Path::new("suggested.toml"), pipeline.into(), &[], registry);
    let planned = document.and_then(|document| crate::nodes::session().plan(&document.graph).map(drop));
    planned.and_then(|()| contents.unread(&request).map(drop)).err()
}

/// Bands of colour over an array's range, and a camera that sees all.
fn pipeline(
    arguments: &Info,
    reader: &str,
    choice: &ArrayChoice,
    [low, high]: [f64; 2],
    [from, to]: [glam::DVec3; 2],
) -> String {
    let keys = reader_keys(choice, &arguments.data, &arguments.options);
    let centre = 0.5 * from + 0.5 * to;
    let eye = centre + (to - from).length() * glam::DVec3::new(-0.8, -1.4, 0.9);
    let middle = 0.5 * low + 0.5 * high;
    let vector = |v: glam::DVec3| format!("[{:?}, {:?}, {:?}]", v.x, v.y, v.z);
    format!(
        "
[pipeline]
format = 1

[nodes.grid]
type = \"{reader}\"
{keys}
[nodes.look]
type = \"transfer-function\"
unit_distance = \"auto\"

[[nodes.look.widgets]]
kind = \"piecewise-linear\"
points = [[{low:?}, 0.1, 0.2, 0.9, 0.0], [{middle:?}, 0.2, 0.8, 0.3, 0.02], [{high:?}, 0.9, 0.1, 0.1, 0.2]]

[nodes.view]
type = \"camera\"
eye = {}
target = {}

[nodes.picture]
type = \"renderer\"
inputs = {{ volume = \"grid\", transfer_function = \"look\", camera = \"view\" }}

[nodes.file]
type = \"image-writer\"
path = \"picture.png\"
inputs = {{ image = \"picture\" }}
",
        vector(eye),
        vector(centre)
    )
}

fn pipeline_info(arguments: &Info, registry: &Registry) -> Outcome {
    if arguments.options.time_step.is_some() || arguments.options.solution.is_some() {
        let error = Error::usage("--time-step and --solution are for data files, and this is a pipeline");
        return Err(error.expected("the reader's parameters, or --set").in_file(&arguments.data).into());
    }
    let document = open(&arguments.data, &arguments.set.options, &[], registry)?;
    let graph = graph(&document, registry)?;
    let report = with_bar(false, |bar, _| crate::nodes::session().run(&graph, bar));
    let report = report.map_err(|error| document.failure(error))?;
    present::say(&present::warnings(&report.warnings, graph.warnings.len()));
    print(&present::findings(&report))?;
    Ok(DONE)
}

/// Graph of the nodes that make findings.
fn graph(document: &Document, registry: &Registry) -> Result<Graph> {
    let is_sink = |entry: &NodeEntry| document.graph.node(&entry.name).is_some_and(|n| n.node.is_sink());
    let mut entries: Vec<NodeEntry> =
        document.pipeline.nodes.iter().filter(|entry| !is_sink(entry)).cloned().collect();
    let mut looks: Vec<[&LinkEntry; 2]> = Vec::new();
    for entry in &document.pipeline.nodes {
        let Some(node) = document.graph.node(&entry.name) else { continue };
        let link = |port_type: PortType| {
            let port = node.node.inputs.iter().find(|port| port.port_type == port_type)?;
            entry.inputs.iter().find(|link| link.port == port.name)
        };
        let Some(pair) = link(PortType::Volume).zip(link(PortType::TransferFunction)) else { continue };
        let pair = [pair.0, pair.1];
        if !looks.iter().any(|known| (0..2).all(|k| known[k].source.datum == pair[k].source.datum)) {
            looks.push(pair);
        }
    }
    if looks.is_empty() {
        let error = Error::usage(
            "the pipeline draws no volume by a transfer function, so there is nothing to find out",
        );
        return Err(error.expected("a node that draws, such as type = \"renderer\"").in_file(&document.path));
    }
    for [volume, look] in looks {
        let link = |port: &str, from: &LinkEntry| LinkEntry { port: port.into(), ..from.clone() };
        entries.push(NodeEntry {
            name: free_name(&entries, look.source.text().unwrap_or("look")),
            origin: look.origin.clone(),
            node_type: ParameterValue::Text("bands".into()).into(),
            settings: Vec::new(),
            inputs: vec![link("volume", volume), link("transfer_function", look)],
        });
    }
    Graph::build(&entries, registry, document.graph.folder.clone()).map_err(|error| document.locate(error))
}

/// A name that no node has, for the findings about a transfer function.
fn free_name(entries: &[NodeEntry], look: &str) -> String {
    let mut name = format!("{look} on its data");
    while entries.iter().any(|entry| entry.name == name) {
        name.push('\'');
    }
    name
}

/// True if the file is a picture.
pub fn is_picture(path: &Path) -> bool {
    // A pipe can be read once.
    if !std::fs::metadata(path).is_ok_and(|there| there.is_file()) {
        return false;
    }
    let mut head = Vec::new();
    // Damage is reported where all of it is read.
    let read = File::open(path).and_then(|file| file.take(8).read_to_end(&mut head));
    read.is_ok() && encode::format_of(&head).is_some()
}

fn picture_info(arguments: &Info) -> Outcome {
    let path = &arguments.data;
    let options = [
        (arguments.options.time_step.is_some(), "--time-step"),
        (arguments.options.solution.is_some(), "--solution"),
        (!arguments.set.options.is_empty(), "--set"),
    ];
    if let Some((_, option)) = options.iter().find(|(given, _)| *given) {
        let error = Error::usage("the option is not for pictures").got(option);
        return Err(error.expected("voltet info PICTURE, or with --json").in_file(path).into());
    }
    let Source { embedded: carried, .. } = Source::read(path).map_err(|error| {
        error.expected(
            "a picture that an image-writer with provenance = true wrote; slices as data: in one volume (.vti)",
        )
    })?;
    // A picture without it is an error of `read`.
    let carried = carried.unwrap_or_default();
    print(&match arguments.json {
        true => {
            let json = serde_json::to_string_pretty(&carried)
                .map_err(|error| Error::run("what the picture carries is no JSON").got(error))?;
            json + "\n"
        }
        false => describe_picture(path, &carried),
    })?;
    Ok(DONE)
}

fn describe_picture(path: &Path, carried: &Provenance) -> String {
    let mut text = format!("{}: drawn by {}\n", path.display(), known(&carried.program));
    text.extend(carried.title.iter().map(|title| format!("title: {title}\n")));
    text.extend(carried.data.iter().map(of_data));
    text.extend(carried.plugins.iter().map(of_plugin));
    text.extend(carried.cameras.iter().map(of_camera));
    for unit in &carried.units.unit_distances {
        let length =
            unit.length.map_or("decided by data".into(), |length| ParameterValue::Number(length).to_string());
        text += &format!("unit distance ({}): {length}\n", unit.node);
    }
    let set: String = writers(carried).iter().map(|node| format!(" --set {node}.path=FILE")).collect();
    text += &format!(
        "\nDraw it again: voltet run {}{set}\nIts pipeline, for a file beside it:\n\n",
        name(&argument(path))
    );
    text + carried.pipeline.trim_end() + "\n"
}

/// The nodes of the pipeline that write pictures.
fn writers(carried: &Provenance) -> Vec<String> {
    // A pipeline that cannot be parsed is reported by `voltet run`.
    let nodes = Pipeline::parse(&carried.pipeline).unwrap_or_default().nodes;
    let writes = |node: &NodeEntry| node.node_type.text() == Some("image-writer");
    nodes.into_iter().filter(writes).map(|node| node.name).collect()
}

fn known(text: &str) -> &str {
    if text.is_empty() { "a program that does not say its version" } else { text }
}

fn of_data(file: &DataFile) -> String {
    let DataFile { node, path, bytes, modified, sidecars, other_steps, .. } = file;
    let bytes = bytes.map(|bytes| format!(", {}", grouped(bytes, "byte"))).unwrap_or_default();
    let date = modified.as_ref().map(|date| format!(", of {date}")).unwrap_or_default();
    let of_files = |all: &SidecarFiles, what: &str| {
        let SidecarFiles { files, bytes, modified, names, .. } = all;
        let date = modified.as_ref().map(|date| format!(", the last of {date}")).unwrap_or_default();
        let more = if names.len() as u64 == *files { "" } else { ", …" };
        format!(
            "  and {} {what}, {}{date}: {}{more}\n",
            grouped(*files, "file"),
            grouped(*bytes, "byte"),
            names.join(", ")
        )
    };
    let beside = sidecars.iter().map(|files| of_files(files, "beside it"));
    let steps = other_steps.iter().map(|files| of_files(files, "of the steps that numbers are relative to"));
    format!("data ({node}): {path}{bytes}{date}\n{}", beside.chain(steps).collect::<String>())
}

fn of_plugin(plugin: &PluginRecord) -> String {
    let PluginRecord { node, name, version, path, bytes, fingerprint, modified } = plugin;
    let date = modified.as_ref().map(|date| format!(", of {date}")).unwrap_or_default();
    format!("plug-in ({node}): {name} {version}, {path}, {}{date}, {fingerprint}\n", grouped(*bytes, "byte"))
}

fn of_camera(camera: &CameraRecord) -> String {
    let CameraRecord { node, eye, target, up, fov_y, height, near, size: [wide, high], samples } = camera;
    let view = fov_y.map(|degrees| format!("field of view {degrees}°"));
    let view = view.or(height.map(|height| format!("height {height}"))).unwrap_or_default();
    let near = if *near > 0.0 { format!(", near {near}") } else { String::new() };
    let samples = if *samples > 1 { format!(", {samples} rays a pixel") } else { String::new() };
    format!(
        "camera ({node}): eye {eye:?}, target {target:?}, up {up:?}, {view}{near}, {wide} × {high} pixels{samples}\n"
    )
}
