//! `voltet info` of a picture: its provenance.

use super::exit_status::DONE;
use crate::Source;
use crate::cli::arguments::Info;
use crate::cli::present::{number, print};
use crate::core::{Error, Result};
use crate::graph::pipeline::Pipeline;
use crate::graph::{NodeEntry, ParameterValue};
use crate::io::encode;
use crate::io::provenance::{CameraRecord, DataFile, PluginRecord, Provenance, SidecarFiles};
use std::fs::File;
use std::io::Read;
use std::path::Path;

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

pub fn picture_info(arguments: &Info) -> Result<u8> {
    let path = &arguments.data;
    let options = [
        (arguments.time_step.is_some(), "--time-step"),
        (arguments.solution.is_some(), "--solution"),
        (!arguments.set.options.is_empty(), "--set"),
    ];
    if let Some((_, option)) = options.iter().find(|(given, _)| *given) {
        let error = Error::usage("the option is not for pictures").got(option);
        return Err(error.expected("voltet info PICTURE, or with --json").in_file(path));
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
        false => described(path, &carried),
    })?;
    Ok(DONE)
}

fn described(path: &Path, carried: &Provenance) -> String {
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
        path.display()
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
    let DataFile { node, path, bytes, modified, sidecars: beside, .. } = file;
    let bytes = bytes.map(|bytes| format!(", {} bytes", number(bytes))).unwrap_or_default();
    let date = modified.as_ref().map(|date| format!(", of {date}")).unwrap_or_default();
    let beside = beside.iter().map(|beside| {
        let SidecarFiles { files, bytes, modified, names } = beside;
        let date = modified.as_ref().map(|date| format!(", the last of {date}")).unwrap_or_default();
        let more = if names.len() as u64 == *files { "" } else { ", …" };
        format!(
            "  and {} beside it, {} bytes{date}: {}{more}\n",
            number(*files),
            number(*bytes),
            names.join(", ")
        )
    });
    format!("data ({node}): {path}{bytes}{date}\n{}", beside.collect::<String>())
}

fn of_plugin(plugin: &PluginRecord) -> String {
    let PluginRecord { node, name, version, path, bytes, fingerprint, modified } = plugin;
    let date = modified.as_ref().map(|date| format!(", of {date}")).unwrap_or_default();
    format!("plug-in ({node}): {name} {version}, {path}, {} bytes{date}, {fingerprint}\n", number(*bytes))
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
