//! Wires of nodes that come into a chain or go from it: what a picture is drawn with, for nodes that are made of it (transfer function,
//! volume, camera), and what feeds a node that goes.

use crate::scene::Scene;
use voltet_document::Edit;
use voltet_document::links::sources;
use voltet_graph::{LinkEntry, NodeEntry, PortType};

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

/// Wires that lead past nodes which are to go: what one of them feeds gets what feeds that with the same type.
pub(crate) fn wires_past(scene: &Scene, gone: &[String]) -> Vec<Edit> {
    let is_gone = |text: &str| gone.iter().any(|name| name == scene.giving(text).0);
    let before = |text: &str| {
        let (name, _, port) = scene.giving(text);
        let (entry, port_type) = (scene.entry(name)?, port?.port_type);
        let input = scene.node_type(entry)?.all_inputs().find(|input| input.port_type == port_type)?;
        entry.inputs.iter().find(|link| link.port == input.name)?.source.text()
    };
    let stay = scene.document.pipeline().nodes.iter().filter(|node| !gone.contains(&node.name));
    let links = stay.flat_map(|node| node.inputs.iter().map(move |link| (node, link)));
    let past = |(node, link): (&NodeEntry, &LinkEntry)| {
        let mut text = link.source.text().filter(|text| is_gone(text))?;
        // Each step passes one of them; more would be a circle.
        for _ in gone {
            text = if is_gone(text) { before(text)? } else { text };
        }
        let (node, port) = (node.name.clone(), link.port.clone());
        (!is_gone(text)).then(|| Edit::Connect { node, port, source: text.to_string(), beside: false })
    };
    links.filter_map(past).collect()
}
