//! Eyes of nodes: what surfaces, annotations and clips add to the window's picture is taken out of it and brought back. The file keeps that
//! beside the positions of nodes, and runs draw all.

use crate::scene::Scene;
use std::borrow::Cow;
use std::collections::BTreeSet;
use voltet_core::counted;
use voltet_document::links::{self, upstream};
use voltet_document::{Document, Edit};
use voltet_graph::{NodeEntry, ParameterValue, PortType, Registry};
use voltet_nodes::drawing::CLIP;

/// Addition of a node to a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Addition {
    Surface,
    /// It draws over a picture.
    Annotation,
    /// It draws a picture that its clips cut.
    Clips,
}

fn addition(node: &NodeEntry, registry: &Registry) -> Option<Addition> {
    let gives = |port_type| {
        let known = registry.node_type(node);
        known.is_some_and(|known| known.outputs.iter().any(|port| port.port_type == port_type))
    };
    match node.node_type.text() {
        Some("annotation") => Some(Addition::Annotation),
        _ if gives(PortType::Surface) => Some(Addition::Surface),
        _ if gives(PortType::Image) && node.setting(CLIP.name).is_some() => Some(Addition::Clips),
        _ => None,
    }
}

fn is_hidden(document: &Document, node: &str) -> bool {
    document.view().nodes.get(node).is_some_and(|view| view.hidden)
}

/// True if a node's eye is open, false if it is closed; `None` of nodes without one.
pub(crate) fn eye(scene: &Scene, node: &NodeEntry) -> Option<bool> {
    addition(node, scene.registry).map(|_| !is_hidden(scene.document, &node.name))
}

/// Edits that close the eyes of these nodes, or open them where all are closed.
pub(crate) fn toggled(document: &Document, registry: &Registry, names: &BTreeSet<String>) -> Vec<Edit> {
    let nodes = document.pipeline().nodes.iter().filter(|node| names.contains(&node.name));
    let with_eye: Vec<&NodeEntry> = nodes.filter(|node| addition(node, registry).is_some()).collect();
    let hidden = !with_eye.iter().all(|node| is_hidden(document, &node.name));
    let other = with_eye.into_iter().filter(|node| is_hidden(document, &node.name) != hidden);
    other.map(|node| Edit::Hide { node: node.name.clone(), hidden }).collect()
}

/// The nodes of the document as the window draws them: without surfaces and clips that are hidden, and with hidden annotations that write
/// nothing.
pub(crate) fn visible_nodes<'a>(document: &'a Document, registry: &Registry) -> Cow<'a, [NodeEntry]> {
    let all = &document.pipeline().nodes;
    let hidden = |node: &NodeEntry| addition(node, registry).filter(|_| is_hidden(document, &node.name));
    if all.iter().all(|node| hidden(node).is_none()) {
        return Cow::Borrowed(all);
    }
    let is_surface = |source: &str| {
        let name = links::source(source, all).0;
        all.iter().any(|node| node.name == name && hidden(node) == Some(Addition::Surface))
    };
    let drawn = |node: &NodeEntry| {
        let mut drawn = node.clone();
        match hidden(node) {
            Some(Addition::Clips) => drawn.settings.retain(|field| field.name != CLIP.name),
            Some(Addition::Annotation) => {
                drawn.settings.clear();
                drawn.inputs.retain(|link| link.port == "image");
            }
            Some(Addition::Surface) | None => {}
        }
        for link in &mut drawn.inputs {
            if links::sources(link).any(is_surface) {
                let kept = links::sources(link).filter(|source| !is_surface(source));
                link.source = kept.collect::<ParameterValue>().into();
            }
        }
        drawn.inputs.retain(|link| link.source.list().is_none_or(|list| !list.is_empty()));
        drawn
    };
    Cow::Owned(all.iter().map(drawn).collect())
}

/// Nodes that the shown picture leaves out, in words: "without 'cut'"; `None` where it leaves out nothing.
pub(crate) fn left_out(scene: &Scene) -> Option<String> {
    let nodes = &scene.document.pipeline().nodes;
    let feeding = upstream(nodes, scene.shown_node?);
    let is_closed = |node: &&NodeEntry| feeding.contains(&node.name) && eye(scene, node) == Some(false);
    let closed: Vec<&NodeEntry> = nodes.iter().filter(is_closed).collect();
    match closed[..] {
        [] => None,
        [one] if addition(one, scene.registry) == Some(Addition::Clips) => {
            Some(format!("without the clips of '{}'", one.name))
        }
        [one] => Some(format!("without '{}'", one.name)),
        _ => Some(format!("without {}", counted(closed.len(), "node"))),
    }
}
