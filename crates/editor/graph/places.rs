//! Positions of nodes and ports: as drawn where they are in view, else as estimated.

use super::package::{INNER, NodeGraph, Port, drawn_ports};
use crate::scene::Scene;
use eframe::egui::{Pos2, Rect, Vec2, pos2, vec2};
use egui_node_editor::{NodeId, NodeRects, PortLocations};
use std::collections::HashMap;
use voltet_graph::{Node, NodeEntry, PortType};

/// The package's margin on each side of what a node shows, points.
const MARGIN: f32 = 15.0;

/// As they come out: height of a node without ports, and what a port and a picture add.
const BARE: f64 = 55.0;
const PORT: f64 = 27.0;
const PICTURE: f64 = 70.0;

/// Width and height that a node of a type will have, about.
pub(crate) fn usual_size(node: Option<&Node>) -> [f64; 2] {
    let ports = node.map_or(0, |node| node.all_inputs().count() + node.outputs.len());
    let has_picture =
        node.is_some_and(|node| node.outputs.iter().any(|port| port.port_type == PortType::Image));
    let width = f64::from(INNER + 2.0 * MARGIN);
    [width, BARE + PORT * ports as f64 + if has_picture { PICTURE } else { 0.0 }]
}

/// A node as it was drawn last, at the usual scale.
#[derive(Debug, Default)]
struct NodeGeometry {
    size: Vec2,
    /// Positions of its ports, from its corner.
    ports: Vec<(Port, Vec2)>,
}

#[derive(Debug, Default)]
pub(super) struct Places {
    /// Each node that was ever drawn.
    known: HashMap<String, NodeGeometry>,
    /// The ports and nodes of this frame, in the window; the upper ones last. Ports that another node covers are left out.
    pub seen: Vec<(Port, Pos2)>,
    pub drawn: Vec<(String, Rect)>,
}

impl Places {
    /// Takes down what the package drew, in this order.
    pub fn write_down(
        &mut self,
        graph: &NodeGraph,
        order: &[NodeId],
        frames: &NodeRects,
        locations: &PortLocations,
        zoom: f32,
    ) {
        self.seen.clear();
        self.drawn.clear();
        for id in order {
            let (frame, name) = (frames[id], &graph[*id].user_data.name);
            let ports: Vec<(Port, Pos2)> =
                drawn_ports(graph, *id).map(|(port, key)| (port.clone(), locations[&key])).collect();
            let apart = |(port, at): &(Port, Pos2)| (port.clone(), (*at - frame.min) / zoom);
            let known = NodeGeometry { size: frame.size() / zoom, ports: ports.iter().map(apart).collect() };
            self.known.insert(name.clone(), known);
            self.seen.extend(ports);
            self.drawn.push((name.clone(), frame));
        }
        self.seen.retain(|(port, at)| {
            let mut upper = self.drawn.iter().rev().take_while(|(name, _)| *name != port.node);
            !upper.any(|(_, frame)| frame.contains(*at))
        });
    }

    pub fn size_of(&self, node: &str) -> [f64; 2] {
        match self.known.get(node) {
            Some(known) => [f64::from(known.size.x), f64::from(known.size.y)],
            None => usual_size(None),
        }
    }

    /// The frame of a node in the document's points.
    pub fn frame(&self, scene: &Scene, entry: &NodeEntry) -> Rect {
        let [x, y] = scene.document.position(&entry.name);
        let guessed = || usual_size(scene.node_type(entry)).map(|side| side as f32).into();
        let size = self.known.get(&entry.name).map_or_else(guessed, |known| known.size);
        Rect::from_min_size(pos2(x as f32, y as f32), size)
    }

    /// The frame of a node, or its upper part while its height is not known; true in the former case.
    pub fn known_frame(&self, scene: &Scene, entry: &NodeEntry) -> (Rect, bool) {
        let (frame, is_known) = (self.frame(scene, entry), self.known.contains_key(&entry.name));
        (if is_known { frame } else { frame.with_max_y(frame.top() + BARE as f32) }, is_known)
    }

    /// Position of a port (the document's points).
    pub fn port(&self, scene: &Scene, entry: &NodeEntry, name: &str, is_input: bool) -> [f64; 2] {
        let [x, y] = scene.document.position(&entry.name);
        let known = self.known.get(&entry.name).and_then(|known| {
            let is_it = |(port, _): &&(Port, Vec2)| port.declared.name == name && port.is_input == is_input;
            known.ports.iter().find(is_it).map(|(_, from)| *from)
        });
        let from = known.unwrap_or_else(|| {
            let frame = self.frame(scene, entry);
            vec2(if is_input { 0.0 } else { frame.width() }, 0.5 * frame.height())
        });
        [x + f64::from(from.x), y + f64::from(from.y)]
    }

    /// The port next to a place of the window, of those that no other node covers.
    pub fn port_at(&self, at: Pos2, near: f32) -> Option<&Port> {
        let near_by = self.seen.iter().filter(|(_, place)| place.distance(at) <= near);
        near_by.min_by(|a, b| a.1.distance(at).total_cmp(&b.1.distance(at))).map(|(port, _)| port)
    }

    pub fn node_at(&self, at: Pos2) -> Option<&str> {
        self.drawn.iter().rev().find(|(_, frame)| frame.contains(at)).map(|(name, _)| name.as_str())
    }
}
