//! Collects the origins of values: cameras, units and files.

use super::cache::files_beside;
use super::plan::Done;
use crate::api::node::Steps;
use crate::api::origins::{FileRead, FileStamp, Origins};
use crate::api::port::PortType;
use crate::api::value::{Value, diagonal};
use crate::build::graph::Graph;

/// Origins of the values of these nodes, which ran.
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
