//! Inputs that a picture is drawn with (transfer function, volume, camera), for nodes that are made of the picture.

use crate::scene::Scene;
use voltet_document::links::sources;
use voltet_graph::{NodeEntry, PortType};

/// A node and its output, and the input that it may feed.
pub(crate) type Feeding = (String, String, &'static str);

/// A node and those that feed it, the nearest along wires first.
pub(crate) fn nearest_first<'a>(scene: &Scene<'a>, from: &str) -> Vec<&'a NodeEntry> {
    let mut met: Vec<&NodeEntry> = scene.entry(from).into_iter().collect();
    let mut place = 0;
    while let Some(entry) = met.get(place).copied() {
        for text in entry.inputs.iter().flat_map(sources) {
            let feeding = scene.entry(scene.giving(text).0);
            met.extend(feeding.filter(|entry| !met.iter().any(|known| known.name == entry.name)));
        }
        place += 1;
    }
    met
}

/// Nodes behind the picture that feeds a node, the nearest first; none where no picture feeds it.
pub(crate) fn drawing<'a>(scene: &Scene<'a>, entry: &NodeEntry) -> Vec<&'a NodeEntry> {
    let inputs = scene.node_type(entry).map_or(&[][..], |node| node.inputs);
    let picture = inputs.iter().find(|port| port.port_type == PortType::Image);
    let link = picture.and_then(|port| entry.inputs.iter().find(|link| link.port == port.name));
    let source = link.into_iter().flat_map(sources).next();
    source.map_or_else(Vec::new, |text| nearest_first(scene, scene.giving(text).0))
}

/// Optional inputs that a node made of a picture lacks, each with the output that feeds the like of it where that picture is drawn.
pub(crate) fn inputs_of_picture(scene: &Scene, entry: &NodeEntry) -> Vec<Feeding> {
    let drawing = drawing(scene, entry);
    let optional = scene.node_type(entry).map_or(&[][..], |node| node.optional_inputs);
    let lacking = optional.iter().filter(|port| entry.inputs.iter().all(|link| link.port != port.name));
    let feeding = |port: &'static voltet_graph::Port| {
        let source = drawing.iter().find_map(|entry| {
            let like = scene.node_type(entry)?.all_inputs().find(|of| of.port_type == port.port_type)?;
            entry.inputs.iter().find(|link| link.port == like.name)?.source.text()
        })?;
        let (node, output) = scene.output_of(source);
        Some((node, output, port.name))
    };
    lacking.filter_map(feeding).collect()
}
