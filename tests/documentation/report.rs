//! Keys of the report of `voltet run`, with their meanings; a run's report must have no other.

use crate::{files, reference::is_in_sources, root, voltet};
use std::collections::BTreeSet;
use std::fmt::Write;
use std::path::Path;

/// Keys with type and meaning. "[]" stands for each element of a list, "*" for any name.
const KEYS: &[(&str, &str, &str)] = &[
    ("versions.voltet", "text", "version of the program"),
    (
        "versions.report",
        "number",
        "number of this shape; it grows where a key is renamed or moved, not where one is added",
    ),
    ("versions.pipeline_format", "number", "format of pipeline files"),
    ("peak_memory_bytes", "number", "largest memory of the process, bytes"),
    ("runs[].file", "text", "file that the pipeline came from, in the order of the command line"),
    ("runs[].title", "text or null", "title of the pipeline"),
    ("runs[].engine", "text or null", "engine that drew"),
    ("runs[].engine_reason", "text or null", "reason for that engine"),
    ("runs[].adapter", "text or null", "device, or vector units and threads"),
    ("runs[].compositor", "text or null", "compositor of a device"),
    ("runs[].compositor_reason", "text or null", "reason for that compositor"),
    ("runs[].seconds", "number", "duration of the run, seconds"),
    ("runs[].nodes[].name", "text", "name of a node, in the order in which the nodes ran"),
    ("runs[].nodes[].type", "text", "type of the node"),
    ("runs[].nodes[].seconds", "number", "duration; 0 where a former output was used"),
    ("runs[].nodes[].reused", "true or false", "true if a former output was used"),
    ("runs[].nodes[].stages.*", "number", "duration of a stage of the node, seconds"),
    ("runs[].nodes[].counts.*", "number", "counts of the node, as below"),
    ("runs[].nodes[].engine", "text", "engine of a node that draws"),
    (
        "runs[].counts.*",
        "number or null",
        "counts of all nodes together; null where the engine does not count",
    ),
    ("runs[].left_out[].node", "text", "node that did less than it could have done"),
    ("runs[].left_out[].what", "text", "work that was left out"),
    ("runs[].left_out[].why", "text", "reason why the scene does not need it"),
    (
        "runs[].left_out[].saving",
        "null or an object",
        "saving as `bytes`, `cells`, `points`, `segments` or `seconds`",
    ),
    ("runs[].findings[].node", "text", "node that found something out about the data"),
    ("runs[].findings[].what", "text", "finding in words"),
    ("runs[].findings[].figures", "any", "finding in figures"),
    ("runs[].warnings[]", "text", "warnings"),
    ("runs[].files[]", "text", "files written"),
    (
        "runs[].exhaustive",
        "object",
        "of `voltet run --exhaustive`: times and pictures with all work done, beside the usual ones",
    ),
    (
        "runs[].steps[].frame",
        "number",
        "of a run of several pictures, which has no other keys but `file` and `title`: number of the picture",
    ),
    ("runs[].steps[].step", "number", "number of its time step"),
    ("runs[].steps[].time", "number or null", "its time"),
    ("runs[].steps[].stem", "text or null", "name of its data file without ending"),
    ("runs[].steps[].values", "text", "values of its swept parameters"),
    ("runs[].steps[].outcome", "text", "`drawn`; `kept` by `--resume`; `failed`"),
    ("runs[].steps[].run", "object or null", "run of a picture that was drawn, with the keys of `runs[]`"),
    ("runs[].steps[].error", "text or null", "why it failed"),
    ("runs[].provenance.program", "text", "program and version"),
    ("runs[].provenance.title", "text or null", "title of the pipeline"),
    ("runs[].provenance.pipeline", "text or null", "pipeline as it was run, every `--set` carried out"),
    ("runs[].provenance.data[].node", "text", "node that read a file"),
    ("runs[].provenance.data[].parameter", "text", "parameter that names the file"),
    ("runs[].provenance.data[].path", "text", "path as it was given"),
    ("runs[].provenance.data[].bytes", "number", "size of the file"),
    ("runs[].provenance.data[].modified", "text", "time of its last change, UTC"),
    (
        "runs[].provenance.data[].beside",
        "object",
        "files read because this one names them: `files`, `bytes`, `modified`, `fingerprint` (made of all names, sizes and times), and `names` of the first 16",
    ),
    (
        "runs[].provenance.data[].other_steps",
        "object",
        "files of the steps that numbers are relative to, in the same form",
    ),
    (
        "runs[].provenance.plugins[]",
        "object",
        "shared libraries in use: `node`, `name`, `version`, `path`, `bytes`, `fingerprint` (made of all bytes), `modified`",
    ),
    ("runs[].provenance.cameras[].node", "text", "node of a camera"),
    ("runs[].provenance.cameras[].eye[]", "number", "position, in the grid's unit"),
    ("runs[].provenance.cameras[].target[]", "number", "point in the middle of the picture"),
    ("runs[].provenance.cameras[].up[]", "number", "direction that points up in the picture"),
    (
        "runs[].provenance.cameras[].fov_y",
        "number",
        "vertical field of view, degrees, of a perspective camera",
    ),
    (
        "runs[].provenance.cameras[].height",
        "number",
        "height of the picture in the grid's unit, of an orthographic camera",
    ),
    ("runs[].provenance.cameras[].near", "number", "distance of the near plane"),
    ("runs[].provenance.cameras[].size[]", "number", "width and height, pixels"),
    ("runs[].provenance.cameras[].samples", "number", "rays for each pixel"),
    ("runs[].provenance.units.length", "text", "unit of lengths"),
    ("runs[].provenance.units.gradient_magnitude", "text", "unit of g"),
    ("runs[].provenance.units.extinction", "text", "unit of extinctions"),
    ("runs[].provenance.units.unit_distances[].node", "text", "transfer function"),
    (
        "runs[].provenance.units.unit_distances[].length",
        "number",
        "its `unit_distance`, also where the data decided it",
    ),
    ("runs[].provenance.units.angle", "text", "unit of angles"),
    ("runs[].provenance.units.color", "text", "colour space"),
];

/// Counts with their meanings.
const COUNTS: &[(&str, &str)] = &[
    ("arrays_decoded", "arrays that were read from the file"),
    ("arrays_written", "arrays of `grid-writer`"),
    (
        "bytes_sent",
        "bytes that processes sent each other for the picture, and for the choice of how to draw it",
    ),
    (
        "bytes_sent_least",
        "bytes of these that any method sends: colour and opacity of each pixel that a process beside the first touches",
    ),
    ("bytes_uploaded", "bytes sent to the device"),
    ("cells_cast", "cells that rays go through from face to face"),
    ("cells_culled", "cells that no widget touches, or that lie out of view"),
    ("cells_projected", "cells projected to the screen"),
    ("cells_selected", "tetrahedra that `threshold` kept, whole or in parts"),
    ("cells_sorted", "cells put in order on the device"),
    ("cells_total", "tetrahedra of the grid"),
    ("cells_written", "cells of `grid-writer`"),
    ("evaluations", "places at which the transfer function was evaluated"),
    ("gradient_fallbacks", "points where a gradient filter did less than it promises"),
    ("gradients_computed", "gradient fields computed"),
    ("lines", "lines that tubes were made of"),
    ("percentiles_computed", "percentiles of numbers relative to data"),
    (
        "pieces_read",
        "times that a piece of a file was read, by all processes together: for borders, ranges, and each round of drawing",
    ),
    ("pixels_disordered", "pixels composited in an order that is not exact"),
    ("points_written", "points of `grid-writer`"),
    ("ray_stretches", "gapless stretches of rays that the parts of a grid left"),
    ("segments", "ray segments integrated"),
    ("segments_exact", "segments that 32-bit lanes left to the 64-bit forms"),
    ("segments_overlapping", "segments on which widgets overlap"),
    ("shader_builds", "shaders compiled"),
    ("steps_read", "time steps read for numbers relative to a series"),
    (
        "sweeps_further",
        "further passes over a tile's list on a device, where a pixel holds more segments than fit",
    ),
    ("tables_built", "tables of integrators filled"),
    ("tile_entries", "entries of the tiles' lists on a device"),
    ("tiles_deep", "tiles with more than 1,024 segments on a pixel"),
    ("tiles_lost", "tiles that projected cells drew, as a ray from cell to cell left by an unexpected face"),
    ("tiles_sorted", "tiles whose segments were put in order"),
    ("tiles_stopped", "tiles that were opaque before all their cells were visited"),
    ("triangles", "triangles of the nodes that make surfaces"),
    ("uploads", "transfers of a grid to the device"),
    ("values_computed", "values of expressions computed"),
];

/// Page of the report, after a run's report was found to have no other keys.
pub fn page(made: &str, work: &Path) -> String {
    let found = reported(work);
    let is_known = |path: &str| {
        let counts = path.strip_prefix("runs[].counts.").or(path.strip_prefix("runs[].nodes[].counts."));
        match counts {
            Some(name) => COUNTS.iter().any(|(count, _)| *count == name),
            None => KEYS.iter().any(|(key, ..)| match key.strip_suffix('*') {
                Some(start) => path.starts_with(start),
                None => {
                    path == *key || [".", "["].iter().any(|next| path.starts_with(&format!("{key}{next}")))
                }
            }),
        }
    };
    let unknown: Vec<&String> = found.iter().filter(|path| !is_known(path)).collect();
    assert!(unknown.is_empty(), "tests/documentation/report.rs lacks {unknown:?}");
    let names =
        KEYS.iter().map(|(key, ..)| key.trim_end_matches(['*', '.', '[', ']']).rsplit('.').next().unwrap());
    for name in noted() {
        assert!(
            COUNTS.iter().any(|(count, _)| *count == name),
            "tests/documentation/report.rs lacks '{name}'"
        );
    }
    for name in names.chain(COUNTS.iter().map(|(name, _)| *name)).map(|name| name.trim_end_matches("[]")) {
        assert!(is_in_sources(name), "no source names the key '{name}' of the report");
    }

    let mut page = format!(
        "# The report of a run\n\n{made}\n\n`voltet run FILE --report REPORT.json` writes one JSON object, of the same shape \
         for one file or several. `[]` stands for each element of a list, `*` for any name.\n\n\
         | key | value | meaning |\n| --- | --- | --- |\n"
    );
    for (key, kind, meaning) in KEYS {
        writeln!(page, "| `{key}` | {kind} | {meaning} |").unwrap();
    }
    page += "\n## Counts\n\nA count that no node took is missing, or null where every report names it.\n\n\
             | count | meaning |\n| --- | --- |\n";
    for (name, meaning) in COUNTS {
        writeln!(page, "| `{name}` | {meaning} |").unwrap();
    }
    page
}

/// Counts that the sources insert under a literal name, tests left out.
fn noted() -> BTreeSet<String> {
    let sources = ["nodes", "crates"].map(|folder| files(&root().join(folder), &[".rs"])).concat();
    let is_test = |path: &Path| path.to_string_lossy().contains("test");
    let texts = sources.iter().filter(|path| !is_test(path.strip_prefix(root()).unwrap()));
    let mut names = BTreeSet::new();
    for text in texts.map(|path| std::fs::read_to_string(path).unwrap()) {
        let inserted = text.split("counts.insert(\"").skip(1).filter_map(|rest| rest.split_once('"'));
        names.extend(inserted.map(|(name, _)| name.to_string()));
    }
    names
}

/// Paths of the keys in the reports of small runs: a picture, numbers relative to data, and a histogram.
fn reported(work: &Path) -> BTreeSet<String> {
    let mut paths = BTreeSet::new();
    let files = [
        ("quickstart", "view.size=[16,12]"),
        ("relative", "view.size=[16,12]"),
        ("histogram", "plane.bins=[8,6]"),
    ];
    for (name, small) in files {
        let file = root().join(format!("pipelines/{name}.toml"));
        let picture = format!("file.path={}", work.join("picture.png").display());
        let table = format!("table.path={}", work.join("table.csv").display());
        let mut arguments =
            vec!["run", file.to_str().unwrap(), "--set", small, "--set", &picture, "--report", "report.json"];
        if name == "histogram" {
            arguments.extend(["--set", &table]);
        }
        let output = voltet(&arguments, work);
        assert!(output.status.success(), "{name}: {}", String::from_utf8_lossy(&output.stderr));
        let text = std::fs::read_to_string(work.join("report.json")).unwrap();
        collect(&serde_json::from_str(&text).unwrap(), "", &mut paths);
    }
    paths
}

/// Adds the path of each value that is no object and no list.
fn collect(value: &serde_json::Value, path: &str, paths: &mut BTreeSet<String>) {
    match value {
        serde_json::Value::Object(members) => {
            for (name, member) in members {
                let dot = if path.is_empty() { "" } else { "." };
                collect(member, &format!("{path}{dot}{name}"), paths);
            }
        }
        serde_json::Value::Array(elements) => {
            elements.iter().for_each(|element| collect(element, &format!("{path}[]"), paths));
        }
        _ => {
            paths.insert(path.to_string());
        }
    }
}
