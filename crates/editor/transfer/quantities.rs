//! Names of the plane's quantities, and the volume that they belong to.

use crate::scene::Scene;
use voltet_document::links::{self, upstream};
use voltet_graph::{ArrayRef, NodeEntry, PortType};

/// The output that gives the volume that a transfer function is drawn with: "node" or "node.port".
pub(crate) fn volume_of(scene: &Scene, look: &str) -> Option<String> {
    let nodes = &scene.document.pipeline().nodes;
    let source = |node: &NodeEntry, port_type: PortType| {
        let declared = scene.node_type(node)?;
        let port = declared.all_inputs().find(|port| port.port_type == port_type)?;
        node.inputs.iter().find(|link| link.port == port.name)?.source.text().map(str::to_string)
    };
    let draws = |node: &&NodeEntry| {
        source(node, PortType::TransferFunction)
            .is_some_and(|text| text == look || text.split('.').next() == Some(look))
    };
    let mut drawn = nodes.iter().filter(draws).filter(|node| node.name != look);
    let by_use = drawn.find_map(|node| source(node, PortType::Volume));
    by_use.or_else(|| source(scene.entry(look)?, PortType::Volume))
}

/// An axis with what it is: s is the array that the reader reads for it, where one does.
pub(super) fn axis_title(scene: &Scene, look: &str, axis: &ArrayRef) -> String {
    match axis {
        ArrayRef::Named("s") => {
            let source = volume_of(scene, look);
            let nodes = &scene.document.pipeline().nodes;
            let feeding = source.map(|source| upstream(nodes, links::source(&source, nodes).0));
            let reads = |node: &&NodeEntry| feeding.as_ref().is_some_and(|names| names.contains(&node.name));
            let scalar = |node: &NodeEntry| {
                let stated = node.settings.iter().find(|field| field.name == "scalar")?;
                Some(format!("s = {}", stated.setting.text()?))
            };
            nodes.iter().filter(reads).find_map(scalar).unwrap_or_else(|| "s".into())
        }
        ArrayRef::Named("g") => "g = |grad s|".into(),
        ArrayRef::Array(_) | ArrayRef::Named(_) | ArrayRef::Per(..) => axis_name(axis),
    }
}

/// A quantity as an axis names it.
pub(super) fn axis_name(axis: &ArrayRef) -> String {
    match axis {
        ArrayRef::Array(name) => name.clone(),
        ArrayRef::Named(_) | ArrayRef::Per(..) => axis.to_string(),
    }
}
