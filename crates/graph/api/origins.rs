//! Origins of values: cameras, units and files, for the record that is written with them.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use voltet_core::camera::Camera;
use voltet_core::field::Plugin;
use voltet_core::parameters::NamedPath;

/// State of a file: its length and the time it was last written, or nothing where it is not there.
pub type Stamp = Option<(u64, std::time::SystemTime)>;

/// Finds the state of a file.
pub type FileStamp = fn(&Path) -> Stamp;

/// Origins of the values that some nodes gave.
#[derive(Debug, Clone, Default)]
pub struct Origins {
    /// The cameras, each with the node that gives it.
    pub cameras: Vec<(String, Arc<Camera>)>,
    /// The unit distances of transfer functions (world units), each with the node that gives it. `None`: one that the data
    /// decides, of no data.
    pub unit_distances: Vec<(String, Option<f64>)>,
    /// The files that parameters name to be read.
    pub files: Vec<FileRead>,
    /// The plug-ins that gradient filters came from, each with the node that names the filter.
    pub plugins: Vec<(String, Plugin)>,
}

/// A file that was read.
#[derive(Debug, Clone)]
pub struct FileRead {
    /// The node that read it.
    pub node: String,
    /// The path as it was given, and by which parameter.
    pub named: NamedPath,
    /// The path from where the program runs.
    pub path: PathBuf,
    /// Its state.
    pub stamp: Stamp,
    /// The files that were read beside it: pieces, the file of a step.
    pub beside: Vec<(PathBuf, Stamp)>,
}
