//! The wires of a node in words: those that it could have, and those that it has.

use crate::scene::Scene;
use voltet_document::{Edit, links};

/// The edit that takes a wire off an input of a node, and words for it.
pub(super) fn taking_off(node: &str, port: &str, source: &str) -> (String, Edit) {
    let words = format!("take off {source} to {node}.{port}");
    (words, Edit::Disconnect { node: node.into(), port: port.into(), source: Some(source.into()) })
}

/// The wires that a node could have, then those that it has, which can be taken off; each in words.
pub(super) fn wires_of(scene: &Scene, node: &str) -> Vec<(String, Edit)> {
    let nodes = &scene.document.pipeline().nodes;
    let Some(own) = scene.entry(node) else { return Vec::new() };
    let is_fed = |port: &str| own.inputs.iter().any(|link| link.port == port);
    let mut found: Vec<(bool, String, Edit)> = Vec::new();
    for other in nodes.iter().filter(|other| other.name != node) {
        for (from, to) in [(other, own), (own, other)] {
            let (Some(giving), Some(taking)) = (scene.node_type(from), scene.node_type(to)) else { continue };
            for (output, input) in
                giving.outputs.iter().flat_map(|a| taking.all_inputs().map(move |b| (a, b)))
            {
                let joined =
                    scene.document.join(scene.registry, (&from.name, output.name), (&to.name, input.name));
                if let Ok(edit) = joined {
                    let text = format!("{}.{} to {}.{}", from.name, output.name, to.name, input.name);
                    // What the node lacks comes first.
                    found.push((to.name != node || is_fed(input.name), text, edit));
                }
            }
        }
    }
    found.sort_by_key(|(is_extra, ..)| *is_extra);
    let mut wires: Vec<(String, Edit)> = found.into_iter().map(|(_, text, edit)| (text, edit)).collect();
    for to in nodes {
        for (link, source) in
            to.inputs.iter().flat_map(|link| links::sources(link).map(move |source| (link, source)))
        {
            if to.name == node || links::source(source, nodes).0 == node {
                wires.push(taking_off(&to.name, &link.port, source));
            }
        }
    }
    wires
}
