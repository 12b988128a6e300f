//! What values were made from: cameras, units and files, for what is written to say.

use super::builder::Graph;
use super::cache::{FileStamp, Stamp, files_beside};
use super::declaration::{PortType, Steps};
use super::demand::Done;
use super::value::{Value, diagonal};
use std::path::PathBuf;
use std::sync::Arc;
use voltet_core::camera::Camera;
use voltet_core::field::Plugin;
use voltet_core::parameters::NamedPath;

/// What the work of some nodes went by.
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

/// Of these nodes, which ran.
pub(super) fn origins(graph: &Graph, places: &[usize], done: &[Option<Done>], stamp: FileStamp) -> Origins {
    let mut origins = Origins::default();
    for &place in places {
        let node = &graph.nodes[place];
        let outputs = done[place].iter().flat_map(|done| &done.outputs);
        for (value, _) in outputs {
            if let Value::Camera(camera) = value {
                origins.cameras.push((node.name.clone(), camera.clone()));
            }
            if let Value::TransferFunction(look) = value {
                let by_data =
                    || Some(look.for_diagonal(drawn_with(graph, places, place, done)?).unit_distance);
                let stated = look.transfer_function.unit_distance;
                let unit = if look.auto_unit_distance { by_data() } else { Some(stated) };
                origins.unit_distances.push((node.name.clone(), unit));
            }
        }
        origins.plugins.extend(node.plugin().map(|plugin| (node.name.clone(), plugin.clone())));
        let read = node.parameters.paths().into_iter().filter(|named| !named.written);
        // The first names the others.
        let mut beside = files_beside((node.node, &node.parameters), Steps::Read, &graph.folder, stamp);
        origins.files.extend(read.map(|named| {
            let path = named.from(&graph.folder);
            let beside = std::mem::take(&mut beside);
            FileRead { node: node.name.clone(), stamp: stamp(&path), named, path, beside }
        }));
    }
    origins
}

/// The diagonal of the volume that is drawn with the transfer function of a node.
fn drawn_with(graph: &Graph, places: &[usize], look: usize, done: &[Option<Done>]) -> Option<f64> {
    places.iter().find_map(|&place| {
        let node = &graph.nodes[place];
        node.inputs.iter().find(|edge| edge.node == look)?;
        let port = |k: usize| node.node.all_inputs().nth(k).map(|port| port.port_type);
        let volume = node.inputs.iter().find(|edge| port(edge.port) == Some(PortType::Volume))?;
        let (value, _) = done[volume.node].as_ref()?.outputs.get(volume.output)?;
        Some(diagonal(&value.volume()?.ok()?.grid.points))
    })
}

/// A node and all that feeds it, each after what feeds it.
pub(super) fn upstream(graph: &Graph, place: usize) -> Vec<usize> {
    let mut needed = vec![false; graph.nodes.len()];
    needed[place] = true;
    for &i in graph.order.iter().rev().filter(|&&i| i != place) {
        needed[i] =
            (0..needed.len()).any(|k| needed[k] && graph.nodes[k].inputs.iter().any(|edge| edge.node == i));
    }
    graph.order.iter().copied().filter(|&i| needed[i]).collect()
}
