//! Places of the graph view: between the document and the window, and of the nodes and ports of this frame.

use eframe::egui::{Pos2, Rect, Vec2, vec2};
use std::collections::HashMap;
use voltet_graph::PortType;

/// The part of the document that a rectangle of the window shows.
#[derive(Debug, Clone, Copy)]
pub(super) struct Viewport {
    pub rect: Rect,
    /// Position of the document's origin (points from the rectangle's corner).
    pub pan: Vec2,
    pub zoom: f32,
}

impl Default for Viewport {
    fn default() -> Self {
        Viewport { rect: Rect::NOTHING, pan: Vec2::ZERO, zoom: 1.0 }
    }
}

impl Viewport {
    pub fn to_window(self, [x, y]: [f64; 2]) -> Pos2 {
        self.rect.min + self.pan + self.zoom * vec2(x as f32, y as f32)
    }

    pub fn to_document(self, at: Pos2) -> [f64; 2] {
        let from = (at - self.rect.min - self.pan) / self.zoom;
        [f64::from(from.x), f64::from(from.y)]
    }

    /// A rectangle of the document in the window.
    pub fn rect_of(self, position: [f64; 2], size: [f64; 2]) -> Rect {
        Rect::from_min_size(self.to_window(position), self.zoom * vec2(size[0] as f32, size[1] as f32))
    }
}

/// A port of a node.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Port {
    pub node: String,
    pub name: &'static str,
    pub port_type: PortType,
    pub is_input: bool,
    /// True if it takes several wires, or none.
    pub is_optional: bool,
}

/// A node in the window.
#[derive(Debug)]
pub(super) struct NodePlace {
    pub name: String,
    pub rect: Rect,
    pub ports: Vec<(Port, Pos2)>,
}

/// The nodes of a frame, the upper ones last.
#[derive(Debug, Default)]
pub(super) struct Places {
    pub viewport: Viewport,
    pub nodes: Vec<NodePlace>,
    numbers: HashMap<String, usize>,
}

impl Places {
    pub fn new(viewport: Viewport, nodes: Vec<NodePlace>) -> Places {
        let numbers = nodes.iter().enumerate().map(|(i, node)| (node.name.clone(), i)).collect();
        Places { viewport, nodes, numbers }
    }

    pub fn node(&self, name: &str) -> Option<&NodePlace> {
        self.numbers.get(name).map(|i| &self.nodes[*i])
    }

    /// Position of a port; the middle of the node's side where it does not show the port. `None` of a node that is not there.
    pub fn port(&self, node: &str, name: &str, is_input: bool) -> Option<Pos2> {
        let node = self.node(node)?;
        let is_it = |(port, _): &&(Port, Pos2)| port.name == name && port.is_input == is_input;
        let side = if is_input { node.rect.left_center() } else { node.rect.right_center() };
        Some(node.ports.iter().find(is_it).map_or(side, |(_, at)| *at))
    }

    /// True if a position of a node lies under another node.
    pub fn is_under(&self, node: &str, at: Pos2) -> bool {
        self.nodes.iter().rev().take_while(|upper| upper.name != node).any(|upper| upper.rect.contains(at))
    }

    /// The port next to a place of the window, of those that no other node covers.
    pub fn port_at(&self, at: Pos2, near: f32) -> Option<&Port> {
        let near_by = self.nodes.iter().flat_map(|node| &node.ports);
        let near_by = near_by.filter(|(_, place)| place.distance(at) <= near);
        let shown = near_by.filter(|(port, place)| !self.is_under(&port.node, *place));
        shown.min_by(|a, b| a.1.distance(at).total_cmp(&b.1.distance(at))).map(|(port, _)| port)
    }

    /// The uppermost node at a place of the window.
    pub fn node_at(&self, at: Pos2) -> Option<&str> {
        self.nodes.iter().rev().find(|node| node.rect.contains(at)).map(|node| node.name.as_str())
    }
}
