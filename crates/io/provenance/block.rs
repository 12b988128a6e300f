//! Provenance of pictures and figures.

use super::date;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use voltet_core::camera::{Camera, Projection};
use voltet_core::field::Plugin;
use voltet_files as files;
use voltet_graph::{FileRead, Origins, ResolvedPipeline, RunContext};

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
        Self::new(&call.origins(), stated.title.clone(), path_from_folder(stated, folder, given, path))
    }

    fn new(origins: &Origins, title: Option<String>, pipeline: String) -> Provenance {
        Provenance {
            program: concat!("voltet ", env!("CARGO_PKG_VERSION")).into(),
            title,
            pipeline,
            data: origins.files.iter().map(DataFile::new).collect(),
            plugins: origins.plugins.iter().map(|(node, plugin)| PluginRecord::new(node, plugin)).collect(),
            cameras: origins.cameras.iter().map(|(node, camera)| CameraRecord::new(node, camera)).collect(),
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

impl DataFile {
    fn new(file: &FileRead) -> DataFile {
        DataFile {
            node: file.node.clone(),
            parameter: file.named.parameter.clone(),
            path: file.named.path.clone(),
            bytes: file.stamp.map(|(bytes, _)| bytes),
            modified: file.stamp.map(|(_, time)| date::iso_date(time)),
            sidecars: (!file.beside.is_empty()).then(|| SidecarFiles::new(file)),
        }
    }
}

impl PluginRecord {
    fn new(node: &str, plugin: &Plugin) -> PluginRecord {
        PluginRecord {
            node: node.into(),
            name: plugin.name.clone(),
            version: plugin.version.clone(),
            path: plugin.path.display().to_string(),
            bytes: plugin.bytes,
            fingerprint: plugin.fingerprint_text(),
            modified: plugin.modified.map(date::iso_date),
        }
    }
}

impl SidecarFiles {
    fn new(file: &FileRead) -> SidecarFiles {
        let folder = files::folder(&file.path);
        let name = |path: &PathBuf| path.strip_prefix(folder).unwrap_or(path).to_string_lossy().into_owned();
        let there = file.beside.iter().filter_map(|(_, stamp)| *stamp);
        SidecarFiles {
            files: file.beside.len() as u64,
            bytes: there.clone().map(|(bytes, _)| bytes).sum(),
            modified: there.map(|(_, time)| time).max().map(date::iso_date),
            names: file.beside.iter().take(MAX_NAMED).map(|(path, _)| name(path)).collect(),
        }
    }
}

impl CameraRecord {
    fn new(node: &str, camera: &Camera) -> CameraRecord {
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
}
