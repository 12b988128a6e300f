//! Positions of nodes and ports: as drawn where they are in view, else as estimated.

use super::package::{INNER, State, Written};
use crate::scene::Scene;
use eframe::egui::{Pos2, Rect, Vec2, pos2, vec2};
use egui_node_graph2::AnyParameterId;
use std::collections::HashMap;
use std::rc::Rc;
use voltet_graph::{Node, NodeEntry, PortType};

/// The package's margin on each side of what a node shows, points.
const MARGIN: f32 = 15.0;

/// Height of a title and of a row, before a node was drawn once.
const TITLE: f32 = 30.0;
const ROW: f32 = 21.0;

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

/// A port of a node.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(super) struct Port {
    pub node: String,
    pub name: String,
    pub port_type: PortType,
    pub is_input: bool,
    /// True if it takes several wires, or none.
    pub is_optional: bool,
}

/// A node as it was drawn last, at the usual scale.
#[derive(Debug, Default)]
struct NodeGeometry {
    size: Vec2,
    /// Positions of its ports, from its corner.
    ports: Vec<(Rc<Port>, Vec2)>,
}

/// Positions of the last frame.
#[derive(Debug, Default)]
pub(super) struct Places {
    /// Each node that was ever drawn.
    known: HashMap<String, NodeGeometry>,
    /// The ports and nodes of this frame, in the window; the upper ones last.
    pub seen: Vec<(Rc<Port>, Pos2)>,
    pub drawn: Vec<(String, Rect)>,
}

impl Places {
    /// Takes down what the package drew. `origin`: where the document's origin lies in the window.
    pub fn write_down(
        &mut self,
        state: &State,
        written: &Written,
        ends: &HashMap<AnyParameterId, Rc<Port>>,
        origin: Vec2,
        zoom: f32,
    ) {
        self.seen.clear();
        self.drawn.clear();
        for id in &state.node_order {
            let (Some(node), Some(at)) = (state.graph.nodes.get(*id), state.node_positions.get(*id)) else {
                continue;
            };
            let low = *at + origin;
            let name = &node.user_data.name;
            let right = written.right.get(id).copied().unwrap_or(low.x + MARGIN * zoom) + MARGIN * zoom;
            let mut bottom = low.y + TITLE * zoom;
            let mut ports = Vec::new();
            let inputs = node.inputs.iter().map(|(_, id)| AnyParameterId::Input(*id));
            for end in inputs.chain(node.outputs.iter().map(|(_, id)| AnyParameterId::Output(*id))) {
                let (Some(port), Some(y)) = (ends.get(&end), written.rows.get(&end)) else { continue };
                let place = pos2(if port.is_input { low.x } else { right }, *y);
                ports.push((port.clone(), (place - low) / zoom));
                self.seen.push((port.clone(), place));
                bottom = bottom.max(y + 0.5 * ROW * zoom);
            }
            // As the package draws its frame: half a title lower than its content and margin end, less the rounding.
            let title = written.titled.get(id).map_or(TITLE * zoom, |y| y - low.y);
            bottom = written.bottom.get(id).map_or(bottom, |y| y + zoom + 0.5 * title);
            let frame = Rect::from_min_max(low, pos2(right, bottom));
            let known = NodeGeometry { size: frame.size() / zoom, ports };
            match self.known.get_mut(name) {
                Some(there) => *there = known,
                None => drop(self.known.insert(name.clone(), known)),
            }
            self.drawn.push((name.clone(), frame));
        }
    }

    /// True if a position of a node lies under another node.
    pub fn is_under(&self, node: &str, at: Pos2) -> bool {
        let upper = self.drawn.iter().rev().take_while(|(name, _)| name != node);
        upper.into_iter().any(|(_, frame)| frame.contains(at))
    }

    /// Width and height of a node at the usual scale.
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

    /// Position of a port (the document's points).
    pub fn port(&self, scene: &Scene, entry: &NodeEntry, name: &str, is_input: bool) -> [f64; 2] {
        let [x, y] = scene.document.position(&entry.name);
        let known = self.known.get(&entry.name).and_then(|known| {
            let is_it = |(port, _): &&(Rc<Port>, Vec2)| port.name == name && port.is_input == is_input;
            known.ports.iter().find(is_it).map(|(_, from)| *from)
        });
        let from = known.unwrap_or_else(|| {
            let frame = self.frame(scene, entry);
            vec2(if is_input { 0.0 } else { frame.width() }, 0.5 * frame.height())
        });
        [x + f64::from(from.x), y + f64::from(from.y)]
    }

    /// The port next to a place of the window, of those that no other node covers.
    pub fn port_at(&self, at: Pos2, near: f32) -> Option<Rc<Port>> {
        let near_by = self.seen.iter().filter(|(_, place)| place.distance(at) <= near);
        let shown = near_by.filter(|(port, place)| !self.is_under(&port.node, *place));
        let nearest = shown.min_by(|a, b| a.1.distance(at).total_cmp(&b.1.distance(at)));
        nearest.map(|(port, _)| port.clone())
    }

    /// The uppermost node at a place of the window.
    pub fn node_at(&self, at: Pos2) -> Option<&str> {
        self.drawn.iter().rev().find(|(_, frame)| frame.contains(at)).map(|(name, _)| name.as_str())
    }
}
