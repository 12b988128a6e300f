//! Provenance: program, pipeline and data files, written into pictures and reports, and read again (docs/src/reference/provenance.md).

use serde::{Deserialize, Serialize};
use serde_json::{Value, json as object};
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};
use voltet_core::camera::{Camera, Projection};
use voltet_core::field::{Plugin, fingerprint};
use voltet_files as files;
use voltet_graph::pipeline::FORMAT;
use voltet_graph::{FileRead, Origins, ResolvedPipeline, RunContext, RunReport, Stamp};

/// The name of the text that holds the pipeline.
pub const PIPELINE: &str = "voltet:pipeline";

/// The name of the text that holds the rest, as JSON.
pub const PROVENANCE: &str = "voltet:provenance";

/// No text longer than this is written into a picture, or read from one: bytes.
pub const MAX_TEXT: usize = 1 << 20;

/// Provenance of a picture or of figures: program, pipeline, data files, camera.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Provenance {
    /// The program with its version.
    pub program: String,
    /// The pipeline's title.
    pub title: Option<String>,
    /// The pipeline as it was run. A picture holds it as a text of its own.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub pipeline: String,
    /// The files that were read.
    pub data: Vec<DataFile>,
    /// The plug-ins that gradient filters came from.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub plugins: Vec<PluginRecord>,
    /// The cameras.
    pub cameras: Vec<CameraRecord>,
    /// Units of what stands here and in the pipeline.
    pub units: Units,
}

/// A file that was read.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct DataFile {
    /// The node that read it.
    pub node: String,
    /// The parameter that names it.
    pub parameter: String,
    /// Its path, as it was given.
    pub path: String,
    /// Its size.
    pub bytes: Option<u64>,
    /// Modification time: UTC, RFC 3339.
    pub modified: Option<String>,
    /// Files read beside it: pieces, the files of a series' step.
    #[serde(rename = "beside", skip_serializing_if = "Option::is_none")]
    pub sidecars: Option<SidecarFiles>,
    /// Files of other steps of its series that values depend on.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub other_steps: Option<SidecarFiles>,
}

/// A plug-in whose gradient filter was used.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct PluginRecord {
    /// The node that named the filter.
    pub node: String,
    /// The plug-in's own name.
    pub name: String,
    /// Its version.
    pub version: String,
    /// Its file, as it was given.
    pub path: String,
    /// The file's size.
    pub bytes: u64,
    /// A number made of all its bytes, hexadecimal: what was damaged or compiled again has another.
    pub fingerprint: String,
    /// Modification time: UTC, RFC 3339.
    pub modified: Option<String>,
}

/// Files that were read beside one that names them.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct SidecarFiles {
    /// Number of files.
    pub files: u64,
    /// Their size together.
    pub bytes: u64,
    /// Modification time of the last of them: UTC, RFC 3339.
    pub modified: Option<String>,
    /// A number made of all their names, sizes and times, hexadecimal.
    pub fingerprint: String,
    /// The first of them, at most [`MAX_NAMED`], relative to the folder of the file that names them.
    pub names: Vec<String>,
}

/// Most files that are named of those read beside another.
pub const MAX_NAMED: usize = 16;

/// A camera, with the parameters of the node `camera`; computed ones as they came out.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct CameraRecord {
    /// The node that gave it.
    pub node: String,
    /// World units.
    pub eye: [f64; 3],
    /// World units.
    pub target: [f64; 3],
    /// Any length.
    pub up: [f64; 3],
    /// Vertical field of view of a perspective camera, degrees.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fov_y: Option<f64>,
    /// Height of the picture of an orthographic camera, world units.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub height: Option<f64>,
    /// World units.
    pub near: f64,
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// Rays a pixel.
    pub samples: u32,
}

/// Units.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Units {
    /// Unit of positions and distances.
    pub length: String,
    /// Unit of g.
    pub gradient_magnitude: String,
    /// Unit of extinctions.
    pub extinction: String,
    /// The unit distance of each transfer function.
    pub unit_distances: Vec<UnitDistance>,
    /// Unit of angles.
    pub angle: String,
    /// Colour space of the pipeline's colours.
    pub color: String,
}

/// The unit distance of a transfer function.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct UnitDistance {
    /// The node that gave the transfer function.
    pub node: String,
    /// World units; `None` where the data decides it and there was none.
    pub length: Option<f64>,
}

impl Provenance {
    /// Provenance of a whole run. The pipeline is as stated, its paths relative to its own folder.
    pub fn of_run(origins: &Origins, stated: &ResolvedPipeline) -> Provenance {
        Self::new(origins, stated.title.clone(), stated.text.clone())
    }

    /// Provenance of a picture that a node writes to `path`. `given`: the path as the pipeline has it.
    pub fn of_picture(call: &RunContext, given: &str, path: &Path) -> Provenance {
        let (stated, folder) = call.stated();
        Self::for_picture(&call.origins(), (stated, folder), given, path)
    }

    /// Provenance of a picture that is written to `path`, from origins. `stated`: the pipeline and its folder.
    pub fn for_picture(
        origins: &Origins,
        (stated, folder): (&ResolvedPipeline, &Path),
        given: &str,
        path: &Path,
    ) -> Provenance {
        Self::new(origins, stated.title.clone(), path_from_folder(stated, folder, given, path))
    }

    /// True if a picture with this provenance was drawn by the same program from the same pipeline, files and plug-ins.
    pub fn is_of_same_origin(&self, other: &Provenance) -> bool {
        let origin =
            |of: &Provenance| (of.program.clone(), of.pipeline.clone(), of.data.clone(), of.plugins.clone());
        origin(self) == origin(other)
    }

    fn new(origins: &Origins, title: Option<String>, pipeline: String) -> Provenance {
        Provenance {
            program: concat!("voltet ", env!("CARGO_PKG_VERSION")).into(),
            title,
            pipeline,
            data: origins.files.iter().map(data_file).collect(),
            plugins: origins.plugins.iter().map(|(node, plugin)| plugin_record(node, plugin)).collect(),
            cameras: origins.cameras.iter().map(|(node, camera)| camera_record(node, camera)).collect(),
            units: Units {
                length: "that of the data".into(),
                gradient_magnitude: "unit of the scalar per length".into(),
                extinction: "per unit distance".into(),
                unit_distances: (origins.unit_distances.iter())
                    .map(|(node, length)| UnitDistance { node: node.clone(), length: *length })
                    .collect(),
                angle: "degrees".into(),
                color: "linear RGB, primaries and white of Rec. 709".into(),
            },
        }
    }

    /// The texts of a picture by name; `None` where they are too long for it.
    pub fn texts(&self) -> Option<[(&'static str, String); 2]> {
        let rest = Provenance { pipeline: String::new(), ..self.clone() };
        // Names and finite numbers, of which JSON holds all.
        let rest = serde_json::to_string(&rest).unwrap_or_default();
        let short = self.pipeline.len().max(rest.len()) <= MAX_TEXT;
        short.then(|| [(PIPELINE, self.pipeline.clone()), (PROVENANCE, rest)])
    }

    /// The state of the file that a parameter named.
    pub fn data_file(&self, node: &str, parameter: &str, path: &str) -> Option<&DataFile> {
        let mut named = self.data.iter().filter(|file| file.node == node && file.parameter == parameter);
        let first = named.clone().next();
        named.find(|file| file.path == path).or(first)
    }
}

/// The pipeline's text for a picture at `path`, so that it can be run beside it: its paths are made relative to the
/// picture's folder. Where that would tell names of folders that nobody gave (the path of the picture was absolute, and
/// leads out of the pipeline's folder), they stay relative to the pipeline's.
fn path_from_folder(stated: &ResolvedPipeline, folder: &Path, given: &str, path: &Path) -> String {
    let there = |folder: &Path| {
        std::fs::canonicalize(if folder.as_os_str().is_empty() { Path::new(".") } else { folder })
    };
    match (there(folder), there(files::folder(path))) {
        (Ok(own), Ok(pictures))
            if own != pictures
                && !files::is_stream(given)
                && (Path::new(given).is_relative() || pictures.starts_with(&own)) =>
        {
            stated.moved(&own, &pictures)
        }
        _ => stated.text.clone(),
    }
}

fn data_file(file: &FileRead) -> DataFile {
    DataFile {
        node: file.node.clone(),
        parameter: file.named.parameter.clone(),
        path: file.named.path.clone(),
        bytes: file.stamp.map(|(bytes, _)| bytes),
        modified: file.stamp.map(|(_, time)| iso_date(time)),
        sidecars: sidecar_files(&file.path, &file.beside),
        other_steps: sidecar_files(&file.path, &file.other_steps),
    }
}

fn plugin_record(node: &str, plugin: &Plugin) -> PluginRecord {
    PluginRecord {
        node: node.into(),
        name: plugin.name.clone(),
        version: plugin.version.clone(),
        path: plugin.path.display().to_string(),
        bytes: plugin.bytes,
        fingerprint: plugin.fingerprint_text(),
        modified: plugin.modified.map(iso_date),
    }
}

/// Files that belong to the file at `path`; `None` where there are none.
fn sidecar_files(path: &Path, all: &[(PathBuf, Stamp)]) -> Option<SidecarFiles> {
    let folder = files::folder(path);
    let name = |path: &PathBuf| path.strip_prefix(folder).unwrap_or(path).to_string_lossy().into_owned();
    let there = all.iter().filter_map(|(_, stamp)| *stamp);
    let state = |(path, stamp): &(PathBuf, Stamp)| {
        let state = stamp.map(|(bytes, time)| format!("{bytes} {}", iso_date(time)));
        format!("{}\0{}\0", name(path), state.unwrap_or_default())
    };
    let states: String = all.iter().map(state).collect();
    (!all.is_empty()).then(|| SidecarFiles {
        files: all.len() as u64,
        bytes: there.clone().map(|(bytes, _)| bytes).sum(),
        modified: there.map(|(_, time)| time).max().map(iso_date),
        fingerprint: format!("{:016x}", fingerprint(states.as_bytes())),
        names: all.iter().take(MAX_NAMED).map(|(path, _)| name(path)).collect(),
    })
}

fn camera_record(node: &str, camera: &Camera) -> CameraRecord {
    let (fov_y, height) = match camera.projection {
        Projection::Perspective { fov_y } => (Some(fov_y), None),
        Projection::Orthographic { height } => (None, Some(height)),
    };
    CameraRecord {
        node: node.into(),
        eye: camera.eye.into(),
        target: camera.target.into(),
        up: camera.up.into(),
        fov_y,
        height,
        near: camera.near,
        size: camera.size,
        samples: camera.samples,
    }
}

/// The shape of the report. It changes where something is renamed or moved, not where something is added.
const REPORT_FORMAT: u32 = 1;

/// Counts that every report names, also where the engine that ran does not know them.
const COUNTS: [&str; 11] = [
    "arrays_decoded",
    "gradients_computed",
    "cells_total",
    "cells_culled",
    "cells_projected",
    "segments",
    "pixels_disordered",
    "tiles_sorted",
    "tables_built",
    "shader_builds",
    "uploads",
];

/// The report of a call (docs/src/reference/report.md): what is said of each of its runs. `peak_memory`: the largest memory of the
/// process until the last of them ended, bytes.
pub fn whole_report(runs: Vec<Value>, peak_memory: Option<u64>) -> Value {
    object!({
        "versions": { "voltet": env!("CARGO_PKG_VERSION"), "report": REPORT_FORMAT, "pipeline_format": FORMAT },
        "peak_memory_bytes": peak_memory,
        "runs": runs,
    })
}

/// Report of one run. `file`: source of the pipeline.
pub fn run_report(file: &str, report: &RunReport, stated: &ResolvedPipeline) -> Value {
    let mut counts = serde_json::Map::new();
    for name in COUNTS {
        counts.insert(name.into(), Value::Null);
    }
    counts.extend(report.counts.iter().map(|(&name, &count)| (name.to_string(), count.into())));
    object!({
        "file": file,
        "title": stated.title,
        "engine": report.engine.as_ref().map(|e| &e.0),
        "engine_reason": report.engine.as_ref().map(|e| &e.1),
        "adapter": report.adapter,
        "compositor": report.compositor.as_ref().map(|c| &c.0),
        "compositor_reason": report.compositor.as_ref().map(|c| &c.1),
        "seconds": report.seconds,
        "nodes": report.nodes,
        "counts": counts,
        "left_out": report.skipped,
        "findings": report.findings,
        "warnings": report.warnings,
        "files": report.files,
        "provenance": Provenance::of_run(&report.origins, stated),
    })
}

/// A time in UTC, as RFC 3339 writes it: 2026-11-22T14:51:03Z, with its nanoseconds where there are some.
pub fn iso_date(time: SystemTime) -> String {
    let nanoseconds = match time.duration_since(UNIX_EPOCH) {
        Ok(after) => i128::try_from(after.as_nanos()).unwrap_or(i128::MAX),
        Err(before) => i128::try_from(before.duration().as_nanos()).map_or(i128::MIN, |before| -before),
    };
    let (seconds, fraction) = (nanoseconds.div_euclid(1_000_000_000), nanoseconds.rem_euclid(1_000_000_000));
    let seconds = i64::try_from(seconds).unwrap_or(i64::MAX);
    let (days, second) = (seconds.div_euclid(86_400), seconds.rem_euclid(86_400));
    let (year, month, day) = civil(days);
    let (hour, minute, second) = (second / 3600, second / 60 % 60, second % 60);
    let fraction = if fraction > 0 { format!(".{fraction:09}") } else { String::new() };
    format!("{year:04}-{month:02}-{day:02}T{hour:02}:{minute:02}:{second:02}{fraction}Z")
}

/// Year, month and day of a number of days since 1970-01-01 (Howard Hinnant, "chrono-Compatible Low-Level Date Algorithms",
/// 2013, `civil_from_days`): years begin in March, eras are 400 years.
fn civil(days: i64) -> (i64, i64, i64) {
    let shifted = days.saturating_add(719_468);
    let (era, of_era) = (shifted.div_euclid(146_097), shifted.rem_euclid(146_097));
    let year = (of_era - of_era / 1460 + of_era / 36_524 - of_era / 146_096) / 365;
    let of_year = of_era - (365 * year + year / 4 - year / 100);
    let month = (5 * of_year + 2) / 153;
    let day = of_year - (153 * month + 2) / 5 + 1;
    let month = if month < 10 { month + 3 } else { month - 9 };
    (year + 400 * era + i64::from(month <= 2), month, day)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn dates_are_those_of_the_calendar() {
        // By `date -u -d @N`.
        for (seconds, text) in [
            (0, "1970-01-01T00:00:00Z"),
            (951_782_399, "2000-02-28T23:59:59Z"),
            (951_782_400, "2000-02-29T00:00:00Z"),
            (1_795_359_063, "2026-11-22T14:51:03Z"),
            (4_107_542_400, "2100-03-01T00:00:00Z"),
        ] {
            assert_eq!(iso_date(UNIX_EPOCH + Duration::from_secs(seconds)), text);
        }
        assert_eq!(iso_date(UNIX_EPOCH - Duration::from_millis(500)), "1969-12-31T23:59:59.500000000Z");
        assert_eq!(
            iso_date(UNIX_EPOCH + Duration::from_nanos(86_400_000_000_001)),
            "1970-01-02T00:00:00.000000001Z"
        );
    }
}
